"""The absorber at rest on its oscillator: a linear response with the mass 1 + eps, about the place where both rest."""

from __future__ import annotations

import numpy as np

from orbits.machines.coupled.damper import share_of_the_base

FORCING, FREQUENCY, DAMPING, MASS_RATIO, FRICTION, GRAVITY, EXCITATION, SLOPE = 0, 1, 2, 3, 5, 6, 7, 8


class DrivenRest:
    """See `orbits.machines.rest.Rest`; the unknowns are X and Y of q1 = X sin Psi + Y cos Psi."""

    unknowns = 2

    def equations(self, params: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Mass 1 + eps, damping eps lambda, and the base's excitation eps G (sin, and cos by the damper)."""
        forcing, omega, damping, eps = (float(value) for value in params[:4])
        exact = float(params[EXCITATION])
        stiffness, drag = 1.0 - (1.0 + eps) * omega**2, eps * damping * omega
        return np.array([[stiffness, -drag], [drag, stiffness]]), eps * forcing * np.array(
            [1.0, exact * drag]
        )

    def reserve(self, params: np.ndarray, u: np.ndarray) -> float:
        """Of the two directions the nearer to slipping."""
        return min(self.reserves(params, u))

    def reserves(self, params: np.ndarray, u: np.ndarray | None = None) -> tuple[float, float]:
        """Of both directions: g (mu cos(slope) + sin(slope)) - max |q1''| and g (mu cos(slope) - sin(slope)) - max |q1''|."""
        if u is None:
            u = np.linalg.solve(*self.equations(params))
        friction, gravity, slope = (float(params[j]) for j in (FRICTION, GRAVITY, SLOPE))
        pull, lean = friction * gravity * np.cos(slope), gravity * np.sin(slope)
        shaking = float(params[FREQUENCY]) ** 2 * float(np.hypot(u[0], u[1]))
        return pull + lean - shaking, pull - lean - shaking

    def multipliers(self, params: np.ndarray) -> np.ndarray:
        omega, damping, eps = (float(value) for value in params[1:4])
        roots = np.roots([1.0 + eps, eps * damping, 1.0]).astype(complex)
        return np.exp(roots * 2.0 * np.pi / omega)

    def cavity_motion(
        self, params: np.ndarray, u: np.ndarray, phase: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        X, Y = (1.0 + float(params[MASS_RATIO])) * u
        omega = params[FREQUENCY]
        return X * np.sin(phase) + Y * np.cos(phase), omega * (X * np.cos(phase) - Y * np.sin(phase))

    def measure(self, name: str, params: np.ndarray, u: np.ndarray) -> float:
        eps, size = float(params[MASS_RATIO]), float(np.hypot(u[0], u[1]))
        ground = float(params[DAMPING]) * np.pi * float(params[FREQUENCY]) * size**2
        true = ground + share_of_the_base(params, 1, np.pi * float(u[0]))
        return {
            "max_abs_q1": size,
            "amplitude": (1.0 + eps) * size,
            "C2": ((1.0 + eps) * size) ** 2,
            "v_phase": float(np.arctan2(u[1], u[0])),
            "input_work": true,
            "damping_loss": true,
            "force_work": ground,  # lambda times the integral of q1'^2
            "grounded_damping_loss": ground,
        }.get(name, np.nan)
