"""Free decay along the impacting manifold, until the amplitude reaches the activation threshold.

With ``G = 0`` the amplitude decouples from the phase, ``(C^2)' = -alpha_c C^2 - beta_c y + offset_c`` with
``y = sqrt(C^2 - C_min^2)``. Without the middle term one obtains the linear upper bound of the paper,
``C^2 <= (C_0^2 - offset_c/alpha_c) exp(-alpha_c tau_1) + offset_c/alpha_c``. The full equation is separable,
``tau_1 = 2 int z dz/(alpha_c z^2 + beta_c z + c)`` with ``c = alpha_c C_min^2 - offset_c``, and is solved
here exactly.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import PchipInterpolator

from orbits.settings import THEORY

from .backbone import coefficients
from .flow import SlowFlow


def _rise(flow: SlowFlow, amplitude: ArrayLike, name: str) -> NDArray:
    """Return ``y = sqrt(C^2 - C_min^2)``; raise a ValueError that names `name` if an amplitude lies below ``C_min``."""
    low = float(flow.activation.amplitude)
    squared = np.asarray(amplitude, dtype=float) ** 2 - low**2
    if np.any(squared < -THEORY.rounding):
        raise ValueError(
            f"{name} = {float(np.min(amplitude))!r} lies below the activation threshold C_min = {low:.6g}; "
            "the absorber does not stay on the impacting manifold there."
        )
    return np.sqrt(np.maximum(squared, 0.0))


def decay_time(flow: SlowFlow, start: ArrayLike, end: ArrayLike | None = None) -> NDArray | float:
    """Slow time ``eps tau`` from amplitude `start` down to `end` (default: the activation threshold).

    Raises
    ------
    ValueError
        If an amplitude lies below the activation threshold.
    """
    c = coefficients(flow)
    alpha, beta = float(c.alpha_c), float(c.beta_c)
    free = alpha * float(flow.activation.amplitude) ** 2 - float(c.offset_c)
    top = _rise(flow, start, "start")
    bottom = np.zeros_like(top) if end is None else _rise(flow, end, "end")
    if alpha == 0.0:
        raise ValueError(
            "damping = 0 and restitution = 1: nothing but friction takes energy, and the flow does not decay."
        )
    spread = beta**2 - 4.0 * alpha * free

    def primitive(z: NDArray) -> NDArray:
        log = np.log(alpha * z**2 + beta * z + free) / alpha
        if spread > 0:
            root = np.sqrt(spread)
            rest = -np.log((2 * alpha * z + beta - root) / (2 * alpha * z + beta + root)) / root
        elif spread < 0:
            root = np.sqrt(-spread)
            rest = -2.0 * np.arctan((2 * alpha * z + beta) / root) / root
        else:
            rest = 2.0 / (2 * alpha * z + beta)
        return log + (beta / alpha) * rest

    elapsed = primitive(top) - primitive(bottom)
    return float(elapsed) if np.ndim(elapsed) == 0 else elapsed


def decay_amplitude(flow: SlowFlow, start: float, slow_time: ArrayLike) -> NDArray:
    """Amplitude ``C`` at slow times ``eps tau`` of a free decay from `start`; nan after the activation
    threshold is reached."""
    low = float(flow.activation.amplitude)
    top = float(_rise(flow, start, "start"))
    rises = top * (1.0 - np.cos(np.linspace(0.0, np.pi, 801))) / 2.0
    amplitudes = np.sqrt(low**2 + rises**2)
    times = np.asarray(decay_time(flow, start, amplitudes))
    spline = PchipInterpolator(times[::-1], rises[::-1])
    asked = np.asarray(slow_time, dtype=float)
    guess = np.where(
        (asked >= 0.0) & (asked <= times[0]), spline(np.clip(asked, times[-1], times[0])), np.nan
    )
    c = coefficients(flow)
    free = c.alpha_c * low**2 - c.offset_c
    for _ in range(3):
        z = np.where(np.isfinite(guess), np.maximum(guess, THEORY.rounding * max(top, THEORY.rounding)), top)
        error = np.asarray(decay_time(flow, np.full_like(z, start), np.sqrt(low**2 + z**2))) - asked
        z_new = z + error * (c.alpha_c * z**2 + c.beta_c * z + free) / (2.0 * z)
        guess = np.where(np.isfinite(guess) & (z_new > 0) & (z_new <= top), z_new, guess)
    return np.sqrt(low**2 + guess**2)


def decay_bound(flow: SlowFlow, start: float, slow_time: ArrayLike) -> NDArray:
    """The paper's exponential upper bound of the amplitude ``C`` at slow times ``eps tau``.

    nan where it is below the activation threshold, because the motion along the manifold has ended before.
    """
    c = coefficients(flow)
    rest = c.offset_c / c.alpha_c
    squared = (start**2 - rest) * np.exp(-c.alpha_c * np.asarray(slow_time, dtype=float)) + rest
    with np.errstate(invalid="ignore"):
        return np.sqrt(np.where(squared >= np.asarray(flow.activation.amplitude) ** 2, squared, np.nan))


def decay_rate(flow: SlowFlow) -> float:
    """``alpha_c``: decay rate of ``C^2`` per unit of slow time at large amplitude, independent of
    friction."""
    return float(coefficients(flow).alpha_c)


def damping_ratio(flow: SlowFlow, amplitude: ArrayLike | None = None) -> NDArray | float:
    """Damping ratio equivalent to absorber and dashpot together.

    ``zeta = -eps (C^2)'/(2 C^2)``. Without `amplitude`, return its limit at large amplitude ``eps alpha_c/2``, to which
    the absorber contributes ``2 eps R/(pi (pi^2/4 + R^2))``. The contribution of friction vanishes in this limit as
    ``-(4/pi) eps R^2 h/(pi^2/4 + R^2)^(3/2)/C`` (through ``beta_c``).
    """
    c = coefficients(flow)
    if amplitude is None:
        return 0.5 * flow.mass_ratio * c.alpha_c
    squared = np.asarray(amplitude, dtype=float) ** 2
    rise = _rise(flow, amplitude, "amplitude")
    return 0.5 * flow.mass_ratio * (c.alpha_c + (c.beta_c * rise - c.offset_c) / squared)
