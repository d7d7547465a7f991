"""The motion without events: friction holds, and the absorber moves with the cavity.

Its equations are linear, K u = f with few unknowns. Its only border is the slip, at which the shaking first exceeds friction.
"""

from __future__ import annotations

import numpy as np

from orbits.machines.reference.law import DRIVEN, LAWS, Law


class Rest:
    """The absorber at rest in its cavity. Parameter vectors have shape (P,).

    In a shaken cavity the only unknown is its position, kept at w = 0. On an oscillator the unknowns are X and Y of the linear response
    q1 = X sin Psi + Y cos Psi with the mass 1 + eps, about the position of rest.
    """

    def __init__(self, name: str) -> None:
        self._law, self.unknowns = LAWS[name], 2 if name in DRIVEN else 1

    def law(self, params: np.ndarray) -> Law:
        """Return the numbers of the equations of motion."""
        return self._law([*np.asarray(params, dtype=float)])

    def equations(self, params: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return matrix K (N, N) and right-hand side f (N,)."""
        law = self.law(params)
        if law.prescribed:
            return np.eye(1), np.zeros(1)
        stiffness, drag = 1.0 - law.whole * law.omega**2, law.drag * law.omega
        return np.array([[stiffness, -drag], [drag, stiffness]]), law.force * np.array([1.0, law.base])

    def reserve(self, params: np.ndarray, u: np.ndarray) -> float:
        """Return the friction acceleration left before the absorber slips, in the direction nearer to slipping."""
        return min(self.reserves(params, u))

    def reserves(self, params: np.ndarray, u: np.ndarray | None = None) -> tuple[float, float]:
        """Return the reserve in both directions; gravity along the cavity helps one direction and hinders the other."""
        law = self.law(params)
        size = law.amplitude if law.prescribed else np.hypot(*(self.solved(params) if u is None else u))
        shaking = float(size) * float(law.omega) ** 2
        return float(law.pull_left) - shaking, float(-law.pull_right) - shaking

    def solved(self, params: np.ndarray) -> np.ndarray:
        """Return the unknowns."""
        return np.linalg.solve(*self.equations(params))

    def multipliers(self, params: np.ndarray) -> np.ndarray:
        """Return the multipliers over one forcing period, complex, shape (m,) with m the same for all parameters."""
        law = self.law(params)
        if law.prescribed:
            return np.zeros(0, complex)
        return np.exp(np.roots([law.whole, law.drag, 1.0]).astype(complex) * 2.0 * np.pi / law.omega)

    def cavity_motion(
        self, params: np.ndarray, u: np.ndarray, phase: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return v and v' at given phases."""
        law = self.law(params)
        if law.prescribed:
            return law.amplitude * np.sin(phase), law.amplitude * law.omega * np.cos(phase)
        X, Y = law.whole * u
        return X * np.sin(phase) + Y * np.cos(phase), law.omega * (X * np.cos(phase) - Y * np.sin(phase))

    def measure(self, name: str, params: np.ndarray, u: np.ndarray) -> float:
        """Return a measure that is defined without events; NaN for any other."""
        law = self.law(params)
        if law.prescribed:
            return float(law.amplitude) ** 2 if name == "C2" else np.nan
        size = float(np.hypot(u[0], u[1]))
        ground = float(law.drag / law.eps) * np.pi * float(law.omega) * size**2
        true = ground + share_of_the_base(law, 1, np.pi * float(u[0]))
        return {
            "max_abs_q1": size,
            "amplitude": float(law.whole) * size,
            "C2": (float(law.whole) * size) ** 2,
            "v_phase": float(np.arctan2(u[1], u[0])),
            "input_work": true,
            "damping_loss": true,
            "force_work": ground,  # lambda times the integral of q1'^2
            "grounded_damping_loss": ground,
        }.get(name, np.nan)


def share_of_the_base(law: Law, periods: int, overlap: float) -> float:
    """Return the additional loss in the damper due to the base's motion: lambda times the integral of (q1' - e')^2 - q1'^2, per mass of the absorber.

    By parts the integral of q1' e' is Omega^2 times that of q1 e; `overlap` is the integral of q1 sin Psi over the phase.
    """
    own = np.pi * periods * law.omega * law.force**2
    chi_lambda = law.base / (law.omega * law.eps)
    return float(chi_lambda * (own - 2.0 * law.omega * law.force * overlap))
