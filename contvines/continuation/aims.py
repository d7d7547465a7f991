"""Aims: numbers of a solved point that pass zero at a special point.

native/march.hpp has the same functions for compiled problems.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from .layout import Solved

# kinds of spectra that tell
NONE, MAP, FLOW, REAL = 0, 1, 2, 3
KINDS = {"none": NONE, "map": MAP, "flow": FLOW, "real": REAL}

# what passes zero
NOTHING, MARGINS, SLOPE, SIGN, MULTIPLIER = 0, 1, 2, 3, 4

# sorts of multipliers
PLUS, MINUS, PAIR = 1, -1, 0
SORTS = {"plus": PLUS, "minus": MINUS, "pair": PAIR}

NO_COLUMNS = np.zeros(0, np.int64)
LIMIT = 1.0  # test functions of multipliers are clipped here; only the neighbourhood of zero matters


@dataclass(frozen=True, eq=False)
class Aim:
    """What passes zero: the smallest of some margins, the parameter's part of the tangent, the sign of the determinant, or a multiplier.

    ``columns`` are those of the margins in a row; ``count`` multipliers stand in front as (re, im) pairs, of a ``kind`` of spectrum, and
    the ``rank``-th of a ``sort`` is meant. With ``anyway``, where the ends of a segment do not have opposite signs, the end with the smaller value is taken.
    """

    what: int
    columns: np.ndarray
    count: int = 0
    kind: int = NONE
    sort: int = PLUS
    rank: int = 1
    anyway: int = 0

    def __call__(self, point: Solved) -> float:
        """The number at a solved point."""
        return float(probe(self, point.row.tolist(), float(point.tangent[-1]), float(point.sign)))


def aim_at_multiplier(count: int, spectrum: str, sort: str, rank: int) -> Aim:
    """A multiplier by its rank among those of a sort, "plus", "minus" or "pair"; ``spectrum`` is what a problem calls its own."""
    return Aim(MULTIPLIER, NO_COLUMNS, count, KINDS[spectrum], SORTS[sort], rank)


def probe(aim, row, slope, sign):
    """The number that an aim is about at a point: its row, the parameter's part of its tangent, its sign."""
    if aim.what == MARGINS:
        value = 1.0
        for j in aim.columns:
            if row[j] < value:  # NaN counts as not applicable
                value = row[j]
        return value
    if aim.what == SLOPE:
        return slope
    if aim.what == SIGN:
        return sign
    return multiplier(row, aim.count, aim.kind, aim.sort, aim.rank)


def multiplier(row, count, kind, sort, rank):
    """The test function of one multiplier of a sort at one point, the largest of them ranked first: positive past the circle (or the axis)."""
    members = 0
    for j in range(count):
        members += _belongs(row[2 * j + 1], kind, sort)
    if members < rank:
        if sort == PAIR or members == count:
            return -LIMIT
        # a complex pair may meet on the real axis: continuous only where that happens at the critical place itself,
        # as it does in conservative systems
        place = 0.0 if kind != MAP else (-1.0 if sort == MINUS else 1.0)
        nearest = LIMIT
        for j in range(count):
            if row[2 * j + 1] != 0.0:
                nearest = min(nearest, math.hypot(row[2 * j] - place, row[2 * j + 1]))
        return -nearest
    value, taken = math.inf, -1
    for _ in range(rank):  # the largest, then the largest of the others ...
        largest, which = -math.inf, -1
        for j in range(count):
            if not _belongs(row[2 * j + 1], kind, sort):
                continue
            own = _size(row[2 * j], row[2 * j + 1], kind, sort)
            follows = own < value or (own == value and j > taken)
            if follows and (which < 0 or own > largest):
                largest, which = own, j
        value, taken = largest, which
    if kind == MAP:
        value = (math.log(value) if value < math.inf else LIMIT) if value > 0.0 else -LIMIT
    return min(max(value, -LIMIT), LIMIT)


def _belongs(im, kind, sort):
    """Whether a multiplier with this imaginary part is of a sort."""
    if sort == PAIR:
        return im > 0.0
    return kind == REAL or im == 0.0


def _size(re, im, kind, sort):
    """What the multipliers of a sort are ranked by."""
    if sort == PAIR:
        return math.hypot(re, im) if kind == MAP else re
    return -re if sort == MINUS and kind != REAL else re
