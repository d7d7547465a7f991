"""The atlas: simulated attractors joined to one graph, until nothing that simulation finds is missing on it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from ..continuation.settings import Settings
from ..graph.automatic import new_run
from ..graph.builder import begin, work
from ..graph.graph import Graph
from ..graph.run import Progress, Run
from ..interrupts import listening
from .census import Counted, census
from .population import Population, population_of

BEYOND = 2e-3  # of the interval: so far outside a stable stretch it is asked what the motion becomes
MOST_EXTRA = 24  # values added beyond the ends of stable stretches


@listening()
def atlas(
    machine: Any,
    over: str | None = None,
    within: tuple[float, float] | None = None,
    values: int | Sequence[float] = 16,
    starts: int = 256,
    seed: int = 0,
    depth: int = 3,
    virtual: bool = False,
    user_functions: Mapping[str, Any] | None = None,
    journal: Any = None,
    progress: Callable[[Progress], None] | None = None,
    settings: Settings | Mapping[str, Any] | None = None,
) -> Graph:
    """One graph with every attractor that many simulated starts find, and all that hangs together with them.

    At each value starts are drawn, simulated, and what they settle on is solved: it is then a point of a known branch,
    exactly, or the root of a new one, which is traced with everything that leaves it. Beyond the ends of stable
    stretches it is asked once more.

    Parameters
    ----------
    machine : machine, orbit or problem
        With a ``population``; see :mod:`contvines.coexistence.population`.
    over : str, optional
        Name of the parameter.
    within : (float, float)
        Its interval.
    values : int or sequence of float
        Where starts are simulated: so many evenly spread values, or these.
    starts : int
        How many at each value.
    seed : int
        Of the starts; equal seeds give equal graphs.
    depth, virtual, user_functions, journal, progress, settings
        As for :func:`contvines.diagram`.

    Returns
    -------
    Graph
        With ``attractors``; it may have several components.

    Raises
    ------
    ValueError
        If the interval, the values or the starts will not do; the sentence says why.
    """
    population = population_of(machine, over)
    if within is None:
        raise ValueError(
            f"within = None: give the interval of {population.parameter}, for example within=(0.2, 1.3)"
        )
    where = check_values(values, within)
    if not (isinstance(starts, int) and starts >= 1):
        raise ValueError(f"starts = {starts!r} must be a whole number, 1 or more")
    if not (isinstance(seed, int) and seed >= 0):
        raise ValueError(f"seed = {seed!r} must be a whole number, 0 or more")
    run = new_run(
        population.parameter,
        dict(population.about),
        within,
        depth,
        virtual,
        user_functions,
        journal,
        progress,
        settings,
    )
    run.graph.settings |= {"values": len(where), "starts": starts, "seed": seed}
    everything: list[Counted] = []
    for p in where:
        everything += _at(run, population, p, starts, seed)
    for p in _beyond(run.graph, where):
        everything += _at(run, population, p, max(starts // 4, 16), seed)
    everything.sort(key=lambda counted: counted.attractor.value)
    run.graph.attractors = [counted.attractor for counted in everything]
    run.graph.message = run.graph.message or "finished"
    run.graph.finished = True
    run.journal.checkpoint(run.graph)
    return run.graph


def check_values(values: int | Sequence[float], within: tuple[float, float]) -> list[float]:
    """The values at which starts are simulated, in increasing order.

    Raises
    ------
    ValueError
        If there are none, or one lies outside the interval.
    """
    low, high = within
    if isinstance(values, int):
        if values < 1:
            raise ValueError(f"values = {values}: give how many, 1 or more, or a list of values")
        inner = (np.arange(values) + 0.5) / values
        return [float(low + (high - low) * t) for t in inner]
    numbers = sorted({float(v) for v in list(values)})
    if not numbers:
        raise ValueError("values = []: give at least one, or how many")
    for v in numbers:
        if not low <= v <= high:
            raise ValueError(
                f"values: {v:g} lies outside the interval [{low:g}, {high:g}]; leave it out, or widen it"
            )
    return numbers


def join(run: Run, found: Sequence[Counted]) -> None:
    """Give each attractor the label of its branch; what lies on none is traced first, with all that leaves it."""
    for counted in found:
        attractor = counted.attractor
        if counted.problem is None or counted.u is None:
            continue
        label = locate(run, counted)
        if label is None:
            try:
                begin(run, counted.problem, counted.u, attractor.value)
            except ValueError as refusal:
                run.tell(f"a start at {attractor.value:.6g} is left: {refusal}", attractor.value)
                continue
            work(run)
            label = locate(run, counted)
        attractor.branch = label
        if label is not None:  # one motion, one spelling of its word
            attractor.word = str(run.graph.branches[label].description.get("word", attractor.word))


def locate(run: Run, counted: Counted) -> str | None:
    """Label of the branch of the graph on which an attractor lies, exactly; None if it lies on none."""
    known = run.register.find(counted.problem, np.asarray(counted.u), counted.attractor.value)
    return None if known is None else known.label


def _at(run: Run, population: Population, p: float, starts: int, seed: int) -> list[Counted]:
    run.tell(f"{starts} starts at {population.parameter} = {p:.6g}", p)
    found = census(population, p, starts, seed, run.journal)
    join(run, found)
    return found


def _beyond(graph: Graph, where: Sequence[float]) -> list[float]:
    """Values just outside the stable stretches of all real branches, where none of `where` is near."""
    low, high = graph.within
    step = BEYOND * (high - low)
    spacing = (high - low) / max(len(where), 1)
    asked: list[float] = []
    for branch in graph.branches.values():
        if not branch.real:
            continue
        for first, last in branch.stable_intervals():
            for p in (first - step, last + step):
                near = min((abs(p - v) for v in (*where, *asked)), default=np.inf)
                if low <= p <= high and near > 0.1 * spacing and len(asked) < MOST_EXTRA:
                    asked.append(float(p))
    return sorted(asked)
