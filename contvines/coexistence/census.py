"""A census: many starts at one value of the parameter, the motions that they reach, and how these are joined to a graph."""

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
    """A solution that hands out its problem."""

    def problem(self, over: str | None) -> object: ...


def population_of(thing: object, over: str | None = None, **parameters: float) -> Population:
    """The population of a machine, an orbit or a problem; a population is returned as it is.

    Raises
    ------
    ValueError
        If it has none, or no such parameter.
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
class Counted:
    """A motion that a census has met, ready to be joined to a graph; `state` lies on it."""

    attractor: Attractor
    problem: Problem | None
    u: np.ndarray | None
    state: np.ndarray | None = None


def census(population: Population, p: float, count: int, seed: int, journal: Journal) -> list[Counted]:
    """Draw starts, let them settle, count; what the journal remembers is not simulated again.

    Parameters
    ----------
    population : Population
    p : float
    count, seed : int
    journal : Journal
    """
    key = f"census/{p!r}/{count}/{seed}"
    return _settled(population, p, lambda: population.starts(count, seed, p), key, journal)


def followed(
    population: Population, p: float, starts: np.ndarray, key: str, journal: Journal
) -> list[Counted]:
    """Let starts settle that were not drawn: what they reach has no share.

    Parameters
    ----------
    population : Population
    p : float
    starts : float array (m, n)
    key : str
        Under which the journal remembers it.
    journal : Journal
    """
    found = _settled(population, p, lambda: starts, key, journal)
    for counted in found:
        counted.attractor = replace(counted.attractor, share=0.0, mirror_share=0.0, starts=0)
    return found


def _settled(
    population: Population, p: float, starts_of: Callable[[], np.ndarray], key: str, journal: Journal
) -> list[Counted]:
    """What starts settle on, with shares of them; the starts are made where the journal does not know."""

    def simulated() -> list[Counted]:
        motions, index, mirrored = population.settle(starts_of(), p)
        attractors = attractors_of(motions, index, mirrored, p)
        return [Counted(a, m.problem, m.u, m.state) for a, m in zip(attractors, motions, strict=True)]

    def recalled(known: Mapping[str, Any]) -> list[Counted] | None:
        """None where a problem takes functions of the user's that are not at hand."""
        found = []
        for k, description in enumerate(known["problems"]):
            own = {name: known[name][k] for name in ("word", "periods", "kind", "starts")}
            own |= {name: float(known[name][k]) for name in MEASURED}
            u = known.get(f"u{k}")
            problem = None if description is None or u is None else population.restored(description, u, p)
            if description is not None and problem is None:
                return None
            found.append(Counted(Attractor(float(p), branch=None, **own), problem, u, known.get(f"state{k}")))
        return found

    return remembered(population, key, journal, simulated, _record, recalled)


MEASURED = ("share", "mirror_share", "exponent", "error")


def _record(found: Sequence[Counted]) -> dict[str, Any]:
    """What a journal keeps of a census."""
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


def remembered(
    population: Population,
    key: str,
    journal: Journal,
    make: Callable[[], Found],
    record: Callable[[Found], dict[str, Any]],
    recall: Callable[[Mapping[str, Any]], Found | None],
) -> Found:
    """What a journal keeps under a key, with the work that it took; else it is made, and recorded.

    Parameters
    ----------
    population : Population
        Whose work is counted.
    key : str
    journal : Journal
    make : callable
    record : callable
        What is found -> what the journal keeps of it.
    recall : callable
        The reverse; None where it cannot be had.
    """
    known = journal.recall(key)
    found = None if known is None else recall(known)
    if known is not None and found is not None:
        population.work += float(known.get("work", 0.0))
        return found
    before = population.work
    found = make()
    journal.record(key, {**record(found), "work": population.work - before})
    return found


def attractors_of(
    motions: Sequence[Motion[Problem]], index: np.ndarray, mirrored: np.ndarray, p: float
) -> list[Attractor]:
    """What starts have settled on, with shares of them; see `contvines.problems.abilities.Population`."""
    return [
        Attractor(
            float(p), m.word, int(m.periods), m.kind, None, float((index == k).mean()),
            float(((index == k) & mirrored).mean()), index.size, float(m.exponent), float(m.error),
        )
        for k, m in enumerate(motions)
    ]  # fmt: skip


# ------------------------------------------------------------------ joined to a graph
def locate(run: Run, counted: Counted) -> str | None:
    """Label of the branch of the graph on which an attractor lies, exactly; None if it lies on none."""
    if counted.problem is None:
        return None
    known = run.register.find(counted.problem, np.asarray(counted.u), counted.attractor.value)
    return None if known is None else known.label


def join(run: Run, found: Sequence[Counted], depth: int = 0) -> int:
    """Give each attractor the label of its branch; what lies on none is traced first, with all that leaves it.

    Its branch counts as one that `depth` others lie before.

    Returns
    -------
    int
        How many roots were added.
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
        if label is not None:  # one motion, one spelling of its word
            attractor.word = str(run.graph.branches[label].description.get("word", attractor.word))
    return len(run.graph.branches) - before


def add_root(run: Run, problem: Problem, u: np.ndarray, p: float, depth: int = 0) -> None:
    """Trace a solution with all that leaves it; alone where `max_branches` or `max_unknowns`, which limit no roots, is reached.

    Not at all where the budget of an atlas has left branches waiting: these come first when a larger one goes on. Its branch counts as one that `depth` others lie before.

    Raises
    ------
    ValueError
        If it is no start; see :func:`contvines.graph.builder.begin`.
    """
    if run.queue and run.graph.complete:
        return
    begin(run, problem, u, p, depth)
    if run.graph.complete:
        work(run)
    else:
        trace_pending(run, run.queue.pop())


def run_on(graph: Graph, depth: int = 0, virtual: bool = True, limits: Limits = NO_LIMITS) -> Run:
    """A run that goes on with a graph, whose branches it knows, with the settings it was made with."""
    run = Run(graph, Settings.kept(graph.settings), NullJournal(), depth, virtual, None, None, limits)
    adopt(run)
    return run


# ------------------------------------------------------------------ after a diagram
def look(graph: Graph, population: Population) -> list[Attractor]:
    """Attractors that a few simulated starts reach and that lie on no branch of the graph; kept as ``graph.missing``.

    Parameters
    ----------
    graph : Graph
        With its problems.
    population : Population
    """
    run, (low, high) = run_on(graph), graph.within
    found: list[Attractor] = []
    values, starts = population.brief
    for t in (np.arange(values) + 0.5) / values:
        for counted in census(population, float(low + (high - low) * t), starts, 0, run.journal):
            about = counted.attractor
            if about.kind not in ("slow", "escaped", "stopped") and locate(run, counted) is None:
                found.append(about)
    graph.missing, graph.looked = found, True
    return found


def missing_text(graph: Graph, study: str) -> str:
    """What the look has found, in one line with the command that adds it; empty if nothing.

    No branch holds motions that do not repeat.
    """
    best: dict[tuple[str, int, str], Attractor] = {}
    for about in sorted(graph.missing, key=lambda about: -about.share):
        best.setdefault((about.word, about.periods, about.kind), about)
    if not best:
        return ""
    names = [
        f"{short_word(about.name)} ({about.share:.0%} of starts at {graph.parameter} = {about.value:.6g})"
        for about in list(best.values())[:3]
    ]
    more = f" and {len(best) - 3} more" if len(best) > 3 else ""
    found = f"simulation also finds {', '.join(names)}{more}, "
    if all(about.kind in UNBRANCHED for about in best.values()):
        return f"{found}which no branch can hold"
    return (
        f"{found}not on any branch; run contvines atlas {study} to add {'it' if len(best) == 1 else 'them'}"
    )
