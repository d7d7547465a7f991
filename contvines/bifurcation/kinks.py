"""Kinks: the nearest multiplier comes to the circle in a straight line, and goes back in another one.

Along a branch a multiplier that touches the circle does so as a parabola. Where it falls to nothing in a straight line, and no count
changes, a step has led from one branch to another through the point in which they cross: both are unstable alike, and where unknowns of
very different sizes hide the corner the rule of the loop, which compares tangents, sees none (x (2 p + 3 x^2 + 3) = 0 behind unknowns hundreds
of times as large).
"""

from __future__ import annotations

import numpy as np

from ..continuation.engine import Engine
from .multiplier_counts import sizes_by_sort
from .scan import Spectra
from .segment import Segment

PLACES = np.linspace(0.0, 1.0, 9)
ZOOMS = 8


def nearest(engine: Engine, rows: np.ndarray, spectra: Spectra | None = None) -> np.ndarray:
    """Distance of the real multiplier nearest to +1 (of eigenvalues: to zero, pairs included, which pass the axis elsewhere), shape (n,).

    Of points whose multipliers are known to tell something it need not be computed again; on the circle it is NaN there.
    """
    if engine.many:
        return -rows[:, 0]
    if spectra is not None and engine.detection != "real":
        return spectra.near
    with np.errstate(all="ignore"):
        if engine.detection == "real":
            sizes = np.hypot(rows[:, : 2 * engine.m : 2], rows[:, 1 : 2 * engine.m : 2])
        else:
            sizes = np.abs(sizes_by_sort(engine, rows)[0])
        return np.fmin.reduce(sizes, axis=1, initial=np.inf)


def kinked(segment: Segment) -> bool:
    """Whether the real multiplier nearest to the circle has a kink there within a segment: looked at nearer, its sides stay as steep.

    Of cycles on a mesh nothing is told where both ends are next to the circle, as where a branch turns round at a cycle of half the period.
    """
    engine, low, high, first = segment.engine, 0.0, 1.0, 0.0
    for zoom in range(ZOOMS):
        places = low + (high - low) * PLACES
        rows, found = segment.rows(places)
        places = places[found]
        if len(places) < 3:
            return False
        near = nearest(engine, rows[found])
        k = int(np.argmin(near[1:-1])) + 1
        steepness = min(near[0], near[-1]) / (high - low)
        if not (np.isfinite(near).all() and near[k] < min(near[0], near[-1])):
            return False
        if zoom == 0:
            if engine.adaptive and max(near[0], near[-1]) <= engine.settings.critical:
                return False  # kinks are those of rounding
            first = steepness
        elif steepness < engine.settings.steep * first:
            return False
        low, high = float(places[k - 1]), float(places[k + 1])
    return True
