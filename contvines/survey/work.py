"""One system of a survey: its start, its diagram, and what comes out of it. This is what worker processes run."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from .outcomes import Findings, gaps

OVER_ALL = 40  # values over the whole interval, where a diagram has next to nothing of it
LEAST = 1e-3  # of the interval: shorter gaps are left alone


@dataclass(frozen=True)
class Job:
    """What all systems of a survey share; it is sent to the workers.

    Attributes
    ----------
    family : callable
        ``family(values, near) -> seed``: the system with these values and a solution of it to begin with, from that of a
        neighbour (`near`, from ``family.near(seed)``) or, with None, by itself.
    over, within : the continuation.
    outcomes : tuple of callables
        ``outcome(found) -> {column: number}``; see `contvines.survey.outcomes`.
    gaps : int
        At how many values, at least, the system is simulated where its diagram has no stable response, if the family can: there lie
        modulated and chaotic motions, and those that hang together with no branch.
    values, starts : int
        At how many values of the interval it is simulated besides, and from how many starts each.
    options : dict
        Of `contvines.diagram`.
    atlas : mapping, optional
        Of `contvines.atlas`: with it an atlas of each system is made, so that motions count that hang together with nothing else.
    """

    family: Callable[[Mapping[str, float], Any], Any]
    over: str
    within: tuple[float, float]
    outcomes: tuple[Callable[[Any], Mapping[str, float]], ...]
    gaps: int = 5
    values: int = 0
    starts: int = 1
    options: dict[str, Any] = field(default_factory=dict)
    atlas: Mapping[str, Any] | None = None


@dataclass(frozen=True)
class Row:
    """What came out of one system.

    Attributes
    ----------
    index : int
    columns : dict
        Numbers by name; empty where the system failed.
    note : str
        Why it failed, as a sentence.
    """

    index: int
    columns: dict[str, float]
    note: str = ""


def work(job: Job, index: int, values: Mapping[str, float], near: Any = None) -> Row:
    """The outcomes of one system; a system that fails is a row with its sentence."""
    columns: dict[str, float] = {}
    try:
        with np.errstate(all="ignore"):
            seed = job.family(values, near)
            graph = _graph(job, seed)
            found = Findings(graph, seed, _simulated(job, values, graph))
            for outcome in job.outcomes:
                columns |= {name: float(value) for name, value in outcome(found).items()}
    except (ValueError, ArithmeticError, KeyError, np.linalg.LinAlgError) as error:
        sentence = str(error.args[0]) if isinstance(error, KeyError) and error.args else str(error)
        return Row(index, {}, sentence or f"{type(error).__name__} without a word of why")
    return Row(index, columns)


def _graph(job: Job, seed: Any) -> Any:
    """The diagram of a system, or its atlas."""
    from ..coexistence.build import atlas
    from ..graph.automatic import diagram

    if job.atlas is None:
        return diagram(seed, over=job.over, within=job.within, **job.options)
    return atlas(seed, over=job.over, within=job.within, **job.options, **job.atlas)


def _simulated(job: Job, values: Mapping[str, float], graph: Any) -> list[Any]:
    """Motions that simulations settle on: in the gaps of the diagram, and where else it is asked for."""
    simulate = getattr(job.family, "simulated", None)
    if simulate is None:
        return []
    found = []
    open_ = [(low, high) for low, high in gaps(graph) if high - low > LEAST * (job.within[1] - job.within[0])]
    if job.gaps and open_:
        length = sum(high - low for low, high in open_)
        count = max(job.gaps, int(np.ceil(OVER_ALL * length / (job.within[1] - job.within[0]))))
        places = np.linspace(0.0, length, count + 2)[1:-1]
        for low, high in open_:
            inside = [low + place for place in places if 0.0 <= place < high - low] or [0.5 * (low + high)]
            places = places - (high - low)
            found += simulate(values, job.over, inside, 1)
    if job.values:
        found += simulate(
            values, job.over, np.linspace(*job.within, job.values + 2)[1:-1].tolist(), job.starts
        )
    return found
