"""Complete a diagram: add branches for motions known in closed form and for motions that simulation finds and the diagram lacks."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from contvines.shared.motions import BAND, modulation_of

from ..coexistence.census import CountedMotion, add_root, census, join, locate, motions_from, run_on
from ..coexistence.places import Handover
from ..graph import Graph
from ..graph.run import Limits, Run
from ..graph.stretches import COVERAGE, SIMULATED, default_measure, gaps, not_simulated, spread, stretches
from ..problems.abilities import Population

if TYPE_CHECKING:
    from ..problems.protocol import Problem


CLOSED = 41  # number of values at which closed forms are evaluated, the interval's ends included
FEW = 2  # starts at each value of a gap
PASSES = 3  # passes over the gaps with one value in each; a branch found in a gap may split it into new gaps
PATIENT = (
    512.0  # forcing periods (of a self-excited machine: events) over which the largest response is measured
)
# relative to the largest response of all branches: the maximum of a larger response without a branch is refined
PROMISING = 0.7
HALVINGS = 5  # of the distance between the values around the largest simulated response
NEARLY = 0.998  # relative to the largest response: no refinement towards a neighbour with a larger response than this ...
FLAT = 0.002  # ... unless the neighbour is further away than this part of the interval
# kinds that are no attractors: a transient that has not ended; a start inside a wall
ON_ITS_WAY = ("slow", "impossible")


@dataclass(frozen=True)
class Unbranched:
    """An attractor that lies on no branch: chaotic, quasi-periodic, unbounded, or periodic but not traced.

    Attributes
    ----------
    value : float
        Of the parameter.
    kind : str
        See `contvines.graph.contents.Attractor`; "periodic" for a motion that was not traced.
    measures : dict
        Measures by name, from simulation; may be empty.
    state : float array, optional
        A state on the attractor.
    """

    value: float
    kind: str
    measures: dict[str, float]
    state: np.ndarray | None = None


def complete(graph: Graph, population: Population, values: int) -> list[Unbranched]:
    """Add to a graph the motions to which its first branch does not lead, each with the branches that leave it.

    The sources of these motions, in order:

    1. closed forms, evaluated at many values;
    2. a brief search: many starts at a few values;
    3. simulations just beyond the ends of stable stretches;
    4. a few starts at values in the gaps, where no stable motion is known;
    5. further values around the largest response of a motion without a branch, unless branches have much larger responses.

    Two kinds of motions are not traced but returned as they were simulated: those of more than `Settings.longest` unknowns (their
    windows are narrow), and all further ones after `Settings.completion` is used up; the graph's message then says that it is incomplete.

    Parameters
    ----------
    graph : Graph
        With its problems; extended in place.
    population : Population
    values : int
        Smallest number of values in the gaps, where no stable motion is known; 0: no simulations there.

    Returns
    -------
    list of Unbranched
        Attractors that were found and have no branch.
    """
    settings, (low, high) = graph.settings, graph.within
    limits = Limits.of(None, settings.get("bounds"), next(iter(graph.branches.values())).attached)
    run = run_on(graph, int(settings.get("depth", 0)), bool(settings.get("virtual", False)), limits)
    for p in np.linspace(low, high, CLOSED):
        _add_untraced(run, population.closed(float(p)), float(p))
    found_now: list[CountedMotion] = []
    before, untraced = set(graph.branches), 0

    def keep(found: list[CountedMotion], depth: int) -> None:
        nonlocal untraced
        for counted in found:
            if counted.u is None or locate(run, counted) is not None:
                continue
            spent = _size(graph, before) * population.price > run.settings.completion
            if spent or len(counted.u) > run.settings.longest:
                counted.problem, untraced = None, untraced + spent
        join(run, found, depth)
        found_now.extend(found)

    count, starts = population.brief
    for t in (np.arange(count) + 0.5) / count:
        keep(census(population, float(low + (high - low) * t), starts, 0, run.journal), 0)
    # depth run.depth from here on: these branches are short, and simulation also finds the motions that leave them
    handover = Handover(run, population)
    for end in handover.left():
        keep(handover.follow(end), run.depth)
    left = _observed(population, found_now)
    tried: set[float] = set()
    for at_least in (values, *[1] * PASSES) if values else ():
        found_now.clear()
        unknown = not_simulated(gaps(graph), graph.within, [one.value for one in left if one.measures])
        for p in sorted({*spread(unknown, graph.within, at_least)} - tried):
            tried.add(p)
            keep(census(population, p, FEW, 0, run.journal), run.depth)
        left += _observed(population, found_now)
    for _ in range(HALVINGS if values else 0):
        found_now.clear()
        places, state = _refinement(graph, left, tried)
        for p in places:
            tried.add(p)
            starts = population.starts(FEW, 0, p)
            if state is not None and state.shape == starts[0].shape:
                starts = np.vstack([state, starts])
            keep(motions_from(population, p, starts, f"largest/{p!r}", run.journal), run.depth)
        left += _observed(population, found_now)
    if untraced:
        spent = f"completion = {run.settings.completion} is spent: {untraced} motions that were met have no branch; raise it to trace them"
        graph.message, graph.complete = spent if graph.complete else f"{graph.message}; {spent}", False
    return _followed_longer(population, graph, left)


def _size(graph: Graph, before: Collection[str]) -> int:
    """Return the number of unknowns of all points of the branches whose labels are not in `before`."""
    return sum(b.points.size for label, b in graph.branches.items() if label not in before)


def _add_untraced(run: Run, motions: Sequence[tuple[Problem, np.ndarray]], p: float) -> None:
    """Trace those of some motions at `p` that lie on no branch yet."""
    for problem, u in motions:
        if run.register.find(problem, u, p, True) is None:
            try:
                add_root(run, problem, u, p)
            except ValueError as refusal:
                run.tell(f"a motion in closed form at {p:.6g} is left: {refusal}", p)


def _observed(population: Population, counted_motions: Sequence[CountedMotion]) -> list[Unbranched]:
    """Return the settled motions that lie on no branch, with their measures."""
    found = []
    for counted in counted_motions:
        attractor = counted.attractor
        if attractor.branch is None and attractor.kind not in ON_ITS_WAY:
            try:
                measures = population.observed(counted.state, attractor.value)
            except ValueError:  # the motion is unbounded
                measures = {}
            found.append(Unbranched(attractor.value, attractor.kind, measures, counted.state))
    return found


def _followed_longer(population: Population, graph: Graph, left: Sequence[Unbranched]) -> list[Unbranched]:
    """Return the motions `left`; if one of them has the largest response of all, it is measured again over `PATIENT` periods.

    Chaotic motions reach their largest response rarely.
    """
    name = default_measure(graph)
    one = max(left, key=lambda other: other.measures.get(name, -np.inf), default=None)
    if one is None or one.state is None or not one.measures.get(name, -np.inf) > _of_branches(graph):
        return [*left]
    measured = population.observed(one.state, one.value, PATIENT)
    longer = replace(one, measures=measured) if measured.get(name, -np.inf) > one.measures[name] else one
    return [longer if other is one else other for other in left]


def _of_branches(graph: Graph) -> float:
    """Return the largest stable response of all branches; -inf if there is none."""
    return max((float(np.nanmax(s.response, initial=-np.inf)) for s in stretches(graph)), default=-np.inf)


def _refinement(
    graph: Graph, left: Sequence[Unbranched], tried: Collection[float]
) -> tuple[list[float], np.ndarray | None]:
    """Return values at which the largest response without a branch is refined, and a state on its motion.

    The values lie half-way to the neighbouring values whose responses are smaller or which are far away. No values if branches have
    much larger responses, or if the neighbours are near.
    """
    name, (low, high) = default_measure(graph), graph.within
    responses: dict[float, float] = {}
    for one in left:
        responses[one.value] = max(responses.get(one.value, -np.inf), one.measures.get(name, -np.inf))
    top = max(responses, key=lambda value: responses[value], default=low)
    if not responses.get(top, -np.inf) > PROMISING * _of_branches(graph):
        return [], None
    places = sorted({low, high, *responses, *tried, *(end for gap in gaps(graph) for end in gap)})
    least = COVERAGE.least * (high - low)
    below = max((p for p in places if p < top - least), default=top)
    above = min((p for p in places if p > top + least), default=top)
    flat = {p for p in (below, above) if responses.get(p, -np.inf) >= NEARLY * responses[top]}
    neighbours = [p for p in (below, above) if p not in flat or abs(p - top) > FLAT * (high - low)]
    state = next(one.state for one in left if one.value == top and one.measures.get(name) == responses[top])
    return [0.5 * (top + other) for other in neighbours], state


VALUES = 5  # smallest number of values in the gaps
Band = tuple[float, float, float, float]


def simulated(graph: Graph, population: Population, starts: int = FEW) -> list[Band]:
    """Return the responses on which starts settle at some values in the gaps between the stable stretches of a graph.

    There are fewer values if motions have to be integrated numerically.

    Parameters
    ----------
    graph : Graph
    population : Population
    starts : int
        Number at each value.

    Returns
    -------
    list of (float, float, float, float)
        The value, and the lowest, mean and highest response per forcing period; all equal for a motion that recurs.
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
