"""Dips: a test function that touches zero between two points and comes back, so that no sign changes.

:mod:`contvines.events.scan` suspects them where the parabola through three neighbouring points passes zero though none of
the points does; here they are looked for on the branch itself.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..continuation.engine import Solved
from .segment import Segment

GOLDEN = 0.3819660112501051


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
