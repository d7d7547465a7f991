"""Solved: a point of a branch with everything known about it, as the corrector found it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .layout import Found


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
