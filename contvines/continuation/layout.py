"""What the loop of a continuation reads and writes: points, one by one and in chunks, and the numbers of them that pass zero at special points.

The arrays, and the functions of aims, are the same in Python and in the native core (native/march.hpp).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..shared.numbers import number_text
from .settings import SOLUTION

if TYPE_CHECKING:
    from ..problems.abilities import Moving


class Status(IntEnum):
    """Status codes of the continuation loop; ``sentence`` says what they mean."""

    RUNNING = 0
    LEFT_INTERVAL = 1
    STEP_TOO_SMALL = 2
    NOT_EVALUABLE = 3
    BORDER = 4
    MAX_POINTS = 5
    CLOSED = 6
    ESCAPED = 7
    CREEPING = 8
    COARSE = 9

    def sentence(self, parameter: str = "p", value: float = float("nan"), unit: float = 1.0) -> str:
        """The status as a sentence about a branch at this parameter value; beside ``unit`` rounding is zero."""
        long, short = number_text(value, 10, unit), number_text(value, 6, unit)
        return {
            Status.RUNNING: "unfinished",
            Status.LEFT_INTERVAL: f"reaches the end of the interval, {parameter} = {short}",
            Status.STEP_TOO_SMALL: f"no convergence near {parameter} = {long}, even with the smallest step",
            Status.NOT_EVALUABLE: f"the equations cannot be evaluated beyond {parameter} = {long}",
            Status.BORDER: f"reaches a border at {parameter} = {long}",
            Status.MAX_POINTS: f"the largest number of points is reached at {parameter} = {short}",
            Status.ESCAPED: f"the unknowns run away near {parameter} = {short}",
            Status.CREEPING: f"creeps near {parameter} = {long}: very many points with next to no progress",
            Status.COARSE: f"the mesh is too coarse beyond {parameter} = {long}",
            Status.CLOSED: "closed: the branch returns to its start",
        }[self]


# margins below this are negative; above it they are zero to rounding, at a border or all along a branch
MARGIN = -SOLUTION.rounding

# what it finds when it looks for something
NOWHERE, PASSED, AT_END = 0, 1, 2

# where numbers of a bracket stand in the memory of a loop: its last end first, x, f and the parameter of either; the tolerance and jump of a search
ENDS, PRECISION, JUMP, SIZE = slice(6), 9, 10, 26


class Control(NamedTuple):
    """Settings of the march."""

    angle: float
    min_step: float
    max_step: float
    tolerance: float
    lower: float
    upper: float
    stop_at_border: float
    sweeps: int
    row_margins: int
    noise: float


class Way(NamedTuple):
    """Where single points are looked for.

    ``chord``, shape (4, N + 1), is one of cubic Hermite interpolation: the first end, its tangent times the arc's length, the second end, its
    tangent likewise. At a place s border.(u, p) is to be ``start`` + s ``length``; with length 0 the first end is a guess, and no more. Tangents are
    returned with <along, tangent> >= 0. Newton's method takes at most ``sweeps`` (none at the chord's ends: they are good as they are).
    """

    chord: np.ndarray
    start: float
    length: float
    border: np.ndarray
    along: np.ndarray
    sweeps: int = 40


class Metric(NamedTuple):
    """How lengths are measured: <a, b> = sum of weights_j a_j b_j over unknowns and parameter.

    ``weights`` and ``scale`` (typical sizes) have shape (N + 1,); ``of_unknowns`` and ``of_parameter`` are the weights of
    unknowns whose scale is 1, and of the parameter. ``moving`` is the problem, if its unknowns belong to a mesh that moves along.
    """

    weights: np.ndarray
    scale: np.ndarray
    of_unknowns: float
    of_parameter: float
    moving: Moving | None = None


class Scratch(NamedTuple):
    """Work space of the loop: unknowns (N,), then a row of the bordered system, its solutions and a guess (N + 1,)."""

    u: np.ndarray
    border: np.ndarray
    step: np.ndarray
    tangent: np.ndarray
    guess: np.ndarray


class Found(NamedTuple):
    """What is found of k points: shapes (k, N), (k, N + 1), (k, row), (k, 5).

    ``numbers`` are p; the number of sweeps (-1: no convergence; -2: not evaluable; -3: the tangent is not finite; -4: the point
    belongs to another branch); the residual; the sign of the bordered determinant for the tangent; the size of the last correction.
    """

    u: np.ndarray
    tangents: np.ndarray
    rows: np.ndarray
    numbers: np.ndarray


class Solved(NamedTuple):
    """A point of a branch with everything known about it.

    ``row`` is what the kernel ``inspect`` wrote: multipliers as re, im pairs, then margins. ``tangent`` is a unit vector
    in the metric, ``sign`` the sign of det [[F_u, F_p], [tangent]], ``correction`` the last Newton correction.
    """

    u: np.ndarray
    p: float
    tangent: np.ndarray
    row: np.ndarray
    sign: float
    residual: float
    correction: float


class Hit(NamedTuple):
    """Where a number passes zero along a chord: the place, the point (None if it is not found again), the error of its parameter value, how much the number changes there."""

    place: float
    point: Solved | None
    error: float
    jump: float


def solved_points(found: Found) -> list[Solved | None]:
    """Points one by one, None where there is no solution."""
    return [solved_point(found, i) for i in range(len(found.u))]


def solved_point(found: Found, i: int) -> Solved | None:
    """One of the points, None where there is no solution."""
    p, sweeps, residual, sign, size = found.numbers[i].tolist()
    if not sweeps >= 0:
        return None
    return Solved(found.u[i], p, found.tangents[i], found.rows[i], sign, residual, size)


OF_SOLVED = {
    "points": "u", "values": "p", "tangents": "tangent", "rows": "row", "signs": "sign", "corrections": "correction",
}  # fmt: skip
"""The arrays of a chunk, and what they have of solved points."""


@dataclass
class Chunk:
    """Consecutive points of a branch; the first one is the last point of the chunk before.

    The loop writes the rows of the next chunk to the same place: copy what is needed later. ``before`` is the point before the
    first one, where there is one. Shapes of the arrays of M points: (M, N), (M,), (M, N + 1), (M, row), (M,), (M,).
    """

    points: np.ndarray
    values: np.ndarray
    tangents: np.ndarray
    rows: np.ndarray
    signs: np.ndarray
    corrections: np.ndarray
    status: Status
    before: Solved | None = None

    def __len__(self) -> int:
        return len(self.values)

    @property
    def arrays(self) -> tuple[np.ndarray, ...]:
        """All that is known of the points."""
        return self.points, self.values, self.tangents, self.rows, self.signs, self.corrections

    def cut(self, n: int) -> Chunk:
        """The first n points."""
        return Chunk(*(array[:n] for array in self.arrays), status=self.status, before=self.before)

    def joined(self, other: Chunk) -> Chunk:
        """These points and those of another chunk, with its status."""
        return Chunk(*map(np.concatenate, zip(self.arrays, other.arrays, strict=True)), status=other.status)

    def widened(self) -> Chunk:
        """The chunk with the point before its first one, where there is one."""
        return self if self.before is None else packed([self.before], self.status).joined(self)

    def solved(self, i: int, sign: float | None = None) -> Solved:
        """Point i; with another sign where that is known better."""
        return Solved(
            self.points[i],
            float(self.values[i]),
            self.tangents[i],
            self.rows[i].copy(),
            float(self.signs[i]) if sign is None else sign,
            0.0,
            float(self.corrections[i]),
        )


def packed(points: Sequence[Solved], status: Status) -> Chunk:
    """Some points as a chunk."""
    return Chunk(
        *(np.array([getattr(point, name) for point in points]) for name in OF_SOLVED.values()), status=status
    )


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
