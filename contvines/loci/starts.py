"""Starts of loci: from a special point to the problem of its locus and the first point on it.

Homoclinic orbits are represented by cycles of a long, fixed period, which may differ from the period at the end of the branch.
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
from .kernels import FLIP, LARGEST_DISTANCE, MARGIN, OWN, PAIR, PERIOD, condition
from .linear import Linearisation, borders_at, singularity
from .problem import LocusProblem, check_second, has_natural_units
from .settings import VANISHING

PLAIN = 16.0  # a parameter whose size is between 1 / PLAIN and PLAIN has the unit 1
LONGER = 1.3  # largest ratio of successive periods on the way to a given one
# smallest part of its duration that a mesh interval near a saddle keeps when the period is reduced
LEAST_PART = 0.1

Cycle = tuple[CycleProblem, np.ndarray, float]


@dataclass(frozen=True, eq=False)
class Candidate:
    """A special point at (p, q) from which a locus may be traced.

    ``index`` is the margin's index at a border, ``seed`` the label of the point of origin, ``pair`` the index of the locus's complex pair among
    the most critical ones where two pairs are critical.
    """

    problem: Problem
    kind: str
    u: np.ndarray
    p: float
    q: float
    seed: str
    index: int = 0
    own_kind: Kind | None = None
    pair: int | None = None


def check_start(point: SpecialPoint, over: str, within: tuple[float, float]) -> None:
    """Check that a locus can start at a special point, with this second parameter and interval.

    Raises
    ------
    ValueError
        If the point has no problem, the parameter does not exist, or the interval does not contain the diagram's value or has impossible values.
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
    """Return a special point of a diagram as the start of its locus.

    Parameters
    ----------
    point : SpecialPoint
    over : str
        Name of the second parameter.
    kinds : iterable of Kind
        User-defined kinds; a point of a user-defined kind from a file needs its kind here.
    suited : bool
        Replace the cycle at a homoclinic end by one whose period is suitable for the locus.

    Raises
    ------
    ValueError
        If the point is of a user-defined kind without a condition.
    """
    kind = condition_of(point, kinds) if of_own_kind(point) else None
    point = regular_side(point) if kind is None else point
    q = point.attached.parameters[over]
    fields = point.attached, point.kind, np.array(point.u), float(point.value), q, point.label
    start = Candidate(*fields, point.margin_index or 0, kind)
    return with_suited_period(start, point) if suited and point.kind == "homoclinic" else start


def begin(start: Candidate, over: str, bounds: tuple[float, float] = (-np.inf, np.inf)) -> LocusProblem:
    """Return the problem of the locus through a special point, with the borders and the reference pair of that point.

    Parameters
    ----------
    start : Candidate
    over : str
        Name of the second parameter.
    bounds : (float, float)
        Interval of the first parameter.
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
        # the distance from an equilibrium is a margin only if the cycle is near one; before a saddle-node on the cycle there is none yet
        near = on_mesh(problem).from_rest(u, p) < 0.1 * LARGEST_DISTANCE
        locus.masked = (1,) if near else (0, 1)
    if wanted == MARGIN:
        margins = Linearisation(problem).at(u, p).margins
        locus.masked = tuple(np.flatnonzero(np.abs(margins) < VANISHING.margin).tolist()) or (index,)
    if wanted == PAIR:
        line = Linearisation(problem).at(u, p)
        pairs = line.positions()[start.pair or 0 :]
        locus.reference = line.pair(next(iter(pairs), 0.0))[1]
    return locus


def first_point(
    locus: LocusProblem, u: np.ndarray, p: float, q: float, within: tuple[float, float], settings: Settings
) -> tuple[Engine, Solved | None]:
    """Return an engine for the locus, and its first point; None if Newton's method fails or converges to another point."""
    engine = Engine(locus, within, settings)
    U = locus.joined(u, p)
    found = engine.start(U, float(q))
    if found is None:
        return engine, None
    solution, guess = engine.join(found.u, found.p), engine.join(U, q)
    gap = np.abs(solution - guess) / (engine.scale + np.abs(guess))
    return engine, found if gap.max() < VANISHING.loose else None


def smooth_margin(problem: Problem, index: int, u: np.ndarray, p: float) -> int:
    """Return the index of the margin that passes zero most smoothly, of all that vanish at a border, as the condition of the locus.

    Some margins jump at a border (the time to a slip where a stick vanishes), others only touch zero (the distance from a wall where the speed of an
    impact on it vanishes).
    """
    engine = _engine_near(problem, p)
    middle = engine.start(u, p)
    if middle is None:
        return index
    around = [engine.beside(middle, step) for step in (VANISHING.offset, -VANISHING.offset)]
    margins = [engine.margins(point.row) for point in (middle, *around) if point is not None]
    if len(margins) < 3:
        return index
    with np.errstate(invalid="ignore"):
        rises = np.array(margins[1:]) - margins[0]
        # 0: passes zero linearly, 1: touches zero
        bent = np.abs(rises.sum(axis=0)) / np.abs(rises).sum(axis=0)
    smooth = (np.abs(margins[0]) < VANISHING.margin) & (bent <= VANISHING.straight)
    if bent[index] <= VANISHING.straight or not smooth.any():
        return index
    return int(np.where(smooth, bent, np.inf).argmin())


def _engine_near(problem: Problem, p: float) -> Engine:
    """Return an engine for single solutions near a value of the parameter."""
    wide = 1.0 + abs(p)
    return Engine(problem, (p - wide, p + wide), Settings())


def unit_of(problem: Problem, bounds: tuple[float, float], p: float) -> float:
    """Return the unit of the first parameter as an unknown: 1, or a power of two if the parameter is much larger or smaller than the other unknowns."""
    if not has_natural_units(problem):
        return 1.0  # the problem has scales
    size = max(map(abs, bounds)) if np.isfinite(bounds).all() else abs(p)
    return 1.0 if size == 0.0 or 1.0 / PLAIN <= size <= PLAIN else 2.0 ** round(np.log2(size))


def regular_side(point: SpecialPoint) -> SpecialPoint:
    """Return a special point as a point of the motion whose equations are regular there, if it was found on the other motion:

    - a period doubling, or a Hopf point, that was found on the doubled motion, or on the cycles: of the motion that doubles, or of the equilibrium;
    - a border at which the equations are singular: of the motion on the other side. (When a stick shrinks to zero duration, two events coincide and the
      equations are singular along the whole border. The motion on the other side has no stick, and grazes there.)

    Otherwise the point itself.
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
        solved = _engine_near(other, p).at_value(np.asarray(seed.u, dtype=float), p)
        if solved is None or singularity(other, solved.u, p) < VANISHING.singular:
            continue
        zero = np.flatnonzero(np.abs(Linearisation(other).at(solved.u, p).margins) < VANISHING.margin)
        if len(zero):
            j = int(zero[0])
            return replace(point, problem=other, u=solved.u, kind=other.margin_kind(j), margin_index=j)
    return point


# ------------------------------------------------------------------ user-defined kinds
def of_own_kind(point: SpecialPoint) -> bool:
    """Whether a special point is of a user-defined kind (borders of a problem are not)."""
    return point.own_kind is not None or (point.kind not in BY_NAME and point.margin_index is None)


def condition_of(point: SpecialPoint, kinds: Iterable[Kind]) -> Kind:
    """Return the user-defined kind of a point: the point's own or, for a point from a file, the one of the same name in `kinds`.

    Raises
    ------
    ValueError
        If there is none, or if it has no condition.
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


# ------------------------------------------------------------------ cycles that represent homoclinic orbits
def with_period(start: Candidate, period: float) -> Candidate:
    """Return a homoclinic end with another period; it raises the errors of `lengthened`."""
    problem, u, p = lengthened(on_mesh(start.problem), start.u, start.p, period)
    return replace(start, problem=problem, u=u, p=p)


def lengthened(problem: CycleProblem, u: np.ndarray, p: float, period: float) -> Cycle:
    """Return a nearly homoclinic cycle with another period, by steps in the period; the additional time is spent near the saddles.

    Raises
    ------
    ValueError
        If the period is not positive, or no cycle of that period is found.
    """
    if not period > 0.0:
        raise ValueError(f"period = {period!r} must be positive")
    wanted = float(u[problem.period_place])
    while wanted != period:  # compare requested periods: a solved period has rounding errors
        wanted = min(max(period, wanted / LONGER), wanted * LONGER)
        found = of_period(problem, _longer_cycle(problem, u, p, wanted), p, wanted)
        if found is None:
            raise ValueError(
                f"period = {period:.6g}: on the way there no cycle of period {wanted:.6g} is found beyond the one of {u[problem.period_place]:.6g}"
            )
        problem, u, p = found
    return problem, u, p


def of_period(problem: CycleProblem, u: np.ndarray, p: float, period: float) -> Cycle | None:
    """Solve for the cycle of a given period near a guess, with adaptation of the mesh; None if Newton's method fails."""
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
    """Solve for the cycle of a given period near a guess on its mesh; None if Newton's method fails."""
    border = np.zeros(problem.dimension + 1)
    border[problem.period_place] = 1.0
    return _engine_near(problem, p).solve(u, p, border, period)


def with_suited_period(start: Candidate, point: SpecialPoint) -> Candidate:
    """Return a homoclinic end with a period suitable for its locus: a shorter one if there are several saddles.

    One parameter is enough to bring a cycle arbitrarily near to one saddle. It comes no nearer to several saddles than the error of its mesh, and with a
    longer period the locus could not be continued.
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
    """Return the limit of a cycle of a long period as the period grows without bound; None if the tangent of its branch cannot be computed."""
    found = _with_period(problem, u, p, float(u[problem.period_place]))
    if found is None:
        return None
    fields = "", "homoclinic", "", found.p, problem.parameter
    return infinite_period(problem, SpecialPoint(*fields, found.u, found.tangent, np.zeros(0)))


def _longer_cycle(problem: CycleProblem, u: np.ndarray, p: float, period: float) -> np.ndarray:
    """A guess for a cycle of another period: the times near its saddles are changed, in proportion to their shares."""
    limit = limit_of(problem, u, p)
    if limit is None or len(limit.saddles) < 2:
        return problem.waiting(u, p, period)
    x, old, widths = problem.parts(u, p)
    times, total = old * widths, sum(saddle.share for saddle in limit.saddles)
    for saddle in limit.saddles:
        more = (period - old) * saddle.share / total
        away = np.abs((x[:, 0] - saddle.place) / problem.node_scale).max(axis=1)
        for i in np.argsort(np.maximum(away, np.roll(away, -1))):
            change = max(more, (LEAST_PART - 1.0) * times[i])
            times[i] += change
            more -= change
            if not more:
                break
    return problem.joined(x, period, times / times.sum())
