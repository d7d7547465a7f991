"""Stable stretches of a diagram's branches, the largest response on each, and the gaps between them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from contvines.shared.near_names import did_you_mean

from ..continuation.settings import Settings

if TYPE_CHECKING:
    from ..branches import Branch
    from ..branches.special_point import SpecialPoint
    from . import Graph


@dataclass(frozen=True)
class Coverage:
    """Tolerance for gaps in the stable responses of a diagram.

    Attributes
    ----------
    least : float
        Part of the interval: gaps whose total length is less are neglected, and not simulated.
    """

    least: float = 1e-3


COVERAGE = Coverage()
SHARP = Settings.one_place  # accuracy of a peak's position, relative to the distance of its neighbours
MEETING = Settings.located  # stretches meet if their ends are nearer than this part of the interval
SIMULATED = 40  # number of simulated values if the gaps are the whole interval


@dataclass(frozen=True)
class Stretch:
    """A stable piece of a branch on which the parameter is monotonic.

    Attributes
    ----------
    branch : Branch
    first, last : int
        Inclusive indices of its points on the branch.
    values, response : ndarray, shape (last - first + 1,)
        Parameter values, and values of the measure.
    measure : str
        Name of the measure.
    """

    branch: Branch
    first: int
    last: int
    values: np.ndarray
    response: np.ndarray
    measure: str


def stretches(graph: Graph, measure: str | None = None) -> list[Stretch]:
    """Return the stable stretches of a diagram, with a measure as response; by default that of the picture."""
    name = measure or default_measure(graph)
    found = []
    for branch in graph.branches.values():
        if not branch.real or not len(branch):
            continue
        response = np.asarray(branch.measure(name), dtype=float)
        for first, last, stable in branch.pieces():
            if not stable:
                continue
            steps = np.sign(np.diff(branch.values[first : last + 1]))
            turns = [first, *(first + 1 + np.flatnonzero(steps[1:] * steps[:-1] < 0.0)).tolist(), last]
            for a, b in pairwise(turns):
                part = slice(a, b + 1)
                found.append(Stretch(branch, a, b, branch.values[part], response[part], name))
    return found


class Top(NamedTuple):
    """The largest response of some stretches, its parameter value, the index of the nearest point on the branch, and the stretch."""

    response: float
    value: float
    place: int
    stretch: Stretch


def highest(parts: Sequence[Stretch]) -> Top | None:
    """Return the largest response of some stretches; None if there is none.

    Between the points next to a peak the motion is solved for at further values, on the stretches whose peak may be the largest: between points the
    response may be higher by as much as it falls from the peak to the neighbouring points.
    """
    tops = [top for top in map(at_points, parts) if np.isfinite(top.response)]
    certain = max((top.response for top in tops), default=-np.inf)
    refined = [_refined(top) if top.response + _fall(top) >= certain else top for top in tops]
    return max(refined, key=lambda top: top.response, default=None)


def at_points(stretch: Stretch) -> Top:
    """Return the largest response at the points of a stretch; -inf if it has none."""
    if not np.isfinite(stretch.response).any():
        return Top(-np.inf, np.nan, stretch.first, stretch)
    at = int(np.nanargmax(stretch.response))
    return Top(float(stretch.response[at]), float(stretch.values[at]), stretch.first + at, stretch)


def _fall(top: Top) -> float:
    """Return by how much the response falls from a peak to the lower of its neighbours; inf if one is not finite."""
    at = top.place - top.stretch.first
    near = top.stretch.response[max(at - 1, 0) : at + 2]
    return top.response - float(np.nanmin(near)) if np.all(np.isfinite(near)) else np.inf


def _refined(top: Top) -> Top:
    """Return the peak, located between the points by solving for further motions."""
    from scipy.optimize import OptimizeResult, minimize_scalar

    stretch, at = top.stretch, top.place - top.stretch.first
    a, b = max(at - 1, 0), min(at + 1, len(stretch.values) - 1)
    low, high = sorted((float(stretch.values[a]), float(stretch.values[b])))
    solve = _solver(stretch, a, b) if low < high else None
    if solve is None:
        return top

    def lowered(p: float) -> float:
        u = solve(p)
        return np.inf if u is None else -_response(stretch, u, p)

    sharp = {"xatol": SHARP * (high - low)}
    found = minimize_scalar(lowered, bounds=(low, high), method="bounded", options=sharp)
    assert isinstance(found, OptimizeResult)
    return max(
        top, top._replace(response=-float(found.fun), value=float(found.x)), key=lambda one: one.response
    )


def inside(top: Top, part: float) -> tuple[np.ndarray, float, float]:
    """Return the unknowns, value and response of a solution inside the stretch, whose response is lower than the largest one by about a part.

    The largest response often is at an end of the stretch, where the motion touches a wall or loses its stability. The smallest disturbance
    leads away from there, so that a simulation from there cannot confirm the motion.
    """
    stretch, at = top.stretch, top.place - top.stretch.first
    values, response, level = stretch.values, stretch.response, (1.0 - part) * top.response
    below = np.flatnonzero(~(response >= level))
    for outer in (*below[below < at][-1:].tolist(), *below[below > at][:1].tolist()):
        inner = outer + (1 if outer < at else -1)
        p = float(np.interp(level, response[[outer, inner]], values[[outer, inner]]))
        solve = _solver(stretch, *sorted((outer, inner)))
        u = None if solve is None else solve(p)
        if u is not None:
            return u, p, _response(stretch, u, p)
    middle = len(values) // 2  # no point has a lower response
    return stretch.branch.points[stretch.first + middle], float(values[middle]), float(response[middle])


def _solver(stretch: Stretch, a: int, b: int) -> Callable[[float], np.ndarray | None] | None:
    """Return a function: value between points a and b of a stretch -> unknowns there, or None; None for a branch without a problem."""
    from ..continuation.engine import Engine

    branch = stretch.branch
    if branch.problem is None:
        return None
    low, high = sorted((float(stretch.values[a]), float(stretch.values[b])))
    engine = Engine(branch.problem, (low, high), Settings())
    points = branch.points[stretch.first : stretch.last + 1]

    def solve(p: float) -> np.ndarray | None:
        for i in range(a, b):
            first, last = stretch.values[i], stretch.values[i + 1]
            if first != last and (first - p) * (last - p) <= 0.0:
                part = (p - first) / (last - first)
                guess = (1.0 - part) * points[i] + part * points[i + 1]
                solved = engine.at_value(guess, p)
                chord = np.abs(points[i + 1] - points[i]).max()
                # a motion farther from the chord than the chord's length belongs to another branch
                if solved is not None and np.abs(solved.u - guess).max() <= chord:
                    return solved.u
        return None

    return solve


def _response(stretch: Stretch, u: np.ndarray, p: float) -> float:
    """Return the response of a solution."""
    return float(stretch.branch.measure_of(stretch.measure, u[None, :], np.array([p]))[0])


def gaps(graph: Graph) -> list[tuple[float, float]]:
    """Return the intervals of the parameter in which the diagram has no stable response."""
    start, end = (float(value) for value in graph.within)
    found, reached = [], start
    spans = sorted((s.values.min(), s.values.max()) for s in stretches(graph))
    for low, high in [*spans, (end, end)]:
        if low - reached > MEETING * (end - start):
            found.append((float(reached), float(low)))
        reached = max(reached, high)
    return found


def united(intervals: Iterable[tuple[float, float]]) -> list[tuple[float, float]]:
    """Return the union of intervals: in order, those that meet or overlap joined."""
    joined: list[tuple[float, float]] = []
    for low, high in sorted(intervals):
        if joined and low <= joined[-1][1]:
            joined[-1] = (joined[-1][0], max(joined[-1][1], high))
        else:
            joined.append((low, high))
    return joined


def not_simulated(
    open_: Sequence[tuple[float, float]], within: tuple[float, float], simulated: Sequence[float]
) -> list[tuple[float, float]]:
    """Return the parts of gaps that simulation has not covered.

    A part of a gap between two neighbouring simulated values, or between one and an end of the gap, is covered if it is shorter than
    1 / `SIMULATED` of the interval.

    Parameters
    ----------
    open_ : sequence of (float, float)
        Gaps.
    within : (float, float)
        The whole interval.
    simulated : sequence of float
        Values at which a motion was simulated.
    """
    near = (within[1] - within[0]) / SIMULATED * (1.0 + MEETING)
    found = []
    for low, high in open_:
        inside = sorted(p for p in simulated if low <= p <= high)
        found += [(a, b) for a, b in pairwise([low, *inside, high]) if not inside or b - a > near]
    return found


def spread(
    open_: Sequence[tuple[float, float]],
    within: tuple[float, float],
    values: int,
    everywhere: float = SIMULATED,
) -> list[float]:
    """Return values spread evenly over gaps, at least one in each.

    The shortest gaps, which are `Coverage.least` of the interval together, are left out.

    Parameters
    ----------
    open_ : sequence of (float, float)
        Gaps.
    within : (float, float)
        The whole interval.
    values : int
        Least number of values; there are more if the gaps are a large part of the interval. 0 for none.
    everywhere : float
        Number of values if the gaps are the whole interval.
    """
    size = within[1] - within[0]
    ascending = sorted(open_, key=lambda gap: gap[1] - gap[0])
    total = np.cumsum([high - low for low, high in ascending])
    wide = sorted(gap for gap, reached in zip(ascending, total) if reached > COVERAGE.least * size)
    if not values or not wide:
        return []
    length = sum(high - low for low, high in wide)
    places = np.linspace(0.0, length, max(values, int(np.ceil(everywhere * length / size))) + 2)[1:-1]
    found: list[float] = []
    for low, high in wide:
        found += [low + p for p in places.tolist() if 0.0 <= p < high - low] or [0.5 * (low + high)]
        places = places - (high - low)
    return found


# ------------------------------------------------------------------ measures on the axes of a diagram
def default_measure(graph: Graph) -> str:
    """Return the measure on the y axis if none is named: the problem's default, if it is a number on at least one branch.

    Motions without impacts have no velocity B; if no branch has one, the largest |w| is shown.
    """
    for branch in graph.branches.values():
        source = branch if branch.problem is None else branch.problem
        names, wanted = list(source.measure_names), source.default_measure
        if not names or (branch.problem is None and not wanted):
            continue
        others = [n for n in names if n not in ("norm", graph.parameter)]
        choice = [n for n in (wanted, "max_abs_w", *others) if n in names]
        return next((str(n) for n in choice if _is_measured(graph, n)), choice[0] if choice else names[0])
    return "norm"


def undrawn(graph: Graph, x: str, y: str) -> str:
    """Return a line for the legend that lists the branches without finite numbers to draw; empty if there are none."""
    missing = [b for b in graph.branches.values() if len(b) and not _finite(b, x, y)]
    if not missing:
        return ""
    labels = [b.label for b in missing]
    listed = ", ".join(labels) if len(labels) <= 4 else f"{', '.join(labels[:3])} +{len(labels) - 3}"
    impact_free = all(b.description.get("impacts") == 0 for b in missing)
    return f"not drawn: {listed} ({'no impacts' if impact_free else f'no {y} there'})"


def measured(branch: Branch, name: str) -> np.ndarray:
    """Return a measure along a branch, shape (n,).

    Raises
    ------
    ValueError
        If the branch has no such measure; the message lists those that it has.
    """
    try:
        return np.asarray(branch.measure(name), float)
    except (KeyError, ValueError) as error:
        names = sorted({branch.parameter, *branch.measure_names})
        raise ValueError(
            f"{branch.label} has no measure {name!r}{did_you_mean(name, names)}; choose one of {', '.join(names)}."
        ) from error


def _is_measured(graph: Graph, name: str) -> bool:
    """Whether a measure is a finite number on some branch."""
    return any(_finite(b, graph.parameter, name) for b in graph.branches.values() if len(b))


def _finite(branch: Branch, x: str, y: str) -> bool:
    """Whether some point of a branch has both measures."""
    return bool(np.any(np.isfinite(measured(branch, x)) & np.isfinite(measured(branch, y))))


def measure_at(branch: Branch, point: SpecialPoint, name: str) -> float:
    """Return a measure at a special point of a branch.

    Raises
    ------
    ValueError
        If the branch has no such measure.
    """
    if name == branch.parameter:
        return float(point.value)
    if 0 <= point.index < len(branch):
        return float(measured(branch, name)[point.index])
    if branch.problem is None:
        nearest = int(np.argmin(np.abs(branch.points - point.u).max(axis=1)))
        return float(measured(branch, name)[nearest])
    return float(branch.problem.measures((name,), point.u[None, :], np.array([point.value]))[name][0])
