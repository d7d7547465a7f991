"""From a special point to the problem of its locus and a first point on it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..bifurcation.kind import Kind
from ..branches.special_point import SpecialPoint
from ..continuation.engine import Engine, Solved
from ..continuation.settings import Settings
from ..problems.abilities import Adaptive
from ..problems.protocol import Problem
from .adaptive import AdaptiveLocus
from .borders import borders_at
from .kinds import condition
from .layout import APART, FLIP, MARGIN, OWN, PAIR, PERIOD
from .linear import Linearisation
from .on_mesh import on_mesh
from .probing import pair_of, position_of
from .problem import LocusProblem, has_natural_units
from .settings import VANISHING

PLAIN = 16.0  # parameters up to this size, and down to its inverse, are counted as they are


def begin(
    problem: Problem,
    kind: str,
    u: np.ndarray,
    p: float,
    over: str,
    index: int = 0,
    bounds: tuple[float, float] = (-np.inf, np.inf),
    own_kind: Kind | None = None,
) -> LocusProblem:
    """The problem of the locus through a special point, with borders and the pair that belong to that point.

    Parameters
    ----------
    problem : Problem
    kind : str
        Of the special point.
    u, p
        The special point.
    over : str
        The second parameter.
    index : int
        Which margin, at a border.
    bounds : (float, float)
        Of the first parameter.
    own_kind : Kind, optional
        Of a user's, whose condition is followed.
    """
    wanted = condition(problem, kind) if own_kind is None else OWN
    if wanted == MARGIN:
        index = smooth_margin(problem, index, u, p)
    reference = 0.0
    if wanted == PERIOD:
        index = on_mesh(problem).period_place
        reference = float(u[index])
    make = AdaptiveLocus if isinstance(problem, Adaptive) else LocusProblem
    unit = unit_of(problem, bounds, p)
    locus = make(problem, kind, over, index, bounds, reference=reference, unit=unit, own_kind=own_kind)
    locus.borders = borders_at(problem, wanted, u, p)
    line = Linearisation(problem)
    line.at(u, p)
    if wanted == PERIOD:
        # not where an equilibrium is about to appear on the cycle
        near = on_mesh(problem).from_rest(u, p) < 0.1 * APART
        locus.masked = (1,) if near else (0, 1)
    if wanted == MARGIN:
        margins = line.row()[2 * int(problem.n_multipliers) :]
        locus.masked = tuple(int(j) for j in np.flatnonzero(np.abs(margins) < VANISHING.margin)) or (index,)
    if wanted == PAIR:
        found = np.zeros(2)
        row = line.row()
        nearest = position_of(line.spectrum(), problem.spectrum == "flow")
        pair_of(row, int(problem.n_multipliers), problem.spectrum == "flow", nearest, found)
        locus.reference = float(found[1])
    return locus


def smooth_margin(problem: Problem, index: int, u: np.ndarray, p: float) -> int:
    """Of the margins that vanish at a border the one that passes zero most smoothly, to follow along a locus.

    Some jump there, as the time to a slip where a stick vanishes; others only touch zero, as the distance kept from a wall where an impact on it
    has lost its speed.
    """
    wide, m = 1.0 + abs(p), 2 * int(problem.n_multipliers)
    engine = Engine(problem, (p - wide, p + wide), Settings())
    here = engine.start(u, p)
    around = (
        [] if here is None else [engine.beside(here, step) for step in (VANISHING.beside, -VANISHING.beside)]
    )
    if here is None or any(point is None for point in around):
        return index
    with np.errstate(invalid="ignore"):
        rises = np.array([point.row[m:] - here.row[m:] for point in around if point is not None])
        bent = np.abs(rises.sum(axis=0)) / np.abs(rises).sum(axis=0)  # 0 of a straight line, 1 of a touch
    smooth = (np.abs(here.row[m:]) < VANISHING.margin) & (bent <= VANISHING.straight)
    return (
        index
        if bent[index] <= VANISHING.straight or not smooth.any()
        else int(np.where(smooth, bent, np.inf).argmin())
    )


def unit_of(problem: Problem, bounds: tuple[float, float], p: float) -> float:
    """The unit of the first parameter as an unknown among those of a machine: 1, or a power of two where it is of another order."""
    if not has_natural_units(problem):
        return 1.0  # all unknowns have scales of their own
    size = max(map(abs, bounds)) if np.isfinite(bounds).all() else abs(p)
    return 1.0 if size == 0.0 or 1.0 / PLAIN <= size <= PLAIN else 2.0 ** round(np.log2(size))


def regular_side(point: SpecialPoint) -> SpecialPoint:
    """A border as the motion on its other side has it, where its own equations are singular, a doubling that was met from the side of the doubled
    motion as the one that doubles has it, and a Hopf point met by cycles as the equilibrium has it; else the point itself.

    A stick that shrinks to nothing leaves two events at one place, and equations that are singular all along the border. The motion behind it has
    no such stick, and grazes there.
    """
    problem, wanted = point.attached, condition(point.attached, point.kind)
    if (
        wanted in (FLIP, PAIR)
        and (shorter := problem.root(np.array(point.u), float(point.value))) is not None
    ):
        return replace(point, problem=shorter[0], u=np.asarray(shorter[1]))
    if wanted != MARGIN or singularity(problem, point.u, point.value) >= VANISHING.singular:
        return point
    outward = -point.tangent if point.index == 0 else point.tangent
    p = float(point.value)
    for seed in problem.beyond(replace(point, tangent=outward)):
        other = seed.problem
        wide = 1.0 + abs(p)
        solved = Engine(other, (p - wide, p + wide), Settings()).at_value(np.asarray(seed.u, dtype=float), p)
        if solved is None or singularity(other, solved.u, p) < VANISHING.singular:
            continue
        line = Linearisation(other)
        line.at(solved.u, p)
        zero = np.flatnonzero(np.abs(line.row()[2 * int(other.n_multipliers) :]) < VANISHING.margin)
        if len(zero):
            j = int(zero[0])
            return replace(point, problem=other, u=solved.u, kind=other.margin_kind(j), margin_index=j)
    return point


def singularity(problem: Problem, u: np.ndarray, p: float) -> float:
    """The test that vanishes where the equations are singular, without its sign."""
    line = Linearisation(problem)
    line.at(u, p)
    return abs(line.null_vectors().test)


def first_point(
    locus: LocusProblem, u: np.ndarray, p: float, q: float, within: tuple[float, float], settings: Settings
) -> tuple[Engine, Solved | None]:
    """An engine for the locus and the solved special point; None if it does not converge or is another one."""
    engine = Engine(locus, within, settings)
    U = locus.joined(u, p)
    found = engine.start(U, float(q))
    if found is None:
        return engine, None
    there, here = engine.join(found.u, found.p), engine.join(U, q)
    gap = np.abs(there - here) / (engine.scale + np.abs(here))
    return engine, found if gap.max() < VANISHING.loose else None
