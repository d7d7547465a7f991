"""Compare motions by w as a function of the phase, independently of their words."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from orbits.orbit import PER_PERIOD

BACKWARDS = -1e-6  # a smaller duration counts as negative; durations at singular points of virtual branches have half the digits
LONGEST = 64  # most forcing periods over which motions are compared


def apart(one: Any, other: Any, *, images: bool = True) -> float:
    """Largest difference in w between two orbits, relative to the machine's unit of length.

    The result is the smallest one over shifts by whole forcing periods and, with `images`, mirror images (if the machine has them). The
    position of motions without impacts is free. nan for virtual orbits with negative durations, and for very long orbits.
    """
    if min(one.durations.min(initial=0.0), other.durations.min(initial=0.0)) < BACKWARDS:
        return math.nan
    periods = math.lcm(one.periods, other.periods)
    if periods > LONGEST:
        return math.nan
    here, there = (
        np.tile(orbit.positions(PER_PERIOD)[:, 0], periods // orbit.periods) for orbit in (one, other)
    )
    free = not (one.impacts and other.impacts)
    faces = [here]
    if images and one.model.has_mirror(one.params):
        left, right = one.model.walls(one.params)
        faces.append(float(left + right) - np.roll(here, PER_PERIOD // 2))
    gaps = np.array([np.roll(face, k * PER_PERIOD) - there for face in faces for k in range(periods)])
    sizes = 0.5 * np.ptp(gaps, axis=1) if free else np.abs(gaps).max(axis=1)
    return float(sizes.min()) / one.model.natural_units(one.params)[0]


def shortest(orbit: Any, near: float = 1e-7) -> int:
    """Smallest number of forcing periods (a divisor of the orbit's) after which w repeats."""
    for periods in range(1, orbit.periods):
        if orbit.periods % periods == 0:
            track = orbit.positions(PER_PERIOD)[:, 0]
            gap = np.roll(track, periods * PER_PERIOD) - track
            if np.abs(gap).max() < near * orbit.model.natural_units(orbit.params)[0]:
                return periods
    return orbit.periods


def alike(listed: np.ndarray, seen: np.ndarray) -> float:
    """Largest difference of the characteristic polynomials of two sets of multipliers, relative to their largest coefficient."""
    one, other = np.poly(listed), np.poly(seen)
    if one.shape != other.shape or not (np.isfinite(one).all() and np.isfinite(other).all()):
        return math.inf
    return float(np.abs(one - other).max() / max(np.abs(one).max(), np.abs(other).max()))
