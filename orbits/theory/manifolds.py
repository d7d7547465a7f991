"""Slow manifolds: motions on which the absorber settles fast while the amplitude of the oscillator varies slowly.

There are two: on the *impacting* manifold the absorber has two symmetric impacts per period with mean
absolute velocity ``B``; on the *sliding* one (``B = 0``) it turns before it reaches a wall.
All functions broadcast over numpy arrays. ``R = (1 - r)/(1 + r)`` is the impact loss and ``h = (pi/2) mu g``
the friction, both dimensionless (lengths in half-widths of the cavity, time in 1/omega_0).

Sources: Youssef, Karoui and Leine, sections "The slow invariant manifold", "Linear stability and bifurcation
analysis" and "Purely sliding absorber"; the lower end of sliding is Den Hartog's limit of motion without
stops.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray


class ManifoldPoint(NamedTuple):
    """A point of a slow manifold: velocity ``B`` and amplitude ``C`` (not its square)."""

    velocity: NDArray | float
    amplitude: NDArray | float


def impact_loss(restitution: ArrayLike) -> NDArray | float:
    """``R = (1 - r)/(1 + r)``: 0 for elastic walls, 1 for perfectly inelastic ones."""
    r = np.asarray(restitution, dtype=float)
    return (1.0 - r) / (1.0 + r)


def friction_level(friction: ArrayLike, gravity: ArrayLike, mass_ratio: ArrayLike = 0.0) -> NDArray | float:
    """``h = (pi/2) mu g``; with a mass ratio, ``h~ = (1 + eps) h`` of the exact maps."""
    return (
        0.5
        * np.pi
        * np.asarray(friction, float)
        * np.asarray(gravity, float)
        * (1.0 + np.asarray(mass_ratio))
    )


def squared_amplitude(velocity: ArrayLike, loss: ArrayLike, level: ArrayLike) -> NDArray | float:
    """Impacting manifold: ``C^2 = (1 - pi B/2)^2 + (R B + h)^2``."""
    b = np.asarray(velocity, dtype=float)
    return (1.0 - 0.5 * np.pi * b) ** 2 + (np.asarray(loss) * b + np.asarray(level)) ** 2


def slope(velocity: ArrayLike, loss: ArrayLike, level: ArrayLike) -> NDArray | float:
    """``d(C^2)/dB`` along the impacting manifold; negative on its left (repelling) part."""
    b, R = np.asarray(velocity, dtype=float), np.asarray(loss)
    return -np.pi * (1.0 - 0.5 * np.pi * b) + 2.0 * R * (R * b + np.asarray(level))


def activation(loss: ArrayLike, level: ArrayLike) -> ManifoldPoint:
    """Lowest point of the impacting manifold; below its amplitude the absorber has no impacting motion.

    ``B_min = (2 pi - 4 R h)/(pi^2 + 4 R^2)``, ``C_min = (pi h + 2 R)/sqrt(pi^2 + 4 R^2)``. There the symmetric
    orbit has a fold (multiplier +1).
    """
    R, h = np.asarray(loss, float), np.asarray(level, float)
    size = np.pi**2 + 4.0 * R**2
    return ManifoldPoint((2.0 * np.pi - 4.0 * R * h) / size, (np.pi * h + 2.0 * R) / np.sqrt(size))


def symmetry_limit(loss: ArrayLike, level: ArrayLike) -> ManifoldPoint:
    """Upper end of the attracting part of the impacting manifold: symmetry breaking into an asymmetric pair.

    ``B_max = (2 pi - 4 R h)/(pi^2 - 4)``, and ``C_max`` is the amplitude of the manifold there. With
    ``h~ = (1 + eps) h`` the value is exact for the reduced model at ``Omega = 1``.
    """
    R, h = np.asarray(loss, float), np.asarray(level, float)
    velocity = (2.0 * np.pi - 4.0 * R * h) / (np.pi**2 - 4.0)
    return ManifoldPoint(velocity, np.sqrt(squared_amplitude(velocity, R, h)))


def velocity_at(amplitude: ArrayLike, loss: ArrayLike, level: ArrayLike, branch: int = 1) -> NDArray | float:
    """Mean velocity ``B`` of the impacting manifold at an amplitude ``C``: `branch` +1 is the right (attracting) part, -1 the left.

    nan below the activation threshold, where the manifold has no point.
    """
    R = np.asarray(loss, dtype=float)
    low = activation(R, level)
    rise = np.asarray(amplitude, dtype=float) ** 2 - np.asarray(low.amplitude) ** 2
    with np.errstate(invalid="ignore"):
        return low.velocity + branch * np.sqrt(rise / (0.25 * np.pi**2 + R**2))


def reversal_bound(amplitude: ArrayLike, velocity: ArrayLike, level: ArrayLike) -> NDArray | float:
    """Margin ``B - h - C`` of the impacting ansatz, which is valid where it is positive.

    A sufficient condition: the relative velocity ``C cos + B - h(...)`` then cannot change sign during a
    flight, so the friction force has the direction that the ansatz assumes.
    """
    return np.asarray(velocity, float) - np.asarray(level, float) - np.asarray(amplitude, float)


def sliding_bounds(level: ArrayLike) -> tuple[NDArray | float, NDArray | float]:
    """Amplitudes ``C`` between which the absorber slides without sticking and without impacts.

    ``C^2`` lies between ``h^2 (1 + 4/pi^2)`` (below, the absorber sticks at each turn) and ``1 + h^2`` (it
    grazes the walls). At a turn the acceleration of the cavity equals the turning point
    ``delta = sqrt(C^2 - h^2)``; it exceeds friction while ``delta > (2/pi) h``.
    """
    h = np.asarray(level, dtype=float)
    return h * np.sqrt(1.0 + 4.0 / np.pi**2), np.sqrt(1.0 + h**2)


def turning_point(amplitude: ArrayLike, level: ArrayLike) -> NDArray | float:
    """Position at which the purely sliding absorber turns, ``delta = sqrt(C^2 - h^2)`` (half-widths of the cavity)."""
    with np.errstate(invalid="ignore"):
        return np.sqrt(np.asarray(amplitude, float) ** 2 - np.asarray(level, float) ** 2)
