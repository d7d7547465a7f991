"""Dips: a test function that touches zero between two points and comes back, so that no sign changes.

Suspected where the parabola through three neighbouring points passes zero though none of the points does, and then looked
for on the branch itself.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..continuation.engine import Engine, Solved
from .segment import Segment

GOLDEN = 0.3819660112501051


def suspects(lengths: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Indices of points next to which the parabola through a positive function dips below zero.

    Parameters
    ----------
    lengths : ndarray, shape (n - 1,)
        Distances between neighbouring points.
    values : ndarray, shape (n,)
        Positive and finite where there is anything to suspect.
    """
    if len(values) < 3:
        return np.zeros(0, dtype=int)
    left, middle, right = values[:-2], values[1:-1], values[2:]
    h1, h2 = lengths[:-1], lengths[1:]
    with np.errstate(all="ignore"):
        before, after = (middle - left) / h1, (right - middle) / h2
        bend = (after - before) / (h1 + h2)
        slope = (before * h2 + after * h1) / (h1 + h2)
        vertex = -0.5 * slope / bend
        lowest = middle - 0.25 * slope**2 / bend
        found = (bend > 0.0) & (vertex > -h1) & (vertex < h2) & (lowest < 0.0)
        found &= (left > 0.0) & (middle > 0.0) & (right > 0.0)
    return np.flatnonzero(found) + 1


def below_zero(segment: Segment, test: Callable[[Solved], float]) -> tuple[float, Solved] | None:
    """A point of the segment where the test is negative, or None; by golden-section search."""
    low, high = 0.0, 1.0
    points: dict[float, tuple[float, Solved]] = {}

    def value(s: float) -> float:
        if s not in points:
            found = segment.at(s)
            if found is None:
                return np.inf
            points[s] = (float(test(found)), found)
        return points[s][0]

    a, b = low + GOLDEN * (high - low), high - GOLDEN * (high - low)
    fa, fb = value(a), value(b)
    for _ in range(25):
        for s, f in ((a, fa), (b, fb)):
            if f < -1e-12:
                return s, points[s][1]
        if fa < fb:
            high, b, fb = b, a, fa
            a = low + GOLDEN * (high - low)
            fa = value(a)
        else:
            low, a, fa = a, b, fb
            b = high - GOLDEN * (high - low)
            fb = value(b)
    return None


def lengths_of(engine: Engine, points: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Distances between neighbouring points in the metric."""
    square = (np.diff(points, axis=0) ** 2) @ engine.weights[:-1] + engine.weights[-1] * np.diff(values) ** 2
    return np.sqrt(square)
