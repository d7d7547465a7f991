"""Plane: linearisation of a problem at points (u, p, q) of the plane of two parameters, and changes of margins along branches.

A border is degenerate if a branch touches it without crossing it. Along the branch, at a fixed second parameter q, the margin h then has a double
zero: two borders of the one-parameter diagram meet and vanish, and for q on the other side the motion does not reach the border. The locus
of the border has a turning point in q. With h = a (p - p0)^2 + b (q - q0) + ... along the branches, the borders lie at
p - p0 = +-sqrt(-b (q - q0) / a).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ..branches import Branch
from ..continuation.engine import Engine
from ..continuation.settings import Settings
from ..shared.numbers import TINY
from .linear import Linearisation, Null
from .problem import LocusProblem
from .settings import SCALING, VANISHING

STEP = Settings.offset  # step of a margin's derivative along the branch, relative to unknowns and parameter
NARROWER, WIDTHS = 0.35, 9  # ratio and number of the step sizes that `touching_form` tries
# weights of a second difference of sixth order
BEND = np.array([2.0, -27.0, 270.0, -490.0, 270.0, -27.0, 2.0]) / 180.0


class Place(NamedTuple):
    """A point (u, p, q): unknowns, first and second parameter."""

    u: np.ndarray
    p: float
    q: float


class Plane(Linearisation):
    """Linearisation of a locus's underlying problem, with multipliers and margins, at points (u, p, q).

    Parameters
    ----------
    locus : LocusProblem
    """

    def __init__(self, locus: LocusProblem) -> None:
        # new problems, since a trace changes the parameters of the locus's problems in place
        super().__init__(locus.base.against(locus.inner))
        self.locus, self.second = locus, self.problem.against(locus.over)
        self.place = Place(np.zeros(locus.size), 0.0, 0.0)

    def to(self, place: Place) -> bool:
        """Linearise at a place, unless it is the current one; return whether the equations can be evaluated there."""
        if place is not self.place:
            assert self.kernels.assign is not None
            self.kernels.assign(self.data, self.second.data, float(place.q))
            self.place = place
            self.at(place.u, place.p)
        return math.isfinite(self.largest)

    def other_pair(self, reference: float, second: float) -> float:
        """Return the test of the complex pair nearest to the reference `second`, without the pair nearest to `reference`; see ``pair_of``."""
        upper = self.spectrum[self.spectrum.imag > 0.0]
        if len(upper) < 2:
            return np.nan
        tests = 2.0 * upper.real if self.flow else np.abs(upper) ** 2 - 1.0
        places = np.abs(upper) ** 2 if self.flow else upper.real
        unit = 1.0 + abs(reference) if self.flow else 1.0
        nearest = int(np.argmin(np.abs(tests) + 0.1 * np.abs(places - reference) / unit))
        others = [i for i in range(len(upper)) if i != nearest]
        return float(tests[min(others, key=lambda i: abs(places[i] - second))])

    # ------------------------------------------------------------------ along the branches
    def branch_direction(self, null: Null) -> np.ndarray:
        """Return the tangent (du, dp) of the branch, not normalised; it is smooth at folds, too."""
        x, s = self.solve(-self.slope, null.column, null.row)
        v, g = self.null(null.column, null.row)
        return np.append(g * x - s * v, g)

    def margin_at(self, place: Place) -> float:
        """Return the locus's margin at a place, which need not be a solution; NaN if it cannot be evaluated."""
        return float(self.margins[self.locus.index]) if self.to(place) else np.nan

    def slope_along_branch(self, null: Null) -> float:
        """Return the derivative of the margin along the branch through the current place, by its arclength."""
        place, direction = self.place, self.branch_direction(null)
        sizes = self.locus.sizes_at(*place)[:-1]
        step = STEP * direction / (np.linalg.norm(direction / sizes) or np.nan)
        h = [self.margin_at(_moved(place, k * step)) for k in (-2.0, -1.0, 1.0, 2.0)]
        self.to(place)
        return _slope(h) / STEP

    def touching_form(self) -> dict[str, float]:
        """Return the coefficients a and b of the margin at a degenerate border (see the top of this module); empty if they cannot be computed."""
        u, p, q = self.place
        *_, wide, high = self.locus.sizes_at(u, p, q)

        def margin(p: float, q: float) -> float:
            """Margin of the solution at other parameter values."""
            engine = Engine(self.locus.at(q), (p - wide, p + wide), Settings())
            found = engine.at_value(u, p)
            return np.nan if found is None else float(engine.margins(found.row)[self.locus.index])

        def bend(width: float) -> float:
            h = [margin(p + k * width * wide, q) for k in range(-3, 4)]
            return float(BEND @ h) / (2.0 * (width * wide) ** 2)

        def slope(width: float) -> float:
            return _slope([margin(p, q + k * width * high) for k in (-2, -1, 1, 2)]) / (width * high)

        found = {"a": _steadiest(bend), "b": _steadiest(slope)}
        return found if np.isfinite(list(found.values())).all() else {}


def _moved(place: Place, direction: np.ndarray) -> Place:
    return Place(place.u + direction[:-1], place.p + float(direction[-1]), place.q)


def _slope(h: list[float]) -> float:
    """Derivative, times the step, from values at -2, -1, 1 and 2 steps."""
    return (8.0 * (h[2] - h[1]) - (h[3] - h[0])) / 12.0


def _steadiest(value: Callable[[float], float]) -> float:
    """Difference quotient at the step size at which it changes least from one step size to the next."""
    best, error, before = np.nan, np.inf, np.nan
    for width in SCALING.widest * NARROWER ** np.arange(WIDTHS):
        found = value(float(width))
        if abs(found - before) < error:
            best, error = found, abs(found - before)
        before = found
    return best


def impossible_side(locus: LocusProblem, branch: Branch) -> int:
    """Return the side of a border's locus, in the plane (q, p), on which its margin is negative: ``beyond`` of :class:`contvines.loci.locus.Locus`."""
    i = len(branch) // 2
    u, p = locus.split(branch.points[i])
    plane, place = Plane(locus), Place(u, float(p), float(branch.values[i]))
    start, null = plane.margin_at(place), plane.null_vectors()
    if abs(null.test) < VANISHING.singular:
        return 0
    direction = plane.branch_direction(null)
    direction = direction / direction[-1]  # derivative of the motions by p
    *sizes, own, _ = locus.sizes_at(*place)
    largest = float((np.abs(direction[:-1]) / sizes).max())
    step = SCALING.step * min(float(own), 1.0 / max(largest, TINY))
    rise = plane.margin_at(_moved(place, step * direction)) - start
    if not np.isfinite(rise) or rise == 0.0:
        return 0
    up_is_left = branch.tangents[i][-1] > 0.0  # if q grows along the locus, larger p is on the left
    return -1 if (rise > 0.0) == up_is_left else 1
