"""Scanning points of a branch: in which segments may there be something to locate?

One pass over the arrays of a chunk; what it marks is examined by :mod:`contvines.events.watch`. The loops here are compiled, for
compiled problems; :mod:`contvines.events.scan_arrays` does the same with numpy for others.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ..continuation import aims, loop
from ..continuation.aims import FLOW, KINDS, MAP, REAL
from ..continuation.engine import Engine
from ..continuation.lengths import Metric
from ..continuation.loop import MARGIN
from . import bits, multipliers
from .bits import (
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
from .multipliers import PAST
from .scan_arrays import mark_segments as with_arrays
from .symmetry import SymmetryTest

FLAT = 1e-9  # a parameter component of the tangent below this is zero (a vertical branch has no folds)


def mark_segments(chunk, first_margin, kind, real, flat, metric, symmetries, flags, smallest):
    """Fill `flags` (n - 1,), bits per segment, and `smallest` (n,), the smallest margin (infinity without margins).

    In one piece: one pass over the chunk, in which each segment's tests share the differences of rows.

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
    points, values, slopes, rows, signs = chunk.points, chunk.values, chunk.slopes, chunk.rows, chunk.signs
    orders, images, constants = symmetries.orders, symmetries.images, symmetries.constants
    shift, gaps = symmetries.shift, symmetries.gaps
    count, size = points.shape
    width = rows.shape[1]
    columns = shift.shape[0]
    whole = 0.0
    for j in range(columns):
        whole += shift[j] * shift[j]
    plus, minus, pairs, outermost = 0, 0, 0, 0.0
    before, before_that = 0.0, 0.0  # outermost multiplier of the two points before
    short = 0.0  # length of the segment before
    for i in range(count):
        # smallest margin; comparisons pass over NaN
        a = b = c = d = np.inf
        j = first_margin
        while j + 3 < width:
            a = rows[i, j] if rows[i, j] < a else a
            b = rows[i, j + 1] if rows[i, j + 1] < b else b
            c = rows[i, j + 2] if rows[i, j + 2] < c else c
            d = rows[i, j + 3] if rows[i, j + 3] < d else d
            j += 4
        while j < width:
            a = rows[i, j] if rows[i, j] < a else a
            j += 1
        smallest[i] = min(min(a, b), min(c, d))
        # multipliers past the circle
        old_plus, old_minus, old_pairs = plus, minus, pairs
        before_that, before = before, outermost
        plus, minus, pairs = 0, 0, 0
        outermost = -np.inf
        for j in range(0, first_margin, 2):
            re, im = rows[i, j], rows[i, j + 1]
            if kind == MAP:
                modulus = abs(re) if im == 0.0 else math.sqrt(re * re + im * im)
                outermost = max(outermost, modulus)
                if im == 0.0:
                    plus += re > 1.0 + PAST
                    minus += re < -1.0 - PAST
                else:
                    pairs += im > 0.0 and modulus > 1.0 + PAST
            elif kind == FLOW:
                outermost = max(outermost, re)
                if im == 0.0:
                    plus += re > PAST
                else:
                    pairs += im > 0.0 and re > PAST
            elif kind == REAL:
                plus += re > PAST
        # the part that a symmetry changes, modulo shifts by a period
        now = i % 2
        for s in range(orders.shape[0]):
            dot = 0.0
            for j in range(columns):
                gap = points[i, j] - (images[s, j] * points[i, orders[s, j]] + constants[s, j])
                gaps[now, s, j] = gap
                dot += gap * shift[j]
            if dot != 0.0:
                turns = np.rint(dot / whole)
                for j in range(columns):
                    gaps[now, s, j] -= turns * shift[j]
        if i == 0:
            continue
        found = 0
        if (slopes[i - 1] >= 0.0) != (slopes[i] >= 0.0) and (
            abs(slopes[i - 1]) > flat or abs(slopes[i]) > flat
        ):
            found |= FOLD
        if (signs[i - 1] >= 0.0) != (signs[i] >= 0.0):
            found |= SINGULAR
        if plus != old_plus or minus != old_minus or pairs != old_pairs:
            found |= MULTIPLIER
        if (smallest[i - 1] < MARGIN) != (smallest[i] < MARGIN) and (smallest[i] < MARGIN) == real:
            found |= BORDER
        for s in range(orders.shape[0]):
            here, there, dot = 0.0, 0.0, 0.0
            for j in range(columns):
                here = max(here, abs(gaps[now, s, j]))
                there = max(there, abs(gaps[1 - now, s, j]))
                dot += gaps[0, s, j] * gaps[1, s, j]
            if dot < 0.0 and here > APART and there > APART:
                found |= MEETING
            if here < WITHIN and there > APART and here < NEXT * there:
                found |= LANDING
        flags[i - 1] = found
        square = 0.0
        for j in range(size):
            change = points[i, j] - points[i - 1, j]
            square += change * change
        change = values[i] - values[i - 1]
        length = math.sqrt(metric.of_unknowns * square + metric.of_parameter * change * change)
        here, there = slopes[i - 1], slopes[i]
        if here * there > 0.0 and abs(here) > flat and abs(there) > flat and length > 0.0:
            side = 1.0 if here > 0.0 else -1.0
            if turns_twice(side * here, side * there, side * change / length):
                flags[i - 1] |= HUMP
            if i > 1 and dips(side * slopes[i - 2], side * here, side * there, short, length):
                flags[i - 2] |= HUMP
                flags[i - 1] |= HUMP
        if i > 1 and short > 0.0 and length > 0.0:
            # a parabola through three values falls below the lowest of them by at most this part of the changes between them
            uneven = max(short / length, length / short)
            share = 0.25 * uneven * uneven
            a, b, c = smallest[i - 2], smallest[i - 1], smallest[i]
            bounded = max(max(a, b), c) < np.inf  # infinite without margins
            if real and (
                (
                    bounded
                    and min(min(a, b), c) < share * (abs(b - a) + abs(c - b))
                    and dips(a, b, c, short, length)
                )
                or one_dips(rows, i, first_margin, short, length, share)
            ):
                flags[i - 2] |= SHALLOW
                flags[i - 1] |= SHALLOW
            if kind in (MAP, FLOW) and first_margin > 0:
                a, b, c = before_that, before, outermost
                most, least, changes = max(max(a, b), c), min(min(a, b), c), abs(b - a) + abs(c - b)
                if kind == FLOW:
                    lost = dips(-a, -b, -c, short, length)
                else:
                    # -log x is at least 1 - x, and steepest at the least x; logarithms take longer than all else here
                    lost = (
                        least > 0.0
                        and most < 1.0
                        and (1.0 - most) * least < share * changes
                        and dips(-math.log(a), -math.log(b), -math.log(c), short, length)
                    )
                if lost:
                    flags[i - 2] |= DAMPED
                    flags[i - 1] |= DAMPED
        short = length


def dips(left, middle, right, h1, h2):
    """Whether the parabola through three neighbouring positive values dips below zero between them."""
    if not (left > 0.0 and middle > 0.0 and right > 0.0 and h1 > 0.0 and h2 > 0.0):
        return False
    if not (left < np.inf and middle < np.inf and right < np.inf):
        return False
    before, after = (middle - left) / h1, (right - middle) / h2
    bend = (after - before) / (h1 + h2)
    if not bend > 0.0:
        return False
    slope = (before * h2 + after * h1) / (h1 + h2)
    vertex = -0.5 * slope / bend
    return -h1 < vertex < h2 and middle - 0.25 * slope * slope / bend < 0.0


def one_dips(rows, i, first_margin, h1, h2, share):
    """Whether one of the margins dips before point i, be others smaller or lost: by the parabola through the last three points.

    Below the lowest of them a parabola falls by at most ``share`` of the changes between them.
    """
    suspects = 0
    for j in range(first_margin, rows.shape[1]):
        a, b, c = rows[i - 2, j], rows[i - 1, j], rows[i, j]
        suspects += min(min(a, b), c) - MARGIN < share * (abs(b - a) + abs(c - b))
    if suspects > 0:
        for j in range(first_margin, rows.shape[1]):
            if dips(rows[i - 2, j] - MARGIN, rows[i - 1, j] - MARGIN, rows[i, j] - MARGIN, h1, h2):
                return True
    return False


def turns_twice(here, there, mean):
    """Whether the cubic with these positive slopes at its ends, and this mean slope, falls in between: two folds."""
    bend = 3.0 * (here + there - 2.0 * mean)
    middle = 2.0 * here + there - 3.0 * mean
    return bend > 0.0 and 0.0 < middle < bend and here * bend < middle * middle


@cache
def _compiled() -> Callable[..., Any]:
    from contvines_ground.parts import part, whole

    from ..continuation.binding import OPTIONS, copy_with

    inner = {f.__name__: part(forceinline=True, **OPTIONS)(f) for f in (dips, turns_twice)}
    # numba looks at this file only, not at where the constants come from
    sources = [Path(str(module.__file__)) for module in (aims, bits, multipliers, loop)]
    sources.append(Path(__file__))
    digest = hashlib.blake2b(b"".join(path.read_bytes() for path in sources), digest_size=4).hexdigest()
    # sums in any order, so that they are vector instructions; NaN and infinity keep their meaning
    fast = {"fastmath": {"reassoc", "contract", "nsz"}, **OPTIONS}
    inner["one_dips"] = part(**fast)(copy_with(one_dips, f"_{digest}", dips=inner["dips"]))
    return whole(cache=True, **fast)(copy_with(mark_segments, f"_{digest}", **inner))


def prepare() -> None:
    """Compile, or take from the cache on disk, what scans compiled problems."""
    table, line, parts = np.zeros((1, 2)), np.zeros(1), np.zeros((0, 1))
    chunk = Scanned(table, line, line, table, line)
    symmetries = Symmetries(np.zeros((0, 1), np.int64), parts, parts, line, np.zeros((2, 0, 1)))
    metric = Metric(line, line, 1.0, 1.0)
    _compiled()(chunk, 2, MAP, True, 0.0, metric, symmetries, np.zeros(0, np.int64), np.zeros(1))


class Scan(NamedTuple):
    """``flags`` of the n - 1 segments, ``smallest`` margins of the n points."""

    flags: np.ndarray
    smallest: np.ndarray


class Scanner:
    """Scans chunks of one problem's branches.

    Parameters
    ----------
    engine : Engine
    symmetries : list of SymmetryTest
        Those that are signed permutations are looked at here; see ``left_out``.
    """

    def __init__(self, engine: Engine, symmetries: list[SymmetryTest]) -> None:
        self.engine = engine
        self.kind = KINDS[engine.detection]
        self.mark = _compiled() if engine.compiled else with_arrays
        columns = engine.n
        self.plain = plain = engine.plain
        affine = [test.affine for test in symmetries if test.affine is not None and plain]
        self.left_out = [test for test in symmetries if test.affine is None or not plain]
        shape = (len(affine), columns)
        self.symmetries = Symmetries(
            np.array([order for order, _, _ in affine], np.int64).reshape(shape),
            np.array([signs for _, signs, _ in affine], float).reshape(shape),
            np.array([constant for _, _, constant in affine], float).reshape(shape),
            np.zeros(columns) if engine.shift is None else engine.shift,
            np.zeros((2, *shape)),
        )

    def __call__(
        self,
        points: np.ndarray,
        values: np.ndarray,
        tangents: np.ndarray,
        rows: np.ndarray,
        signs: np.ndarray,
        real: bool,
    ) -> Scan:
        """Scan at least one point; arrays as those of a chunk."""
        engine, n = self.engine, len(values)
        flags, smallest = np.zeros(max(n - 1, 0), np.int64), np.empty(n)
        self.mark(
            Scanned(
                points if self.plain else points / engine.scale[:-1],
                values,
                np.ascontiguousarray(tangents[:, -1]),
                rows,
                signs,
            ),
            2 * engine.m,
            self.kind,
            bool(real),
            FLAT * engine.parameter_unit(float(values[0])),
            engine.metric,
            self.symmetries,
            flags,
            smallest,
        )
        return Scan(flags, smallest)
