"""The clearance that reduces a resonance most: half-width relative to the linear peak, along the tuned backbone.

At phase resonance the forcing ``F`` balances the damping by the oscillator's dashpot and by the absorber at the amplitude ``q`` of the
oscillator's first harmonic. `backbone` computes this to first order in the mass ratio, with the frequency ``1 + eps sigma``. Here the
frequency is not expanded: with the harmonics ``k1``, ``k2`` of the impacting absorber (`SlowFlow.harmonics`, no friction) at ``q/b = C``

    Omega^2 = C^2/(C^2 - eps k2),    F/(b k) = eps (lambda Omega C - Omega^2 k1/C)

The linear peak ``q_lin = F/(2 D k)`` is the response to the same forcing with the absorber fixed in its cavity; ``D`` and ``Omega_0`` then
belong to the mass ``M + m``, and ``2 D = eps lambda/sqrt(1 + eps)``. The half-width over this peak,

    b/q_lin = lambda/(sqrt(1 + eps) (lambda Omega C - Omega^2 k1/C)),

has a maximum on the attracting part of the manifold: in a wider cavity there is no steady motion with impacts at resonance, in a narrower
one the amplitude of the oscillator is larger. Sources: the single-harmonic backbone of T. Weidemann, L. A. Bergman, A. F. Vakakis and
M. Krack, Energy transfer and localization in a forced cyclic chain of oscillators with vibro-impact nonlinear energy sinks, Nonlinear
Dynamics (2025), whose mass ratio is ``m/(M + m)``; in the quantities of the slow flow: own derivation.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import root_scalar

from orbits.arguments import ROUNDOFF

from .flow import SlowFlow

PLACES = 2000  # values of B on the attracting part at which the maximum is bracketed


@dataclass(frozen=True)
class TunedBackbone:
    """Phase-resonant states as arrays over ``B``.

    Attributes
    ----------
    velocity : float array
        ``B``, mean speed of the absorber.
    amplitude : float array
        ``q/b``, amplitude of the oscillator's first harmonic.
    ratio : float array
        ``b/q_lin``: half-width over the linear peak under the same forcing with the absorber fixed.
    frequency : float array
        Frequency of resonance, relative to that with the absorber fixed.
    """

    velocity: NDArray
    amplitude: NDArray
    ratio: NDArray
    frequency: NDArray


@dataclass(frozen=True)
class BestClearance:
    """The largest half-width with steady impacts at resonance; fields as in `TunedBackbone`.

    `reduction` is ``q/q_lin``, the amplitude relative to the linear peak. `interior` is False if the ratio has no maximum inside the
    attracting part; then its largest value, at an end, is used.
    """

    velocity: float
    amplitude: float
    ratio: float
    frequency: float
    interior: bool

    @property
    def reduction(self) -> float:
        """``q/q_lin``."""
        return self.amplitude * self.ratio


def tuned_backbone(flow: SlowFlow, velocity: ArrayLike | None = None) -> TunedBackbone:
    """Half-width over linear peak, amplitude and frequency at phase resonance.

    Parameters
    ----------
    flow : SlowFlow
        Without friction; its forcing is not used.
    velocity : array_like, optional
        ``B``; by default 200 values over the attracting part of the manifold.

    Raises
    ------
    ValueError
        If there is friction, or no damping (then there is no linear peak).
    """
    _check(flow)
    if velocity is None:
        velocity = np.linspace(float(flow.activation.velocity), float(flow.symmetry_limit.velocity), 200)
    b = np.asarray(velocity, dtype=float)
    force, amplitude, frequency = _held(flow, b)[:3]
    eps = flow.mass_ratio
    ratio = flow.damping / (np.sqrt(1.0 + eps) * force)
    return TunedBackbone(b, amplitude, ratio, frequency * np.sqrt(1.0 + eps))


def best_clearance(flow: SlowFlow) -> BestClearance:
    """Find the maximum of ``b/q_lin`` inside the attracting part of the manifold.

    Parameters
    ----------
    flow : SlowFlow
        Scalar fields, without friction.

    Raises
    ------
    ValueError
        If there is friction, or no damping (then there is no linear peak).
    """
    _check(flow)
    places = np.linspace(float(flow.activation.velocity), float(flow.symmetry_limit.velocity), PLACES)
    force, slope = _held(flow, places)[0::3]
    turns = np.flatnonzero((slope[:-1] < 0.0) & (slope[1:] >= 0.0))
    interior = turns.size > 0
    if interior:
        k = int(turns[np.argmin(force[turns])])
        best = root_scalar(
            lambda b: float(_held(flow, np.asarray(b))[3]),
            bracket=(places[k], places[k + 1]),
            xtol=4.0 * ROUNDOFF,
        ).root
    else:
        best = places[int(np.argmin(force))]
    found = tuned_backbone(flow, best)
    return BestClearance(
        float(best), float(found.amplitude), float(found.ratio), float(found.frequency), bool(interior)
    )


def _held(flow: SlowFlow, b: NDArray) -> tuple[NDArray, NDArray, NDArray, NDArray]:
    """Return ``F/(eps b k)``, ``C`` and ``Omega`` at phase resonance, and the derivative of the first with respect to ``B``."""
    eps, damping = flow.mass_ratio, flow.damping
    squared, k1, k2 = flow.harmonics(b)
    d_squared, d_k1, d_k2 = flow.harmonic_slopes(b)
    amplitude = np.sqrt(squared)
    d_amplitude = d_squared / (2.0 * amplitude)
    left = squared - eps * k2
    omega2 = squared / left
    d_omega2 = (d_squared * left - squared * (d_squared - eps * d_k2)) / left**2
    omega = np.sqrt(omega2)
    d_omega = d_omega2 / (2.0 * omega)
    force = damping * omega * amplitude - omega2 * k1 / amplitude
    slope = (
        damping * (d_omega * amplitude + omega * d_amplitude)
        - (d_omega2 * k1 + omega2 * d_k1) / amplitude
        + omega2 * k1 * d_amplitude / squared
    )
    return force, amplitude, omega, slope


def _check(flow: SlowFlow) -> None:
    if np.any(np.asarray(flow.level) != 0.0):
        raise ValueError(
            f"friction = {flow.friction} and gravity = {flow.gravity}: the tuned backbone is that of a cavity without friction; "
            "set friction = 0."
        )
    if np.any(np.asarray(flow.damping) <= 0.0):
        raise ValueError(
            f"damping = {flow.damping}: without damping the oscillator has no linear peak; give a number above 0."
        )
