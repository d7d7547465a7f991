"""All steady states of the slow flow on both manifolds.

Elimination of the phase gives ``(lambda C^2 - k1)^2 + (2 sigma C^2 - k2)^2 = G^2 C^2``. On the impacting manifold
``C^2``, ``k1`` and ``k2`` are quadratic in ``B``, so this is a quartic in ``B``; on the sliding manifold
``C^2`` divides out and a quadratic in the turning point ``delta`` remains (the paper's equation with the
square root, made rational by ``delta``).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from orbits.arguments import Reals

from .. import manifolds
from .flow import Manifold, SlowFlow
from .polynomials import real_roots, root_bound


@dataclass(frozen=True)
class Equilibrium:
    """One steady state.

    `stable`: the slow flow returns to it. `attracting`: the fast motion converges to the manifold there.
    A response that can be observed (`seen`) has both. `valid`: the paper's sufficient condition ``C
    < B - h`` holds (impacting), or the amplitude lies within the bounds of sliding.
    """

    manifold: Manifold
    velocity: float
    amplitude: float
    phase: float
    detuning: float
    eigenvalues: tuple[complex, complex]
    attracting: bool
    valid: bool
    turning_point: float | None = None

    @property
    def stable(self) -> bool:
        """Whether both eigenvalues of the slow flow lie in the left half plane."""
        return all(value.real < 0 for value in self.eigenvalues)

    @property
    def seen(self) -> bool:
        """Whether the state can be observed: stable along the manifold and attracting across it."""
        return self.stable and self.attracting

    @property
    def position(self) -> float:
        """Coordinate on its manifold: ``B`` or ``delta``."""
        return self.velocity if self.turning_point is None else self.turning_point


def impacting_polynomial(flow: SlowFlow, detuning: ArrayLike) -> NDArray[np.float64]:
    """Coefficients (highest power first) of the quartic in ``B``; shape (..., 5)."""
    R, h, kappa = flow.loss, flow.level, flow.kappa
    lam, G, sigma = (np.asarray(x, dtype=float) for x in (flow.damping, flow.forcing, detuning))
    squared = (0.25 * np.pi**2 + R**2, 2.0 * R * h - np.pi, 1.0 + h**2)
    k1 = (-(4.0 / np.pi) * R, h * (0.5 * np.pi * kappa - 4.0 / np.pi), -kappa * h)
    k2 = (-2.0, 4.0 / np.pi - kappa * h * R, -kappa * h**2)
    in_phase = [2.0 * sigma * x - y for x, y in zip(squared, k2)]
    in_quadrature = [lam * x - y for x, y in zip(squared, k1)]
    terms: list[Any] = [0.0] * 5
    for i in range(3):
        for j in range(3):
            terms[i + j] = terms[i + j] + in_phase[i] * in_phase[j] + in_quadrature[i] * in_quadrature[j]
        terms[i + 2] = terms[i + 2] - G**2 * squared[i]
    return np.stack(np.broadcast_arrays(*terms), axis=-1)


def sliding_polynomial(flow: SlowFlow, detuning: ArrayLike) -> NDArray[np.float64]:
    """Coefficients (highest power first) of the quadratic in ``delta``; shape (..., 3)."""
    h, kappa = flow.level, flow.kappa
    lam, G, sigma = (np.asarray(x, dtype=float) for x in (flow.damping, flow.forcing, detuning))
    stiff = lam**2 + 4.0 * sigma**2
    terms = (
        stiff,
        2.0 * lam * kappa * h,
        stiff * h**2 + 4.0 * sigma * kappa * h**2 + (kappa * h) ** 2 - G**2,
    )
    return np.stack(np.broadcast_arrays(*terms), axis=-1)


def impacting_velocities(flow: SlowFlow, detuning: ArrayLike) -> NDArray[np.float64]:
    """All ``B > 0`` of impacting equilibria, ascending, padded with nan; shape (..., 4). Broadcasts over all
    fields."""
    polynomial = impacting_polynomial(flow, detuning)
    return real_roots(polynomial, 0.0, root_bound(polynomial))


def sliding_turning_points(flow: SlowFlow, detuning: ArrayLike) -> NDArray[np.float64]:
    """All ``delta`` of equilibria that slide without sticking or impact, padded with nan; shape (..., 2)."""
    polynomial = sliding_polynomial(flow, detuning)
    low = np.broadcast_to((2.0 / np.pi) * flow.level, polynomial.shape[:-1])
    return real_roots(polynomial, low, np.ones_like(low))


def phase_at(
    flow: SlowFlow, position: ArrayLike, detuning: ArrayLike, manifold: Manifold = "impacting"
) -> Reals:
    """Phase ``gamma`` in (-pi, pi] that balances both equations at an equilibrium's position."""
    squared, k1, k2 = flow.harmonics(position, manifold)
    return np.arctan2(k1 - flow.damping * squared, k2 - 2.0 * np.asarray(detuning) * squared)


def equilibrium_at(flow: SlowFlow, position: float, detuning: float, manifold: Manifold) -> Equilibrium:
    """Return the `Equilibrium` at a position that is known to be one."""
    phase = float(phase_at(flow, position, detuning, manifold))
    amplitude = float(np.sqrt(flow.harmonics(position, manifold)[0]))
    first, second = flow.eigenvalues(position, phase, manifold)
    if manifold == "sliding":
        low, high = flow.sliding_bounds
        inside = bool(low <= amplitude <= high)
        velocity, attracting, valid, turning = 0.0, inside, inside, float(position)
    else:
        velocity, turning = float(position), None
        attracting = bool(flow.attracts(position))
        valid = bool(manifolds.reversal_bound(amplitude, velocity, flow.level) > 0)
    return Equilibrium(
        manifold,
        velocity,
        amplitude,
        phase,
        float(detuning),
        (complex(first), complex(second)),
        attracting,
        valid,
        turning,
    )


def equilibria(flow: SlowFlow, detuning: float) -> list[Equilibrium]:
    """Return all steady states at one detuning: first the impacting ones with ascending ``B``, then the sliding ones.

    Raises
    ------
    ValueError
        If the flow's fields or the detuning are arrays; use `impacting_velocities` and
        `sliding_turning_points` for arrays.
    """
    found = impacting_velocities(flow, detuning)
    if found.ndim != 1:
        raise ValueError(
            "equilibria takes one parameter set; "
            "for arrays use impacting_velocities and sliding_turning_points."
        )
    states = [equilibrium_at(flow, float(b), detuning, "impacting") for b in found[np.isfinite(found)]]
    slides = sliding_turning_points(flow, detuning)
    if flow.level > 0:
        states += [equilibrium_at(flow, float(d), detuning, "sliding") for d in slides[np.isfinite(slides)]]
    return states
