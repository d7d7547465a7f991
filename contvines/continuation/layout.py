"""What the loop of a continuation reads and writes: the same arrays in Python and in the native core (native/march.hpp)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .settings import SOLUTION

# entries of the control vector
(
    ANGLE,
    MIN_STEP,
    MAX_STEP,
    TOLERANCE,
    LOWER,
    UPPER,
    STOP_AT_BORDER,
    SWEEPS,
    ROW_MARGINS,
    NOISE,
) = range(10)
CONTROL_SIZE = 10

# status codes (`contvines.continuation.chunk`)
RUNNING, LEFT_INTERVAL, STEP_TOO_SMALL, NOT_EVALUABLE, BORDER = 0, 1, 2, 3, 4

MARGIN = (
    -SOLUTION.rounding
)  # margins below this are negative; above it they are zero to rounding, at a border or all along a branch

# what `points` does
LINEARISE, ELIMINATE, EVERYTHING = 0, 1, 2

# what it finds when it looks for something
NOWHERE, PASSED, AT_END = 0, 1, 2

# where the numbers of a bracket stand (`contvines.continuation.bracketing`): the bracket (its last end first), a third point, and what belongs to each; the first width; tolerance and jump as
# `begin` is given them; evaluations so far; whether the last one was not finite; what the secants need
(
    X1,
    F1,
    P1,
    X2,
    F2,
    P2,
    X3,
    F3,
    WIDTH,
    PRECISION,
    JUMP,
    COUNT,
    AGAIN,
    WAIT,
    AIMED,
    BEYOND,
) = range(16)
SIDES = 16  # then for either side of zero: how many points have been there, the last but one, the last one (x and f)
ON_A_SIDE = 5
SIZE = SIDES + 2 * ON_A_SIDE


class Metric(NamedTuple):
    """How lengths are measured: <a, b> = sum of weights_j a_j b_j over unknowns and parameter.

    ``weights`` and ``scale`` (typical sizes) have shape (N + 1,); ``of_unknowns`` and ``of_parameter`` are the weights of
    unknowns whose scale is 1, and of the parameter.
    """

    weights: np.ndarray
    scale: np.ndarray
    of_unknowns: float
    of_parameter: float


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
