"""Scanning points of a branch: in which segments may there be something to locate?

One pass over the arrays of a chunk; what it marks is examined by :mod:`contvines.bifurcation.detect`. The native core does it for
compiled problems; :mod:`contvines.bifurcation.scan_arrays` does the same with numpy for others.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import NamedTuple

import numpy as np

from ..continuation.aims import KINDS
from ..continuation.arrays import Metric
from ..continuation.engine import Engine
from ..core.library import NOTHING, NUMBER, POINTER, WHOLE, address, function
from ..core.records import pack, place
from .multiplier_counts import PAST
from .scan_arrays import mark_segments as with_arrays
from .segment_flags import Scanned, Symmetries
from .symmetry_test import SymmetryTest


@cache
def _native() -> Callable[..., None]:
    numbers = [NUMBER] * 4
    return function(
        "core_mark_segments", NOTHING, POINTER, WHOLE, WHOLE, WHOLE, *numbers, POINTER, POINTER, POINTER
    )


def in_native(
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
    """`contvines.bifurcation.scan_arrays.mark_segments` in the native core (native/scan.hpp)."""
    scanned = pack(*chunk.points.shape, chunk.rows.shape[1], *chunk)
    images = pack(*symmetries.orders.shape, *symmetries)
    _native()(
        address(scanned), first_margin, kind, real, flat, PAST, metric.of_unknowns, metric.of_parameter,
        address(images), place(flags), place(smallest),
    )  # fmt: skip


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


def turns_twice(here, there, mean):
    """Whether the cubic with these positive slopes at its ends, and this mean slope, falls in between: two folds."""
    bend = 3.0 * (here + there - 2.0 * mean)
    middle = 2.0 * here + there - 3.0 * mean
    return bend > 0.0 and 0.0 < middle < bend and here * bend < middle * middle


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
        self.mark = in_native if engine.compiled else with_arrays
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
            engine.upright(float(values[0])),
            engine.metric,
            self.symmetries,
            flags,
            smallest,
        )
        return Scan(flags, smallest)
