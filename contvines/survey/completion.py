"""Complete a diagram: motions known in closed form, and those that simulation finds beside it, become branches of its graph."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from contvines.shared.motions import BAND, modulation_of

from ..coexistence.census import Counted, add_root, census, followed, join, locate, run_on
from ..coexistence.places import Handover
from ..graph import Graph
from ..graph.run import Limits, Run
from ..graph.stretches import COVERAGE, SIMULATED, default_measure, gaps, spread, stretches, unseen
from ..problems.abilities import Population

if TYPE_CHECKING:
    from ..problems.protocol import Problem


CLOSED = 41  # values at which closed forms are evaluated, the interval's ends included
FEW = 2  # starts at each value of a gap
PASSES = 3  # over the gaps with one value in each, for a branch that is found parts a gap
PATIENT = (
    512.0  # forcing periods (of a self-excited machine: events) over which the largest response is measured
)
PROMISING = (
    0.7  # of the largest response of all branches: one without a branch is followed to where it is largest
)
HALVINGS = 5  # of the distance between values about the largest response that was simulated, ...
NEARLY = 0.998  # ... to where it is nearly as large, ...
FLAT = 0.002  # ... and no further from there than this part of the interval: between values further apart it may be larger
ON_ITS_WAY = ("slow", "impossible")  # a transient that has not ended; a start inside a wall


@dataclass(frozen=True)
class Unbranched:
    """An attractor that lies on no branch: chaotic, quasi-periodic, one that runs away, or one that was not traced.

    Attributes
    ----------
    value : float
        Of the parameter.
    kind : str
        See `contvines.graph.contents.Attractor`; "periodic" of one that was not traced.
    measures : dict
        Numbers by name, from simulation; empty where there are none.
    state : float array, optional
        On it.
    """

    value: float
    kind: str
    measures: dict[str, float]
    state: np.ndarray | None = None


def complete(graph: Graph, population: Population, values: int) -> list[Unbranched]:
    """Add to a graph the motions to which its first branch does not lead, each with all that leaves it.

    1. The motions known in closed form, at many values.
    2. The attractors that a brief look meets, with many starts at a few values.
    3. What takes over where a stable stretch ends.
    4. What a few starts settle on where nothing stable is known.
    5. The same between these values, about the largest response of a motion without a branch, which is followed to there, unless branches have much
       larger ones.

    A motion of more than `Settings.longest` unknowns is not traced, for its window is narrow, and none is where `Settings.completion` is spent (the graph
    is not complete then, and says so): these are among what is returned, as they are simulated.

    Parameters
    ----------
    graph : Graph
        With its problems; extended in place.
    population : Population
    values : int
        At least so many values are looked at where nothing stable is known; 0 for none.

    Returns
    -------
    list of Unbranched
        Attractors that were met and have no branch.
    """
    kept, (low, high) = graph.settings, graph.within
    limits = Limits.of(None, kept.get("bounds"), next(iter(graph.branches.values())).attached)
    run = run_on(graph, int(kept.get("depth", 0)), bool(kept.get("virtual", False)), limits)
    for p in np.linspace(low, high, CLOSED):
        _add(run, population.closed(float(p)), float(p))
    met: list[Counted] = []
    before, untraced = set(graph.branches), 0

    def keep(found: list[Counted], depth: int) -> None:
        nonlocal untraced
        for counted in found:
            if counted.u is None or locate(run, counted) is not None:
                continue
            spent = _size(graph, before) * population.price > run.settings.completion
            if spent or len(counted.u) > run.settings.longest:
                counted.problem, untraced = None, untraced + spent
        join(run, found, depth)
        met.extend(found)

    count, starts = population.brief
    for t in (np.arange(count) + 0.5) / count:
        keep(census(population, float(low + (high - low) * t), starts, 0, run.journal), 0)
    # the branches of motions that are met from here on are short: what leaves them is met as well
    handover = Handover(run, population)
    for end in handover.left():
        keep(handover.follow(end), run.depth)
    left = _observed(population, met)
    looked: set[float] = set()
    for at_least in (values, *[1] * PASSES) if values else ():
        met.clear()
        unknown = unseen(gaps(graph), graph.within, [one.value for one in left if one.measures])
        for p in sorted({*spread(unknown, graph.within, at_least)} - looked):
            looked.add(p)
            keep(census(population, p, FEW, 0, run.journal), run.depth)
        left += _observed(population, met)
    for _ in range(HALVINGS if values else 0):
        met.clear()
        places, state = _about_the_largest(graph, left, looked)
        for p in places:
            looked.add(p)
            starts = population.starts(FEW, 0, p)
            if state is not None and state.shape == starts[0].shape:
                starts = np.vstack([state, starts])
            keep(followed(population, p, starts, f"largest/{p!r}", run.journal), run.depth)
        left += _observed(population, met)
    if untraced:
        spent = f"completion = {run.settings.completion} is spent: {untraced} motions that were met have no branch; raise it to trace them"
        graph.message, graph.complete = spent if graph.complete else f"{graph.message}; {spent}", False
    return _followed_longer(population, graph, left)


def _size(graph: Graph, before: Collection[str]) -> int:
    """Unknowns of all points of the branches that were not there before."""
    return sum(b.points.size for label, b in graph.branches.items() if label not in before)


def _add(run: Run, motions: Sequence[tuple[Problem, np.ndarray]], p: float) -> None:
    """Trace the motions that lie on no branch yet."""
    for problem, u in motions:
        if run.register.find(problem, u, p, True) is None:
            try:
                add_root(run, problem, u, p)
            except ValueError as refusal:
                run.tell(f"a motion in closed form at {p:.6g} is left: {refusal}", p)


def _observed(population: Population, met: Sequence[Counted]) -> list[Unbranched]:
    """Those that lie on no branch and have settled, with what is measured of them."""
    found = []
    for counted in met:
        about = counted.attractor
        if about.branch is None and about.kind not in ON_ITS_WAY:
            try:
                measures = population.observed(counted.state, about.value)
            except ValueError:  # it runs away
                measures = {}
            found.append(Unbranched(about.value, about.kind, measures, counted.state))
    return found


def _followed_longer(population: Population, graph: Graph, left: Sequence[Unbranched]) -> list[Unbranched]:
    """These motions; the one with the largest response, where no branch has a larger one, measured over many periods: chaotic motions seldom reach it."""
    name = default_measure(graph)
    one = max(left, key=lambda other: other.measures.get(name, -np.inf), default=None)
    if one is None or one.state is None or not one.measures.get(name, -np.inf) > _of_branches(graph):
        return [*left]
    seen = population.observed(one.state, one.value, PATIENT)
    longer = replace(one, measures=seen) if seen.get(name, -np.inf) > one.measures[name] else one
    return [longer if other is one else other for other in left]


def _of_branches(graph: Graph) -> float:
    """The largest stable response of all branches."""
    return max((float(np.nanmax(s.response, initial=-np.inf)) for s in stretches(graph)), default=-np.inf)


def _about_the_largest(
    graph: Graph, left: Sequence[Unbranched], looked: Collection[float]
) -> tuple[list[float], np.ndarray | None]:
    """Values half-way from the largest response without a branch to its neighbours that are not as large or are far, and a state on its motion; no
    values where branches have much larger ones, or these are near."""
    name, (low, high) = default_measure(graph), graph.within
    known: dict[float, float] = {}
    for one in left:
        known[one.value] = max(known.get(one.value, -np.inf), one.measures.get(name, -np.inf))
    top = max(known, key=lambda value: known[value], default=low)
    if not known.get(top, -np.inf) > PROMISING * _of_branches(graph):
        return [], None
    places = sorted({low, high, *known, *looked, *(end for gap in gaps(graph) for end in gap)})
    least = COVERAGE.least * (high - low)
    below = max((p for p in places if p < top - least), default=top)
    above = min((p for p in places if p > top + least), default=top)
    flat = {p for p in (below, above) if known.get(p, -np.inf) >= NEARLY * known[top]}
    beside = [p for p in (below, above) if p not in flat or abs(p - top) > FLAT * (high - low)]
    state = next(one.state for one in left if one.value == top and one.measures.get(name) == known[top])
    return [0.5 * (top + other) for other in beside], state


VALUES = 5  # in the gaps, at least
Band = tuple[float, float, float, float]


def simulated(graph: Graph, population: Population, starts: int = FEW) -> list[Band]:
    """What starts settle on at some values of every gap between the stable stretches of a graph, at fewer where a motion is integrated.

    Parameters
    ----------
    graph : Graph
    population : Population
    starts : int
        At each value.

    Returns
    -------
    list of (float, float, float, float)
        The value, and the lowest, mean and highest response in a forcing period; all the same of a motion that recurs.
    """
    name, found = default_measure(graph), []
    for p in spread(gaps(graph), graph.within, VALUES, SIMULATED / np.cbrt(population.price)):
        motions, *_ = population.settle(population.starts(starts, 0, p), p)
        for motion in motions:
            if motion.kind in ON_ITS_WAY or motion.state is None:
                continue
            measures = population.observed(motion.state, p)
            high = measures.get(name, np.nan)
            modulated = bool(modulation_of(measures))
            low, mean = (measures[end] if modulated else high for end in BAND[:2])
            if np.isfinite(high):
                found.append((p, low, mean, high))
    return found
