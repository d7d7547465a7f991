"""Censuses: many starts at one value of the parameter and the motions that they reach; joining these motions to a graph."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Protocol, TypeVar, runtime_checkable

import numpy as np

from ..continuation.settings import Settings
from ..graph import Graph
from ..graph.builder import adopt, begin, trace_pending, work
from ..graph.contents import Attractor
from ..graph.run import NO_LIMITS, Limits, Run
from ..graph.table import short_word
from ..journal import Journal, NullJournal
from ..problems.abilities import Populated, Population
from ..problems.protocol import Problem
from ..shared.motions import Motion

UNBRANCHED = ("chaotic", "quasi-periodic", "chatter")  # kinds of motion that lie on no branch
Found = TypeVar("Found")
Solution = tuple[Problem, np.ndarray]


@runtime_checkable
class _Orbit(Protocol):
    """A solution with a method that returns its problem."""

    def problem(self, over: str | None) -> object: ...


def population_of(thing: object, over: str | None = None, **parameters: float) -> Population:
    """Return the population of a machine, an orbit or a problem; a population is returned unchanged.

    Raises
    ------
    ValueError
        If it has no population, or the parameter is unknown.
    """
    if isinstance(thing, Population):
        return thing
    if not isinstance(thing, Populated) and isinstance(thing, _Orbit) and callable(thing.problem):
        thing = thing.problem(over)
    if not isinstance(thing, Populated):
        raise ValueError(
            f"{type(thing).__name__} cannot be simulated from many starts: give a machine, one of its orbits, or a map"
        )
    return thing.population(over, **parameters)


# ------------------------------------------------------------------ what starts settle on
@dataclass
class CountedMotion:
    """A motion found by simulation.

    Attributes
    ----------
    attractor : Attractor
    problem, u : Problem and float array, or None
        A solution that can be continued; None if the motion lies on no branch.
    state : float array, optional
        A state on the motion.
    """

    attractor: Attractor
    problem: Problem | None
    u: np.ndarray | None
    state: np.ndarray | None = None


def census(population: Population, p: float, count: int, seed: int, journal: Journal) -> list[CountedMotion]:
    """Draw starts, simulate them, and return the motions reached with their shares; a census in the journal is not simulated again.

    Parameters
    ----------
    population : Population
    p : float
        Value of the parameter.
    count, seed : int
        Number and random seed of the starts.
    journal : Journal
    """
    key = f"census/{p!r}/{count}/{seed}"
    return _settled(population, p, lambda: population.starts(count, seed, p), key, journal)


def motions_from(
    population: Population, p: float, starts: np.ndarray, key: str, journal: Journal
) -> list[CountedMotion]:
    """Simulate given starts and return the motions reached, with share 0: chosen starts say nothing about shares.

    Parameters
    ----------
    population : Population
    p : float
        Value of the parameter.
    starts : float array (m, n)
    key : str
        Key in the journal.
    journal : Journal
    """
    found = _settled(population, p, lambda: starts, key, journal)
    for counted in found:
        counted.attractor = replace(counted.attractor, share=0.0, mirror_share=0.0, starts=0)
    return found


def _settled(
    population: Population, p: float, starts_of: Callable[[], np.ndarray], key: str, journal: Journal
) -> list[CountedMotion]:
    """Return the motions on which starts settle, with their shares, from the journal or by simulation of ``starts_of()``."""

    def simulated() -> list[CountedMotion]:
        motions, index, mirrored = population.settle(starts_of(), p)
        attractors = attractors_of(motions, index, mirrored, p)
        return [CountedMotion(a, m.problem, m.u, m.state) for a, m in zip(attractors, motions, strict=True)]

    def recalled(record: Mapping[str, Any]) -> list[CountedMotion] | None:
        """Return the recorded motions; None if a problem needs user functions that are not available."""
        found = []
        for k, description in enumerate(record["problems"]):
            fields = {name: record[name][k] for name in ("word", "periods", "kind", "starts")}
            fields |= {name: float(record[name][k]) for name in MEASURED}
            u = record.get(f"u{k}")
            problem = None if description is None or u is None else population.restored(description, u, p)
            if description is not None and problem is None:
                return None
            found.append(
                CountedMotion(Attractor(float(p), branch=None, **fields), problem, u, record.get(f"state{k}"))
            )
        return found

    return recorded_or_computed(population, key, journal, simulated, _record, recalled)


MEASURED = ("share", "mirror_share", "exponent", "error")


def _record(found: Sequence[CountedMotion]) -> dict[str, Any]:
    """Return the journal's record of a census."""
    record: dict[str, Any] = {
        "problems": [None if c.problem is None else dict(c.problem.describe()) for c in found]
    }
    for name in ("word", "kind", "periods", "starts"):
        record[name] = [getattr(c.attractor, name) for c in found]
    for name in MEASURED:
        record[name] = np.array([getattr(c.attractor, name) for c in found])
    for name in ("u", "state"):
        parts = ((k, getattr(c, name)) for k, c in enumerate(found))
        record |= {f"{name}{k}": np.asarray(part, dtype=float) for k, part in parts if part is not None}
    return record


def recorded_or_computed(
    population: Population,
    key: str,
    journal: Journal,
    make: Callable[[], Found],
    record: Callable[[Found], dict[str, Any]],
    recall: Callable[[Mapping[str, Any]], Found | None],
) -> Found:
    """Return a result from the journal, or compute and record it; the work that it took is counted in both cases.

    Parameters
    ----------
    population : Population
        Its `work` is increased.
    key : str
        Key in the journal.
    journal : Journal
    make : callable
        Computes the result.
    record : callable
        Returns the journal's record of a result.
    recall : callable
        Returns the result of a record; None if it cannot be rebuilt.
    """
    record_found = journal.recall(key)
    found = None if record_found is None else recall(record_found)
    if record_found is not None and found is not None:
        population.work += float(record_found.get("work", 0.0))
        return found
    before = population.work
    found = make()
    journal.record(key, {**record(found), "work": population.work - before})
    return found


def attractors_of(
    motions: Sequence[Motion[Problem]], index: np.ndarray, mirrored: np.ndarray, p: float
) -> list[Attractor]:
    """Return the motions on which starts have settled as attractors with shares; arguments as ``Population.settle`` returns them."""
    return [
        Attractor(
            float(p), m.word, int(m.periods), m.kind, None, float((index == k).mean()),
            float(((index == k) & mirrored).mean()), index.size, float(m.exponent), float(m.error),
        )
        for k, m in enumerate(motions)
    ]  # fmt: skip


# ------------------------------------------------------------------ joined to a graph
def locate(run: Run, counted: CountedMotion) -> str | None:
    """Return the label of the branch on which a motion lies (to solver accuracy); None if it lies on none."""
    if counted.problem is None:
        return None
    branch = run.register.find(counted.problem, np.asarray(counted.u), counted.attractor.value)
    return None if branch is None else branch.label


def join(run: Run, found: Sequence[CountedMotion], depth: int = 0) -> int:
    """Set the branch label of each attractor; a motion that lies on no branch is first traced with the branches that leave it.

    Parameters
    ----------
    run : Run
    found : sequence of CountedMotion
    depth : int
        Depth that the new roots count as: number of switches from the first branch.

    Returns
    -------
    int
        Number of branches added.
    """
    before = len(run.graph.branches)
    for counted in found:
        attractor = counted.attractor
        if counted.problem is None or counted.u is None:
            continue
        label = locate(run, counted)
        if label is None:
            try:
                add_root(run, counted.problem, counted.u, attractor.value, depth)
            except ValueError as refusal:
                run.tell(f"a start at {attractor.value:.6g} is left: {refusal}", attractor.value)
                continue
            label = locate(run, counted)
        attractor.branch = label
        if label is not None:  # the branch's spelling of the cyclic word
            attractor.word = str(run.graph.branches[label].description.get("word", attractor.word))
    return len(run.graph.branches) - before


def add_root(run: Run, problem: Problem, u: np.ndarray, p: float, depth: int = 0) -> None:
    """Trace the branch of a solution, and the branches that leave it.

    Once `max_branches` or `max_unknowns` is reached, only the root's own branch is traced: these limits do not apply to roots. Nothing
    is traced if the budget of an atlas has left branches waiting: these come first in a run with a larger budget.

    Parameters
    ----------
    run : Run
    problem, u, p
        The solution.
    depth : int
        Depth that the root counts as: number of switches from the first branch.

    Raises
    ------
    ValueError
        If continuation cannot start there; see :func:`contvines.graph.builder.begin`.
    """
    if run.queue and run.graph.complete:
        return
    begin(run, problem, u, p, depth)
    if run.graph.complete:
        work(run)
    else:
        trace_pending(run, run.queue.pop())


def run_on(graph: Graph, depth: int = 0, virtual: bool = True, limits: Limits = NO_LIMITS) -> Run:
    """Return a run that extends a graph, with the graph's branches registered and the settings that made it."""
    run = Run(graph, Settings.kept(graph.settings), NullJournal(), depth, virtual, None, None, limits)
    adopt(run)
    return run


# ------------------------------------------------------------------ after a diagram
def look(graph: Graph, population: Population) -> list[Attractor]:
    """Search briefly for attractors that lie on no branch of a graph; they are returned and stored as ``graph.missing``.

    Parameters
    ----------
    graph : Graph
        With its problems attached.
    population : Population
        Its `brief` gives the numbers of values and starts.
    """
    run, (low, high) = run_on(graph), graph.within
    found: list[Attractor] = []
    values, starts = population.brief
    for t in (np.arange(values) + 0.5) / values:
        for counted in census(population, float(low + (high - low) * t), starts, 0, run.journal):
            attractor = counted.attractor
            if attractor.kind not in ("slow", "escaped", "stopped") and locate(run, counted) is None:
                found.append(attractor)
    graph.missing, graph.looked = found, True
    return found


def missing_text(graph: Graph, study: str) -> str:
    """Describe the attractors in ``graph.missing`` in one line, with the command that adds them; empty if there are none.

    Parameters
    ----------
    graph : Graph
    study : str
        Name of the study's file.
    """
    best: dict[tuple[str, int, str], Attractor] = {}
    for attractor in sorted(graph.missing, key=lambda attractor: -attractor.share):
        best.setdefault((attractor.word, attractor.periods, attractor.kind), attractor)
    if not best:
        return ""
    names = [
        f"{short_word(attractor.name)} ({attractor.share:.0%} of starts at {graph.parameter} = {attractor.value:.6g})"
        for attractor in list(best.values())[:3]
    ]
    more = f" and {len(best) - 3} more" if len(best) > 3 else ""
    found = f"simulation also finds {', '.join(names)}{more}, "
    if all(attractor.kind in UNBRANCHED for attractor in best.values()):
        return f"{found}which no branch can hold"
    return (
        f"{found}not on any branch; run contvines atlas {study} to add {'it' if len(best) == 1 else 'them'}"
    )
