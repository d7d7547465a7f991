"""From a special point to the problem of its locus and a first point on it.

Homoclinic orbits are followed as cycles of a long period, which may be another one than that at the end of a branch.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from ..bifurcation.kind import Kind
from ..bifurcation.kinds import BY_NAME
from ..branches.special_point import SpecialPoint
from ..continuation.engine import Engine, Solved
from ..continuation.settings import Settings
from ..flows.cycles import CycleProblem
from ..flows.infinite_period import InfinitePeriod, infinite_period
from ..problems.abilities import Adaptive
from ..problems.protocol import Problem
from ..problems.registry import without_problem
from .adaptive import AdaptiveLocus, on_mesh
from .kernels import APART, FLIP, MARGIN, OWN, PAIR, PERIOD, condition
from .linear import Linearisation, borders_at, singularity
from .problem import LocusProblem, check_second, has_natural_units
from .settings import VANISHING

PLAIN = 16.0  # parameters up to this size, and down to its inverse, are counted as they are
LONGER = 1.3  # factor from one period to the next, on the way to a longer one
LEFT = 0.1  # part of its time that an interval beside a saddle keeps at least, on the way to a shorter period

Cycle = tuple[CycleProblem, np.ndarray, float]


@dataclass(frozen=True, eq=False)
class Candidate:
    """A special point at (p, q) from which a locus may be traced; ``index`` is that of the margin at a border, ``seed`` the label of its origin."""

    problem: Problem
    kind: str
    u: np.ndarray
    p: float
    q: float
    seed: str
    index: int = 0
    own_kind: Kind | None = None


def check_start(point: SpecialPoint, over: str, within: tuple[float, float]) -> None:
    """Refuse a special point without a problem, and a second parameter or an interval of it that will not do.

    Raises
    ------
    ValueError
        The sentence says why.
    """
    if point.problem is None:
        raise ValueError(without_problem(point.label))
    check_second(point.problem, over)
    q = point.problem.parameters[over]
    if not within[0] <= q <= within[1]:
        raise ValueError(
            f"the diagram was made at {over} = {q:.10g}, outside of within = [{within[0]:.10g}, {within[1]:.10g}]; "
            "widen the interval"
        )
    for value in within:
        point.problem.check_value(over, value)


def candidate_of(
    point: SpecialPoint, over: str, kinds: Iterable[Kind] = (), suited: bool = True
) -> Candidate:
    """A special point of a diagram as its locus begins.

    Parameters
    ----------
    point : SpecialPoint
    over : str
        The second parameter.
    kinds : iterable of Kind
        Of the user's: that of a point from a file is among them.
    suited : bool
        Give the cycle at a homoclinic end the period that suits its locus.

    Raises
    ------
    ValueError
        If the point is of a user's kind that cannot be followed.
    """
    kind = condition_of(point, kinds) if of_own_kind(point) else None
    point = regular_side(point) if kind is None else point
    q = point.attached.parameters[over]
    about = point.attached, point.kind, np.array(point.u), float(point.value), q, point.label
    start = Candidate(*about, point.margin_index or 0, kind)
    return with_suited_period(start, point) if suited and point.kind == "homoclinic" else start


def begin(start: Candidate, over: str, bounds: tuple[float, float] = (-np.inf, np.inf)) -> LocusProblem:
    """The problem of the locus through a special point, with borders and the pair that belong to that point.

    Parameters
    ----------
    start : Candidate
    over : str
        The second parameter.
    bounds : (float, float)
        Of the first parameter.
    """
    problem, u, p, index = start.problem, start.u, start.p, start.index
    wanted = condition(problem, start.kind) if start.own_kind is None else OWN
    reference = 0.0
    if wanted == MARGIN:
        index = smooth_margin(problem, index, u, p)
    if wanted == PERIOD:
        index = on_mesh(problem).period_place
        reference = float(u[index])
    make = AdaptiveLocus if isinstance(problem, Adaptive) else LocusProblem
    unit = unit_of(problem, bounds, p)
    locus = make(
        problem, start.kind, over, index, bounds, reference=reference, unit=unit, own_kind=start.own_kind
    )
    locus.borders = borders_at(problem, wanted, u, p)
    if wanted == PERIOD:
        # not where an equilibrium is about to appear on the cycle
        near = on_mesh(problem).from_rest(u, p) < 0.1 * APART
        locus.masked = (1,) if near else (0, 1)
    if wanted == MARGIN:
        margins = Linearisation(problem).at(u, p).margins
        locus.masked = tuple(np.flatnonzero(np.abs(margins) < VANISHING.margin).tolist()) or (index,)
    if wanted == PAIR:
        line = Linearisation(problem).at(u, p)
        locus.reference = line.pair(next(iter(line.positions()), 0.0))[1]
    return locus


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


def smooth_margin(problem: Problem, index: int, u: np.ndarray, p: float) -> int:
    """Of the margins that vanish at a border the one that passes zero most smoothly, to follow along a locus.

    Some jump there, as the time to a slip where a stick vanishes; others only touch zero, as the distance kept from a wall where an impact on it
    has lost its speed.
    """
    engine = _about(problem, p)
    here = engine.start(u, p)
    if here is None:
        return index
    around = [engine.beside(here, step) for step in (VANISHING.beside, -VANISHING.beside)]
    margins = [engine.margins(point.row) for point in (here, *around) if point is not None]
    if len(margins) < 3:
        return index
    with np.errstate(invalid="ignore"):
        rises = np.array(margins[1:]) - margins[0]
        bent = np.abs(rises.sum(axis=0)) / np.abs(rises).sum(axis=0)  # 0 of a straight line, 1 of a touch
    smooth = (np.abs(margins[0]) < VANISHING.margin) & (bent <= VANISHING.straight)
    if bent[index] <= VANISHING.straight or not smooth.any():
        return index
    return int(np.where(smooth, bent, np.inf).argmin())


def _about(problem: Problem, p: float) -> Engine:
    """An engine for single solutions near a value of the parameter."""
    wide = 1.0 + abs(p)
    return Engine(problem, (p - wide, p + wide), Settings())


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
    problem, p = point.attached, float(point.value)
    wanted = condition(problem, point.kind)
    if wanted in (FLIP, PAIR) and (shorter := problem.root(np.array(point.u), p)) is not None:
        return replace(point, problem=shorter[0], u=np.asarray(shorter[1]))
    if wanted != MARGIN or singularity(problem, point.u, p) >= VANISHING.singular:
        return point
    outward = -point.tangent if point.index == 0 else point.tangent
    for seed in problem.beyond(replace(point, tangent=outward)):
        other = seed.problem
        solved = _about(other, p).at_value(np.asarray(seed.u, dtype=float), p)
        if solved is None or singularity(other, solved.u, p) < VANISHING.singular:
            continue
        zero = np.flatnonzero(np.abs(Linearisation(other).at(solved.u, p).margins) < VANISHING.margin)
        if len(zero):
            j = int(zero[0])
            return replace(point, problem=other, u=solved.u, kind=other.margin_kind(j), margin_index=j)
    return point


# ------------------------------------------------------------------ users' kinds
def of_own_kind(point: SpecialPoint) -> bool:
    """Whether a special point is of a kind of the user's own; a problem's own borders are not."""
    return point.own_kind is not None or (point.kind not in BY_NAME and point.margin_index is None)


def condition_of(point: SpecialPoint, kinds: Iterable[Kind]) -> Kind:
    """The kind of a point of a user's kind: its own, or, of a point from a file, the one of this name.

    Raises
    ------
    ValueError
        If it brings no condition.
    """
    kind = point.own_kind or next((kind for kind in kinds if kind.name == point.kind), None)
    if kind is None:
        raise ValueError(
            f"{point.label}: files do not keep functions of kinds of your own; give the kind again, in Python: "
            f"contvines.locus(graph[{point.label!r}], ..., kinds=[*contvines.KINDS, yours])"
        )
    if not callable(kind.locus):
        raise ValueError(
            f"{point.label}: its kind has no condition to follow; Kind(..., locus=lambda point: ...) gives it one, often its test"
        )
    return kind


# ------------------------------------------------------------------ cycles that stand for homoclinic orbits
def with_period(start: Candidate, period: float) -> Candidate:
    """A homoclinic end with another period; ValueErrors as of `lengthened`."""
    problem, u, p = lengthened(on_mesh(start.problem), start.u, start.p, period)
    return replace(start, problem=problem, u=u, p=p)


def lengthened(problem: CycleProblem, u: np.ndarray, p: float, period: float) -> Cycle:
    """A nearly homoclinic cycle with another period.

    Where it is longer the cycle waits at its slowest point.

    Raises
    ------
    ValueError
        If the period is not positive, or no such cycle is found.
    """
    if not period > 0.0:
        raise ValueError(f"period = {period!r} must be positive")
    wanted = float(u[problem.period_place])
    while wanted != period:  # what is found has the wanted period but for rounding
        wanted = min(max(period, wanted / LONGER), wanted * LONGER)
        found = of_period(problem, _waiting(problem, u, p, wanted), p, wanted)
        if found is None:
            raise ValueError(
                f"period = {period:.6g}: on the way there no cycle of period {wanted:.6g} is found beyond the one of {u[problem.period_place]:.6g}"
            )
        problem, u, p = found
    return problem, u, p


def of_period(problem: CycleProblem, u: np.ndarray, p: float, period: float) -> Cycle | None:
    """The cycle of a given period near a guess, on a mesh that suits it."""
    while True:
        found = _with_period(problem, u, p, period)
        if found is None:
            return None
        image = problem.adapted(found.u)
        if image is not None:
            found = _with_period(problem, image(found.u), found.p, period) or found
        if not problem.too_coarse(found.u, found.p):
            return problem, found.u, found.p
        u, p = problem.halved(found.u), found.p
        problem = problem.with_unknowns(u, p, 2 * problem.intervals, problem.copies)


def _with_period(problem: CycleProblem, u: np.ndarray, p: float, period: float) -> Solved | None:
    """The cycle of a given period near a guess, on its mesh."""
    border = np.zeros(problem.dimension + 1)
    border[problem.period_place] = 1.0
    return _about(problem, p).solve(u, p, border, period)


def with_suited_period(start: Candidate, point: SpecialPoint) -> Candidate:
    """A homoclinic end as its locus begins, with a shorter period where there are several saddles.

    One parameter brings a cycle as near to one saddle as is wanted. To several of them it comes no nearer than the error of its mesh is, and with a
    longer period no cycle is found further on.
    """
    problem = on_mesh(start.problem)
    limit = infinite_period(problem, point)
    if len(limit.saddles) < 2:
        return start
    rates = [float(np.abs(np.real(saddle.eigenvalues)).min()) for saddle in limit.saddles]
    period = -math.log(problem.flow.settings.error) * sum(1.0 / rate for rate in rates)
    try:
        return with_period(start, min(period, limit.period))
    except ValueError:
        return start


def limit_of(problem: CycleProblem, u: np.ndarray, p: float) -> InfinitePeriod | None:
    """What a cycle of a long period becomes as it grows without bound; None where its branch cannot be followed."""
    found = _with_period(problem, u, p, float(u[problem.period_place]))
    if found is None:
        return None
    about = "", "homoclinic", "", found.p, problem.parameter
    return infinite_period(problem, SpecialPoint(*about, found.u, found.tangent, np.zeros(0)))


def _waiting(problem: CycleProblem, u: np.ndarray, p: float, period: float) -> np.ndarray:
    """A guess of a cycle of another period: it waits longer, or less long, at each of its saddles."""
    limit = limit_of(problem, u, p)
    if limit is None or len(limit.saddles) < 2:
        return problem.waiting(u, p, period)
    x, now, widths = problem.parts(u, p)
    times, total = now * widths, sum(saddle.share for saddle in limit.saddles)
    for saddle in limit.saddles:
        more = (period - now) * saddle.share / total
        away = np.abs((x[:, 0] - saddle.place) / problem.node_scale).max(axis=1)
        for i in np.argsort(np.maximum(away, np.roll(away, -1))):
            change = max(more, (LEFT - 1.0) * times[i])
            times[i] += change
            more -= change
            if not more:
                break
    return problem.joined(x, period, times / times.sum())
