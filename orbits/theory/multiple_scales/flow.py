"""The averaged (slow) flow of the oscillator near resonance, ``Omega = 1 + eps sigma``.

To first order in the mass ratio the oscillator moves as ``v = C sin(Omega tau + gamma)``; amplitude and
phase vary with the slow time ``tau_1 = eps tau``. The force of the absorber on it is the mean velocity times a
triangle wave plus a ripple due to friction; only their first harmonics have an effect:

    (C^2)'  = -lambda C^2 + k1 - G C sin(gamma)
    gamma'  = (k2 - G C cos(gamma))/(2 C^2) - sigma

    impacting  k1 = -(4/pi) B (R B + h) - kappa h (1 - pi B/2),   k2 = (4/pi) B (1 - pi B/2) - kappa h (R B + h)
    sliding    k1 = -kappa h delta,                               k2 = -kappa h^2

Sources: Youssef, Karoui and Leine, equations of the sections "Steady-state solutions and flow on the SIM"
and "Purely sliding absorber", with two corrections: the factor of the first term is 4/pi, and kappa is
the first cosine harmonic of the ripple ``(h/pi)(pi^2/4 - Pi^2) M``, which is ``(8/pi^2) h`` exactly
(`closure` "exact"). The paper multiplies the first harmonics of the two factors, ``(pi^4 - 16)/pi^4``
(`closure` "paper", to redraw its figures).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from orbits.arguments import Reals

from .. import manifolds

Closure = Literal["exact", "paper"]
Manifold = Literal["impacting", "sliding"]
CLOSURES: dict[str, float] = {"exact": 8.0 / math.pi**2, "paper": (math.pi**4 - 16.0) / math.pi**4}


@dataclass(frozen=True)
class SlowFlow:
    """Parameters of the slow flow of the coupled machine; fields may be arrays, which broadcast.

    Parameters
    ----------
    forcing : float
        ``G = E/(b eps)``; 0 for free vibration.
    restitution, friction, gravity, damping, mass_ratio : float
        ``r``, ``mu``, ``g/(b omega_0^2)``, ``c/(m omega_0)`` and ``m/M``. The mass ratio only converts
        slow time and detuning; the flow itself is the limit of mass ratio 0.
    closure : {"exact", "paper"}
        First harmonic of the friction ripple; see the docstring of the module.
    """

    forcing: Reals = 2.47
    restitution: Reals = 0.76
    friction: Reals = 0.5
    gravity: Reals = 0.211
    damping: Reals = 0.9
    mass_ratio: Reals = 0.006
    closure: Closure = "exact"

    def __post_init__(self) -> None:
        if self.closure not in CLOSURES:
            raise ValueError(f'closure is {self.closure!r}; it can be "exact" or "paper".')
        checks = (
            ("restitution", "must lie in (0, 1]", lambda x: (x > 0) & (x <= 1)),
            ("forcing", "must be finite and not negative", lambda x: np.isfinite(x) & (x >= 0)),
            ("friction", "must be finite and not negative", lambda x: np.isfinite(x) & (x >= 0)),
            ("gravity", "must be finite and not negative", lambda x: np.isfinite(x) & (x >= 0)),
            ("damping", "must be finite and not negative", lambda x: np.isfinite(x) & (x >= 0)),
            ("mass_ratio", "must be finite and positive", lambda x: np.isfinite(x) & (x > 0)),
        )
        for name, rule, holds in checks:
            value = np.asarray(getattr(self, name), dtype=float)
            if not np.all(holds(value)):
                bad = value[~holds(value)].flat[0]
                raise ValueError(f"{name} = {bad} {rule}.")

    def with_(self, **changes: Reals | Closure) -> SlowFlow:
        """A copy with some fields changed."""
        return replace(self, **changes)

    @property
    def loss(self) -> Reals:
        """``R = (1 - r)/(1 + r)``."""
        return manifolds.impact_loss(self.restitution)

    @property
    def level(self) -> Reals:
        """``h = (pi/2) mu g``."""
        return manifolds.friction_level(self.friction, self.gravity)

    @property
    def kappa(self) -> float:
        """First harmonic of the friction ripple in units of ``h``."""
        return CLOSURES[self.closure]

    @property
    def activation(self) -> manifolds.ManifoldPoint:
        """Lowest point ``(B_min, C_min)`` of the impacting manifold."""
        return manifolds.activation(self.loss, self.level)

    @property
    def symmetry_limit(self) -> manifolds.ManifoldPoint:
        """Upper end ``(B_max, C_max)`` of the attracting part of the impacting manifold."""
        return manifolds.symmetry_limit(self.loss, self.level)

    @property
    def sliding_bounds(self) -> tuple[Any, Any]:
        """Amplitudes between which the absorber slides without sticking or impacts."""
        return manifolds.sliding_bounds(self.level)

    def detuning(self, frequency: ArrayLike) -> Reals:
        """``sigma = (Omega - 1)/eps``."""
        return (np.asarray(frequency, dtype=float) - 1.0) / np.asarray(self.mass_ratio)

    def frequency(self, detuning: ArrayLike) -> Reals:
        """``Omega = 1 + eps sigma``."""
        return 1.0 + np.asarray(self.mass_ratio) * np.asarray(detuning, dtype=float)

    def attracts(self, velocity: ArrayLike) -> NDArray[np.bool_]:
        """Whether the fast motion converges to the impacting manifold at this ``B`` (between its two
        bifurcations)."""
        b = np.asarray(velocity, dtype=float)
        return (b > self.activation.velocity) & (b < self.symmetry_limit.velocity)

    def harmonics(self, position: ArrayLike, manifold: Manifold = "impacting") -> tuple[Any, Any, Any]:
        """``C^2``, ``k1`` and ``k2`` at a position: ``B`` on the impacting manifold, ``delta`` on the
        sliding one."""
        x = np.asarray(position, dtype=float)
        R, h = self.loss, self.level
        if manifold == "impacting":
            reach, recoil = 1.0 - 0.5 * np.pi * x, R * x + h
            k1 = -(4.0 / np.pi) * x * recoil - self.kappa * h * reach
            k2 = (4.0 / np.pi) * x * reach - self.kappa * h * recoil
            return reach**2 + recoil**2, k1, k2
        return x**2 + h**2, -self.kappa * h * x, -self.kappa * h**2 * np.ones_like(x)

    def harmonic_slopes(self, position: ArrayLike, manifold: Manifold = "impacting") -> tuple[Any, Any, Any]:
        """Derivatives of `harmonics` with respect to the position."""
        x = np.asarray(position, dtype=float)
        R, h = self.loss, self.level
        if manifold == "impacting":
            k1 = -(4.0 / np.pi) * (2.0 * R * x + h) + 0.5 * np.pi * self.kappa * h
            k2 = (4.0 / np.pi) * (1.0 - np.pi * x) - self.kappa * h * R
            return manifolds.slope(x, R, h), k1, k2
        return 2.0 * x, -self.kappa * h * np.ones_like(x), np.zeros_like(x)

    def rates(
        self, position: ArrayLike, phase: ArrayLike, detuning: ArrayLike, manifold: Manifold = "impacting"
    ) -> tuple[Any, Any]:
        """``(C^2)'`` and ``gamma'`` per unit of slow time ``eps tau``."""
        squared, k1, k2 = self.harmonics(position, manifold)
        pull = self.forcing * np.sqrt(squared)
        sine, cosine = np.sin(phase), np.cos(phase)
        return (
            -self.damping * squared + k1 - pull * sine,
            (k2 - pull * cosine) / (2.0 * squared) - np.asarray(detuning, dtype=float),
        )

    def rate_slopes(
        self, position: ArrayLike, phase: ArrayLike, manifold: Manifold = "impacting"
    ) -> tuple[Any, Any, Any, Any]:
        """Derivatives of `rates`: of ``(C^2)'`` by position and phase, of ``gamma'`` by position and
        phase."""
        squared, _, k2 = self.harmonics(position, manifold)
        d_squared, d_k1, d_k2 = self.harmonic_slopes(position, manifold)
        amplitude = np.sqrt(squared)
        sine, cosine = np.sin(phase), np.cos(phase)
        d_amplitude = d_squared / (2.0 * amplitude)
        turning = (k2 - self.forcing * amplitude * cosine) / (2.0 * squared)
        return (
            -self.damping * d_squared + d_k1 - self.forcing * d_amplitude * sine,
            -self.forcing * amplitude * cosine,
            (d_k2 - self.forcing * d_amplitude * cosine) / (2.0 * squared) - turning * d_squared / squared,
            self.forcing * sine / (2.0 * amplitude),
        )

    def eigenvalues(self, position: ArrayLike, phase: ArrayLike, manifold: Manifold = "impacting") -> NDArray:
        """Eigenvalues of the slow flow linearised in ``(C^2, gamma)``, per unit of slow time.

        Returns
        -------
        ndarray of complex, shape (..., 2)
            Infinite at the lowest point of the impacting manifold, where ``C^2`` does not determine ``B``.
        """
        a, b, c, d = self.rate_slopes(position, phase, manifold)
        slope = self.harmonic_slopes(position, manifold)[0]
        with np.errstate(divide="ignore", invalid="ignore"):
            a, c = a / slope, c / slope
            half = 0.5 * (a + d)
            root = np.sqrt((half**2 - (a * d - b * c)).astype(complex))
        return np.stack(np.broadcast_arrays(half + root, half - root), axis=-1)
