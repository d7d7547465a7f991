"""Data of the continuation loop: points, single and in chunks, and the test functions ("aims") that are zero at special points.

The arrays, and the functions of aims, are the same in Python and in the native core (native/march.hpp).

The "row" of a point has its multipliers as (re, im) pairs, then its margins.
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
    """Status codes of the continuation loop; ``sentence`` explains them."""

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
        """Return the status as a sentence on a branch that stopped at this parameter value; ``unit`` is the typical size of the parameter."""
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


# a margin below this is negative; between this and zero it is zero to rounding, at a border or all along a branch
MARGIN = -SOLUTION.rounding

# outcomes of a search for the zero of an aim: none; bracketed; an end is taken as the zero
NOWHERE, PASSED, AT_END = 0, 1, 2

# positions in the array of a search's bracket, of length SIZE: x, f and parameter of both ends, the last point first; tolerance; jump
ENDS, PRECISION, JUMP, SIZE = slice(6), 9, 10, 26


class Control(NamedTuple):
    """Settings of the march.

    Attributes
    ----------
    angle, min_step, max_step, tolerance : float
        See :class:`contvines.continuation.settings.Settings`.
    lower, upper : float
        Parameter interval.
    stop_at_border : float
        Not 0 to stop at the first point with a negative margin.
    sweeps : int
        Largest number of Newton corrections per point.
    row_margins : int
        Position of the first margin in a row.
    noise : float
        Noise of the equations.
    """

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
    """A chord along which single points are solved for, or a single guess.

    Attributes
    ----------
    chord : ndarray, shape (4, N + 1)
        Data of cubic Hermite interpolation: first end, its tangent times the arc's length, second end, its tangent times the arc's length.
    start, length : float
        The point at position s has border.(u, p) = start + s length. With length 0 the first end is a guess, and the rest of the chord is not used.
    border : ndarray, shape (N + 1,)
        Row that makes the system square.
    along : ndarray, shape (N + 1,)
        Tangents are returned with <along, tangent> >= 0.
    sweeps : int
        Largest number of Newton corrections; the ends of a chord are not corrected.
    """

    chord: np.ndarray
    start: float
    length: float
    border: np.ndarray
    along: np.ndarray
    sweeps: int = 40


class Metric(NamedTuple):
    """Metric of lengths and angles: <a, b> = sum of weights_j a_j b_j over unknowns and parameter.

    Attributes
    ----------
    weights, scale : ndarray, shape (N + 1,)
        Weights, and typical sizes.
    of_unknowns, of_parameter : float
        Weight of an unknown with scale 1, and of the parameter.
    moving : Moving or None
        The problem, if its unknowns belong to a mesh that moves with the solution.
    """

    weights: np.ndarray
    scale: np.ndarray
    of_unknowns: float
    of_parameter: float
    moving: Moving | None = None


class Scratch(NamedTuple):
    """Work arrays of the loop: unknowns, shape (N,); then the border of the bordered system, its two solutions, and a guess, shape (N + 1,)."""

    u: np.ndarray
    border: np.ndarray
    step: np.ndarray
    tangent: np.ndarray
    guess: np.ndarray


class Found(NamedTuple):
    """Results for k points: arrays of shapes (k, N), (k, N + 1), (k, row), (k, 5).

    The columns of ``numbers`` are p; the number of sweeps (-1: no convergence; -2: not evaluable; -3: the tangent is not finite; -4: the point
    belongs to another branch); the residual; the sign of the bordered determinant for the tangent; the size of the last correction.
    """

    u: np.ndarray
    tangents: np.ndarray
    rows: np.ndarray
    numbers: np.ndarray


class Solved(NamedTuple):
    """A solved point of a branch.

    Attributes
    ----------
    u : ndarray, shape (N,)
        Unknowns.
    p : float
        Parameter value.
    tangent : ndarray, shape (N + 1,)
        Unit vector in the metric.
    row : ndarray
        Result of the kernel ``inspect``: multipliers as (re, im) pairs, then margins.
    sign : float
        Sign of det [[F_u, F_p], [tangent]]; 0 if unknown.
    residual : float
        Largest absolute residual.
    correction : float
        Size of the last Newton correction, relative to scale + abs(unknown).
    """

    u: np.ndarray
    p: float
    tangent: np.ndarray
    row: np.ndarray
    sign: float
    residual: float
    correction: float


class Hit(NamedTuple):
    """A zero of an aim along a chord.

    Attributes
    ----------
    place : float
        Position on the chord.
    point : Solved or None
        The point; None if it could not be solved again.
    error : float
        Error of its parameter value.
    jump : float
        Change of the test function over the final bracket.
    """

    place: float
    point: Solved | None
    error: float
    jump: float


def solved_points(found: Found) -> list[Solved | None]:
    """Return the points as a list, None for each without a solution."""
    return [solved_point(found, i) for i in range(len(found.u))]


def solved_point(found: Found, i: int) -> Solved | None:
    """Return point i, None without a solution."""
    p, sweeps, residual, sign, size = found.numbers[i].tolist()
    if not sweeps >= 0:
        return None
    return Solved(found.u[i], p, found.tangents[i], found.rows[i], sign, residual, size)


OF_SOLVED = {
    "points": "u", "values": "p", "tangents": "tangent", "rows": "row", "signs": "sign", "corrections": "correction",
}  # fmt: skip
"""Arrays of a chunk -> the fields of solved points that they contain."""


@dataclass
class Chunk:
    """Consecutive points of a branch; the first one is the last point of the previous chunk.

    The loop writes the rows of the next chunk to the same memory: copy those that are needed later.

    Attributes
    ----------
    points, values, tangents, rows, signs, corrections : ndarray
        Of shapes (M, N), (M,), (M, N + 1), (M, row), (M,), (M,) for M points; see `Solved`.
    status : Status
        RUNNING, or the reason why the branch ends with the last point.
    before : Solved or None
        The point before the first one, if there is one.
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
        """The arrays in the order of the attributes."""
        return self.points, self.values, self.tangents, self.rows, self.signs, self.corrections

    def cut(self, n: int) -> Chunk:
        """Return the chunk of the first n points."""
        return Chunk(*(array[:n] for array in self.arrays), status=self.status, before=self.before)

    def joined(self, other: Chunk) -> Chunk:
        """Return the chunk of these points followed by those of another chunk, with its status."""
        return Chunk(*map(np.concatenate, zip(self.arrays, other.arrays, strict=True)), status=other.status)

    def widened(self) -> Chunk:
        """Return the chunk with the point before its first one, if there is one."""
        return self if self.before is None else packed([self.before], self.status).joined(self)

    def solved(self, i: int, sign: float | None = None) -> Solved:
        """Return point i, with another sign of the determinant if given."""
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
    """Return some points as a chunk."""
    return Chunk(
        *(np.array([getattr(point, name) for point in points]) for name in OF_SOLVED.values()), status=status
    )


# kinds of spectra used for detection: none; multipliers; eigenvalues; eigenvalues that show branch points only
NONE, MAP, FLOW, REAL = 0, 1, 2, 3
KINDS = {"none": NONE, "map": MAP, "flow": FLOW, "real": REAL}

# test functions of aims
NOTHING, MARGINS, SLOPE, SIGN, MULTIPLIER = 0, 1, 2, 3, 4

# sorts of multipliers: real positive, real negative, complex pairs
PLUS, MINUS, PAIR = 1, -1, 0
SORTS = {"plus": PLUS, "minus": MINUS, "pair": PAIR}

NO_COLUMNS = np.zeros(0, np.int64)
LIMIT = 1.0  # bound at which test functions of multipliers are clipped


@dataclass(frozen=True, eq=False)
class Aim:
    """A test function whose zero is sought, in the form that the native core evaluates.

    Attributes
    ----------
    test : int
        MARGINS: the smallest of some margins; SLOPE: the parameter's component of the tangent; SIGN: the sign of the determinant; MULTIPLIER: a multiplier.
    columns : ndarray of int
        For MARGINS: their columns in a row.
    count, kind, sort, rank : int
        For MULTIPLIER: number of multipliers in a row, kind of spectrum, sort, and rank among those of the sort, 1 for the largest.
    anyway : int
        Not 0: if the ends of a segment do not have opposite signs, the end with the smaller value is taken as the zero.
    """

    test: int
    columns: np.ndarray
    count: int = 0
    kind: int = NONE
    sort: int = PLUS
    rank: int = 1
    anyway: int = 0

    def __call__(self, point: Solved) -> float:
        """Return the value at a solved point."""
        return float(probe(self, point.row.tolist(), float(point.tangent[-1]), float(point.sign)))


def aim_at_multiplier(count: int, spectrum: str, sort: str, rank: int) -> Aim:
    """Return the aim at a multiplier by its rank among those of a sort, "plus", "minus" or "pair"; ``spectrum`` is a key of `KINDS`."""
    return Aim(MULTIPLIER, NO_COLUMNS, count, KINDS[spectrum], SORTS[sort], rank)


def probe(aim, row, slope, sign):
    """Return the value of an aim's test function at a point with this row, parameter's component of the tangent, and sign of the determinant."""
    if aim.test == MARGINS:
        value = 1.0
        for j in aim.columns:
            if row[j] < value:  # NaN counts as not applicable
                value = row[j]
        return value
    if aim.test == SLOPE:
        return slope
    if aim.test == SIGN:
        return sign
    return multiplier(row, aim.count, aim.kind, aim.sort, aim.rank)


def multiplier(row, count, kind, sort, rank):
    """Return the test function of one multiplier of a sort, by rank, the largest first: its logarithm (of flows its real part), positive outside."""
    members = 0
    for j in range(count):
        members += _belongs(row[2 * j + 1], kind, sort)
    if members < rank:
        if sort == PAIR or members == count:
            return -LIMIT
        # too few multipliers of this sort: a complex pair may meet on the real axis. Minus the distance of the nearest complex one from the critical
        # value is continuous if they meet exactly there, as in conservative systems
        place = 0.0 if kind != MAP else (-1.0 if sort == MINUS else 1.0)
        nearest = LIMIT
        for j in range(count):
            if row[2 * j + 1] != 0.0:
                nearest = min(nearest, math.hypot(row[2 * j] - place, row[2 * j + 1]))
        return -nearest
    value, taken = math.inf, -1
    for _ in range(rank):  # the largest, then the largest of the others ...
        largest, index = -math.inf, -1
        for j in range(count):
            if not _belongs(row[2 * j + 1], kind, sort):
                continue
            size = _size(row[2 * j], row[2 * j + 1], kind, sort)
            follows = size < value or (size == value and j > taken)
            if follows and (index < 0 or size > largest):
                largest, index = size, j
        value, taken = largest, index
    if kind == MAP:
        value = (math.log(value) if value < math.inf else LIMIT) if value > 0.0 else -LIMIT
    return min(max(value, -LIMIT), LIMIT)


def _belongs(im, kind, sort):
    """Whether a multiplier with this imaginary part is of a sort."""
    if sort == PAIR:
        return im > 0.0
    return kind == REAL or im == 0.0


def _size(re, im, kind, sort):
    """Return the number by which the multipliers of a sort are ranked."""
    if sort == PAIR:
        return math.hypot(re, im) if kind == MAP else re
    return -re if sort == MINUS and kind != REAL else re
