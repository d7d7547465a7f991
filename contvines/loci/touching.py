"""Degenerate borders: a branch that touches a border and does not cross it.

Along a branch at a fixed second parameter the margin h then has a double zero: two borders of the diagram in one parameter meet there and are
gone on the other side, where the motion keeps off the border. The locus of the border turns round in the second parameter. With
h = a (p - p0)^2 + b (q - q0) + ... along the branches the borders are at p - p0 = +-sqrt(-b (q - q0) / a).
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from ..bifurcation.settings import LOCATING
from ..continuation.settings import Settings
from ..shared.floating_point import ROUNDED
from .linear import Null
from .plane import Place, Plane
from .settings import SCALING

STEP = (
    Settings.offset
)  # of the first derivative, along the branch, relative to the sizes of unknowns and parameter
NARROWER, WIDTHS = 0.35, 9  # widths of the differences, relative to the sizes of the parameters
BEND = np.array([2.0, -27.0, 270.0, -490.0, 270.0, -27.0, 2.0]) / 180.0  # weights of a second derivative
SWEEPS = 12  # of Newton's method on the branch


def slope_along_branch(plane: Plane, null: Null, index: int) -> float:
    """Derivative of a margin along the branch through a place, over its arc; a margin off the branch is what its formula says."""
    place, locus = plane.place, plane.locus
    direction = branch_direction(plane, null)
    sizes = locus.sizes_at(place.u, place.p, place.q)[:-1]
    direction = direction / (np.linalg.norm(direction / sizes) or np.nan)
    values = []
    for k in (-2.0, -1.0, 1.0, 2.0):
        moved = Place(place.u + k * STEP * direction[:-1], place.p + k * STEP * float(direction[-1]), place.q)
        values.append(_margin(plane, moved, index))
    plane.at(place)
    return float(8.0 * (values[2] - values[1]) - (values[3] - values[0])) / (12.0 * STEP)


def branch_direction(plane: Plane, null: Null) -> np.ndarray:
    """The tangent (du, dp) of the branch, not of unit length; smooth where the branch folds."""
    line = plane.first
    x, s = line.solve(-line.slope, null.column, null.row)
    v, g = line.null(null.column, null.row)
    return np.append(g * x - s * v, g)


def touching_form(plane: Plane, place: Place, index: int) -> dict[str, float]:
    """a and b of the margin along the branches round a place; none where it cannot be evaluated there."""
    sizes = plane.locus.sizes_at(place.u, place.p, place.q)

    def bend(width: float) -> float:
        d = width * float(sizes[-2])
        h = [_on_branch(plane, Place(place.u, place.p + k * d, place.q), index) for k in range(-3, 4)]
        return float(BEND @ h) / (2.0 * d * d)

    def slope(width: float) -> float:
        d = width * float(sizes[-1])
        h = [_on_branch(plane, Place(place.u, place.p, place.q + k * d), index) for k in (-2, -1, 1, 2)]
        return float(8.0 * (h[2] - h[1]) - (h[3] - h[0])) / (12.0 * d)

    found = {"a": _best(bend), "b": _best(slope)}
    plane.at(place)
    return found if np.isfinite(list(found.values())).all() else {}


def _best(value: Callable[[float], float]) -> float:
    """A difference quotient at the width at which it changes least from one width to the next."""
    best, error, before = np.nan, np.inf, np.nan
    for width in SCALING.widest * NARROWER ** np.arange(WIDTHS):
        now = value(float(width))
        if abs(now - before) < error:
            best, error = now, abs(now - before)
        before = now
    return best


def _margin(plane: Plane, place: Place, index: int) -> float:
    return float(plane.row[2 * plane.m + index]) if math.isfinite(plane.at(place)) else np.nan


def _on_branch(plane: Plane, guess: Place, index: int) -> float:
    """The margin of the solution at a pair of parameter values, near a guess; NaN if Newton's method does not find it."""
    place, line, last = guess, plane.first, np.inf
    for _ in range(SWEEPS):
        if not math.isfinite(plane.at(place)):
            return np.nan
        null = line.null_vectors()
        x, s = line.solve(-line.residual, null.column, null.row)
        v, g = line.null(null.column, null.row)
        step = x - (s / g) * v if g != 0.0 else np.full(len(x), np.nan)
        size = float((np.abs(step) / plane.locus.sizes_at(*place)[:-2]).max())
        place = place._replace(u=place.u + step)
        if size < ROUNDED or (size < LOCATING.rounding and size > 0.3 * last):
            return _margin(plane, place, index)
        last = size
    return np.nan
