"""The next point of a curve that is grown without the inverse of the motion: where a small circle's image crosses what is known."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import numpy as np

from ..shared.floating_point import TINY
from .settings import MANIFOLDS

TURN = 0.3  # angle between two steps beyond which the radius shrinks
ARCS = 12  # candidates on the part of a circle that is searched
REFINED = 60  # times that an angle is refined, at most


def next_point(
    image: Callable[[np.ndarray], np.ndarray],
    known: tuple[np.ndarray, np.ndarray, int],
    last: np.ndarray,
    heading: np.ndarray,
    radius: float,
    widest: float,
) -> tuple[np.ndarray, int, float] | None:
    """The point on the circle whose image lies on the known segments, from `known[2]` on, the segment on which it lies, and the angle turned by."""
    middle = np.arctan2(heading[1], heading[0])

    def offset(angle: float) -> tuple[float, int, bool]:
        return _beside(*known, image(last + radius * np.array([np.cos(angle), np.sin(angle)])))

    count = int(np.ceil(ARCS * max(1.0, widest))) if widest > TURN else ARCS
    turns = [float(turn) for turn in widest * np.linspace(-1.0, 1.0, count + 1)]
    order = sorted(pairwise(turns), key=lambda ends: abs(ends[0] + ends[1]))
    sides: dict[float, tuple[float, int, bool]] = {}
    for low, high in order:
        for turn in (low, high):
            if turn not in sides:
                sides[turn] = offset(middle + turn)
        a, b = sides[low][0], sides[high][0]
        if not (np.isfinite(a) and np.isfinite(b)) or a * b > 0.0:
            continue
        value, segment, beyond, half = a, known[2], False, 0.0
        for k in range(REFINED):  # Illinois' rule, and every third time the middle: the motion may jump
            half = 0.5 * (low + high) if k % 3 == 2 or a == b else low + (high - low) * a / (a - b)
            value, segment, beyond = offset(middle + half)
            if not np.isfinite(value):
                return None
            if value * a > 0.0:
                low, a, b = half, value, 0.5 * b
            else:
                high, b, a = half, value, 0.5 * a
            if abs(value) < MANIFOLDS.on_curve * radius:
                break
        if (
            beyond or abs(value) > MANIFOLDS.jump * radius
        ):  # a jump of the motion, not a crossing of the curve
            continue
        there = last + radius * np.array([np.cos(middle + half), np.sin(middle + half)])
        return there, segment, abs(half)
    return None


def _beside(starts: np.ndarray, ends: np.ndarray, at: int, point: np.ndarray) -> tuple[float, int, bool]:
    """Signed distance of a point to known segments near that numbered `at` or later ones, the nearest segment, and whether the point is

    beyond what is known: then the distance is that to the last segment's line, whose side still tells where a saddle throws it.
    """
    if not np.all(np.isfinite(point)):
        return float("nan"), at, False
    first = max(at - 2, 0)
    starts, ends = starts[first:], ends[first:]
    along = ends - starts
    lengths = np.maximum((along * along).sum(axis=1), TINY)
    part = ((point - starts) * along).sum(axis=1) / lengths
    inside = np.clip(part, 0.0, 1.0)
    gaps = np.linalg.norm(point - (starts + inside[:, None] * along), axis=1)
    k = int(gaps.argmin())
    across = along[k, 0] * (point - starts[k])[1] - along[k, 1] * (point - starts[k])[0]
    if k == len(gaps) - 1 and part[k] > 1.0:
        return float(across / np.sqrt(lengths[k])), at, True
    return float(np.sign(across) * gaps[k]), first + k, False
