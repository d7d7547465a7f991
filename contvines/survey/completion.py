"""Complete a diagram: motions known in closed form, and those that simulation finds beside it, become branches of its graph."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..coexistence.build import join
from ..coexistence.census import Counted, census
from ..coexistence.handover import Handover
from ..coexistence.population import Population
from ..coexistence.roots import add_root
from ..continuation.settings import Settings
from ..graph.builder import adopt
from ..graph.graph import Graph
from ..graph.limits import Limits
from ..graph.run import Run
from ..journal import NullJournal
from .stretches import gaps, spread

CLOSED = 41  # values at which closed forms are evaluated, the interval's ends included
FEW = 2  # starts at each value of a gap
ON_ITS_WAY = ("slow", "impossible")  # a transient that has not ended; a start inside a wall


@dataclass(frozen=True)
class Unbranched:
    """An attractor that lies on no branch: chaotic, quasi-periodic, or one that runs away.

    Attributes
    ----------
    value : float
        Of the parameter.
    kind : str
        See `contvines.graph.attractor.Attractor`.
    measures : dict
        Numbers by name, from simulation; empty where there are none.
    """

    value: float
    kind: str
    measures: dict[str, float]


def complete(graph: Graph, population: Population, values: int) -> list[Unbranched]:
    """Add to a graph the motions to which its first branch does not lead, each with all that leaves it.

    1. The motions known in closed form, at many values.
    2. The attractors that a brief look meets, with many starts at a few values.
    3. What takes over where a stable stretch ends.
    4. What a few starts settle on where nothing stable is known.

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
    run, (low, high) = _run(graph), graph.within
    for p in np.linspace(low, high, CLOSED):
        _add(run, population.closed(float(p)), float(p))
    met: list[Counted] = []

    def keep(found: list[Counted], depth: int) -> None:
        join(run, found, depth)
        met.extend(found)

    count, starts = population.brief
    for t in (np.arange(count) + 0.5) / count:
        keep(census(population, float(low + (high - low) * t), starts, 0, run.journal), 0)
    # the branches of motions that are met from here on are short: what leaves them is met as well
    handover = Handover(run, population)
    for end in handover.left():
        keep(handover.follow(end), run.depth)
    for p in spread(gaps(graph), graph.within, values):
        keep(census(population, p, FEW, 0, run.journal), run.depth)
    left = [counted for counted in met if counted.attractor.branch is None]
    return [_observed(population, one) for one in left if one.attractor.kind not in ON_ITS_WAY]


def _run(graph: Graph) -> Run:
    """A run that goes on with a graph, with the settings it was made with."""
    first = next(iter(graph.branches.values())).problem
    kept = graph.settings
    limits = Limits.of(None, kept.get("bounds"), first)
    depth, virtual = int(kept.get("depth", 0)), bool(kept.get("virtual", False))
    run = Run(graph, Settings.kept(kept), NullJournal(), depth, virtual, None, None, limits)
    adopt(run)
    return run


def _add(run: Run, motions: Sequence[tuple[Any, np.ndarray]], p: float) -> None:
    """Trace the motions that lie on no branch yet."""
    for problem, u in motions:
        if run.register.find(problem, u, p, True) is None:
            try:
                add_root(run, problem, u, p)
            except ValueError as refusal:
                run.tell(f"a motion in closed form at {p:.6g} is left: {refusal}", p)


def _observed(population: Population, counted: Counted) -> Unbranched:
    about = counted.attractor
    try:
        measures = population.observed(counted.state, about.value)
    except ValueError:  # it runs away
        measures = {}
    return Unbranched(about.value, about.kind, measures)
