"""What the loop of a continuation reads and writes: the same arrays in Python and in the native core (native/march.hpp)."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from .settings import SOLUTION

if TYPE_CHECKING:
    from ..problems.abilities import Moving

# status codes (`contvines.continuation.chunk`)
RUNNING, LEFT_INTERVAL, STEP_TOO_SMALL, NOT_EVALUABLE, BORDER = 0, 1, 2, 3, 4

MARGIN = (
    -SOLUTION.rounding
)  # margins below this are negative; above it they are zero to rounding, at a border or all along a branch

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
    sweeps: float
    row_margins: float
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
    sweeps: int


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


class Points(NamedTuple):
    """Arrays of a chunk of M points: shapes (M, N), (M,), (M, N + 1), (M, row), (M,), (M,)."""

    points: np.ndarray
    values: np.ndarray
    tangents: np.ndarray
    rows: np.ndarray
    signs: np.ndarray
    corrections: np.ndarray


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
