"""Scanning points of a branch with numpy: which segments are marked, and why. native/scan.hpp does the same for compiled problems."""

from __future__ import annotations

import numpy as np

from ..continuation.aims import FLOW, MAP, REAL
from ..continuation.arrays import Metric
from ..continuation.loop import MARGIN
from .multiplier_counts import PAST
from .segment_flags import (
    APART,
    BORDER,
    DAMPED,
    FOLD,
    HUMP,
    LANDING,
    MEETING,
    MULTIPLIER,
    NEXT,
    SHALLOW,
    SINGULAR,
    WITHIN,
    Scanned,
    Symmetries,
)


def mark_segments(
    chunk: Scanned,
    first_margin: int,
    kind: int,
    real: bool,
    flat: float,
    metric: Metric,
    symmetries: Symmetries,
    flags: np.ndarray,
    smallest: np.ndarray,
) -> None:
    """Fill `flags` (n - 1,), bits per segment, and `smallest` (n,), the smallest margin (infinity without margins).

    Parameters
    ----------
    chunk : Scanned
    first_margin : int
        Columns of `rows` before this one are multipliers as (re, im) pairs.
    kind : int
        NONE, MAP, FLOW or REAL (real eigenvalues tell branch points; there is no stability).
    real : bool
        Whether the branch has positive margins.
    flat : float
        Slopes below this are zero.
    metric : Metric
    symmetries : Symmetries
    """
    points, values, slopes, rows, signs = chunk
    orders, images, constants, shift, _ = symmetries
    with np.errstate(all="ignore"):
        smallest[:] = np.fmin.reduce(rows[:, first_margin:], axis=1, initial=np.inf)
        if len(values) < 2:
            return
        positive, above = slopes >= 0.0, np.abs(slopes) > flat
        flags |= np.where((positive[1:] != positive[:-1]) & (above[1:] | above[:-1]), FOLD, 0)
        flags |= np.where((signs[1:] >= 0.0) != (signs[:-1] >= 0.0), SINGULAR, 0)
        counts, damping = _past(rows[:, 0:first_margin:2], rows[:, 1:first_margin:2], kind)
        flags |= np.where((counts[:, 1:] != counts[:, :-1]).any(axis=0), MULTIPLIER, 0)
        outside = smallest < MARGIN
        flags |= np.where((outside[1:] != outside[:-1]) & (outside[1:] == real), BORDER, 0)
        if len(orders):
            meets, lands = _meet(points, orders, images, constants, shift)
            flags |= np.where(meets, MEETING, 0) | np.where(lands, LANDING, 0)
        steps, changes = np.diff(points, axis=0), np.diff(values)
        lengths = np.sqrt(
            metric.of_unknowns * np.einsum("ij,ij->i", steps, steps) + metric.of_parameter * changes**2
        )
        here, there = slopes[:-1], slopes[1:]
        steep = (here * there > 0.0) & above[1:] & above[:-1] & (lengths > 0.0)
        side = np.where(here > 0.0, 1.0, -1.0)
        flags |= np.where(steep & _turns_twice(side * here, side * there, side * changes / lengths), HUMP, 0)
        # three neighbours: marks the segments on both sides of the middle one
        sided = side[1:]
        humps = steep[1:] & dips(sided * slopes[:-2], sided * slopes[1:-1], sided * slopes[2:], lengths)
        _mark_both(flags, humps, HUMP)
        if real:
            shallow = dips(smallest[:-2], smallest[1:-1], smallest[2:], lengths)
            # one of the margins, be others smaller or lost
            for margin in rows.T[first_margin:] - MARGIN:
                shallow |= dips(margin[:-2], margin[1:-1], margin[2:], lengths)
            _mark_both(flags, shallow, SHALLOW)
        if kind in (MAP, FLOW) and first_margin > 0:
            _mark_both(flags, dips(damping[:-2], damping[1:-1], damping[2:], lengths), DAMPED)


def _mark_both(flags: np.ndarray, middles: np.ndarray, bit: int) -> None:
    flags[:-1] |= np.where(middles, bit, 0)
    flags[1:] |= np.where(middles, bit, 0)


def _past(re: np.ndarray, im: np.ndarray, kind: int) -> tuple[np.ndarray, np.ndarray]:
    """How many multipliers are past 1, past -1 and pairs past the circle (or the axis) at each point; and the damping."""
    single, counts = im == 0.0, np.zeros((3, len(re)), dtype=np.int64)
    if kind == MAP:
        modulus = np.where(single, np.abs(re), np.sqrt(re * re + im * im))
        counts[0] = np.count_nonzero(single & (re > 1.0 + PAST), axis=1)
        counts[1] = np.count_nonzero(single & (re < -1.0 - PAST), axis=1)
        counts[2] = np.count_nonzero(~single & (im > 0.0) & (modulus > 1.0 + PAST), axis=1)
        outermost = np.fmax.reduce(modulus, axis=1, initial=-np.inf)
        return counts, np.where(outermost > 0.0, -np.log(outermost), np.inf)
    if kind in (FLOW, REAL):
        counts[0] = np.count_nonzero((single | (kind == REAL)) & (re > PAST), axis=1)
    if kind == FLOW:
        counts[2] = np.count_nonzero((im > 0.0) & (re > PAST), axis=1)
        return counts, -np.fmax.reduce(re, axis=1, initial=-np.inf)
    return counts, np.full(len(re), np.inf)


def _meet(
    points: np.ndarray, orders: np.ndarray, images: np.ndarray, constants: np.ndarray, shift: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Where the part that a symmetry changes turns round, and where it all but vanishes, modulo shifts by a period."""
    meets, lands = np.zeros((2, len(points) - 1), dtype=bool)
    whole = float(shift @ shift)
    for order, image, constant in zip(orders, images, constants):
        gap = points - (image * points[:, order] + constant)
        if whole > 0.0:
            gap = gap - np.outer(np.round((gap @ shift) / whole), shift)
        turned, landed = turns_and_landings(gap)
        meets |= turned
        lands |= landed
    return meets, lands


def turns_and_landings(part: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Where a part of the unknowns, of shape (n, N), turns round, and where it all but vanishes: next to where it does."""
    size = np.abs(part).max(axis=1, initial=0.0)
    far = size > APART
    turns = far[1:] & far[:-1] & (np.einsum("ij,ij->i", part[1:], part[:-1]) < 0.0)
    return turns, far[:-1] & (size[1:] < WITHIN) & (size[1:] < NEXT * size[:-1])


def dips(left: np.ndarray, middle: np.ndarray, right: np.ndarray, lengths: np.ndarray) -> np.ndarray:
    """Where the parabola through three neighbouring positive values dips below zero between them; of n - 1 segments n - 2."""
    h1, h2 = lengths[:-1], lengths[1:]
    sound = (left > 0.0) & (middle > 0.0) & (right > 0.0) & (h1 > 0.0) & (h2 > 0.0)
    sound &= (left < np.inf) & (middle < np.inf) & (right < np.inf)
    if not sound.any():
        return sound
    before, after = (middle - left) / h1, (right - middle) / h2
    bend = (after - before) / (h1 + h2)
    slope = (before * h2 + after * h1) / (h1 + h2)
    vertex = -0.5 * slope / bend
    below = middle - 0.25 * slope * slope / bend < 0.0
    return sound & (bend > 0.0) & (-h1 < vertex) & (vertex < h2) & below


def _turns_twice(here: np.ndarray, there: np.ndarray, mean: np.ndarray) -> np.ndarray:
    """Where the cubic with these positive slopes at its ends, and this mean slope, falls in between."""
    bend = 3.0 * (here + there - 2.0 * mean)
    middle = 2.0 * here + there - 3.0 * mean
    return (bend > 0.0) & (middle > 0.0) & (middle < bend) & (here * bend < middle * middle)
