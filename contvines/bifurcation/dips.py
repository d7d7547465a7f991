"""Dips: a test function that touches zero between two points and comes back, so that no sign changes.

:mod:`contvines.bifurcation.scan` suspects them where the parabola through three neighbouring points passes zero though none of
the points does; here they are looked for on the branch itself. A margin may also dip before the border of another margin
in the same segment, whose other end then says nothing of it.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..continuation.engine import Solved
from ..continuation.loop import MARGIN
from .scan import dips
from .segment import Segment

GOLDEN = 0.3819660112501051
SHARES = np.array([0.99, 0.9, 0.7, 0.4])  # of the way to a border: other margins are looked at there


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


def before_border(segment: Segment, position: float, border: Solved) -> tuple[float, Solved] | None:
    """A point up to a border where another margin is negative, though it is positive at both ends, or None.

    Parameters
    ----------
    segment : Segment
    position : float
        Of the border, in [0, 1].
    border : Solved
    """
    if not 0.0 < position < 1.0:
        return None
    first = 2 * segment.engine.m
    left, middle, right = (point.row[first:] for point in (segment.a, border, segment.b))
    if (middle < MARGIN).any():  # one of a flight, say, that is over before the segment is
        return position, border
    rows, found = segment.rows(position * SHARES)
    below = found & (rows[:, first:] < MARGIN).any(axis=1)
    for share in SHARES[below].tolist():
        point = segment.at(share * position)
        if point is not None:
            return share * position, point
    convex = (middle < (1.0 - position) * left + position * right).nonzero()[0]
    parts = (position * segment.length, (1.0 - position) * segment.length)
    sides = (margins[convex].tolist() for margins in (left, middle, right))
    suspects = [j for j, a, b, c in zip(convex.tolist(), *sides) if dips(a, b, c, *parts)]
    if not suspects:
        return None
    part = Segment(segment.engine, segment.a, border)
    found = below_zero(part, lambda point: float(segment.engine.margins(point.row)[suspects].min()))
    if found is None:
        return None
    _, point = found
    # measured along the chord of the whole segment
    return float(
        segment.border @ (segment.engine.join(point.u, point.p) - segment.za)
    ) / segment.length, point
