"""Backbone of the impacting response: amplitude, forcing and detuning at phase resonance.

With ``gamma = -pi/2`` the steady slow flow gives ``G = (lambda C^2 - k1)/C`` and ``sigma = k2/(2 C^2)``.
Written in the amplitude (source: the paper's section "Resonance shift and backbone curve", its printed
frequency corrected), with ``q = b C``,

    f_R = f_0 [1 + eps b^2/(2 q^2) (K_gamma - beta_gamma sqrt(C^2 - C_min^2)) - eps/(pi^2/4 + R^2)]
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from orbits.arguments import Reals

from .flow import SlowFlow


@dataclass(frozen=True)
class Backbone:
    """Phase-resonant steady states as arrays over ``B``: `amplitude` ``C``, `forcing` ``G``, `detuning`
    ``sigma``."""

    velocity: NDArray
    amplitude: NDArray
    forcing: NDArray
    detuning: NDArray
    frequency: NDArray


@dataclass(frozen=True)
class Coefficients:
    """The slow flow on the impacting manifold written in ``C^2`` and ``y = sqrt(C^2 - C_min^2)``.

    ``(C^2)' = -alpha_c C^2 -+ beta_c y + offset_c - G C sin(gamma)`` and
    ``2 C^2 gamma' = -alpha_gamma C^2 -+ beta_gamma y + offset_gamma - G C cos(gamma)``; upper sign on the
    right part.
    """

    alpha_c: Reals
    beta_c: Reals
    offset_c: Reals
    alpha_gamma: Reals
    beta_gamma: Reals
    offset_gamma: Reals


def coefficients(flow: SlowFlow, detuning: float = 0.0) -> Coefficients:
    """Coefficients of the slow flow in the amplitude; with the exact closure ``beta_c = (8/pi) R
    B_min/sqrt(pi^2/4 + R^2)``."""
    R, h, kappa = flow.loss, flow.level, flow.kappa
    size = 0.25 * np.pi**2 + R**2
    low = flow.activation
    tilt = h * (4.0 / np.pi - 0.5 * np.pi * kappa)
    return Coefficients(
        alpha_c=flow.damping + (4.0 / np.pi) * R / size,
        beta_c=((8.0 / np.pi) * R * low.velocity + tilt) / np.sqrt(size),
        offset_c=-(4.0 / np.pi) * R * (low.velocity**2 - low.amplitude**2 / size)
        - tilt * low.velocity
        - kappa * h,
        alpha_gamma=2.0 / size + 2.0 * detuning,
        beta_gamma=(4.0 * low.velocity - 4.0 / np.pi + kappa * R * h) / np.sqrt(size),
        offset_gamma=(4.0 / np.pi) * low.velocity * (1.0 - 0.5 * np.pi * low.velocity)
        + 2.0 * low.amplitude**2 / size
        - kappa * h * (R * low.velocity + h),
    )


def backbone(flow: SlowFlow, velocity: ArrayLike | None = None) -> Backbone:
    """Backbone over mean velocities ``B`` (default: 200 values over the attracting part of the manifold)."""
    if velocity is None:
        velocity = np.linspace(float(flow.activation.velocity), float(flow.symmetry_limit.velocity), 200)
    b = np.asarray(velocity, dtype=float)
    squared, k1, k2 = flow.harmonics(b)
    amplitude = np.sqrt(squared)
    detuning = k2 / (2.0 * squared)
    return Backbone(
        b,
        amplitude,
        (flow.damping * squared - k1) / amplitude,
        detuning,
        np.asarray(flow.frequency(detuning)),
    )


def resonance_detuning(flow: SlowFlow, amplitude: ArrayLike) -> NDArray | float:
    """Resonance shift ``sigma_R(C)`` on the attracting part of the manifold; nan below the activation threshold."""
    c = coefficients(flow)
    squared = np.asarray(amplitude, dtype=float) ** 2
    with np.errstate(invalid="ignore"):
        rise = np.sqrt(squared - np.asarray(flow.activation.amplitude) ** 2)
    return (c.offset_gamma - c.beta_gamma * rise) / (2.0 * squared) - 0.5 * c.alpha_gamma


def resonance_frequency(
    displacement: ArrayLike, *, cavity: ArrayLike, natural_frequency: ArrayLike, flow: SlowFlow
) -> NDArray | float:
    """Resonance frequency ``f_R`` in Hz at a resonant displacement of the oscillator.

    Parameters
    ----------
    displacement : array_like
        Amplitude ``q_1`` [m].
    cavity : array_like
        Half-width ``b`` [m].
    natural_frequency : array_like
        ``f_0`` [Hz].
    flow : SlowFlow
        Supplies ``R``, ``h`` and ``eps``.
    """
    shift = resonance_detuning(flow, np.asarray(displacement, float) / np.asarray(cavity, float))
    return np.asarray(natural_frequency, float) * flow.frequency(shift)
