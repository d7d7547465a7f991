"""One system of a survey: what is asked of its family, its start, its diagram, and what comes out of it. This is what worker processes run."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol, runtime_checkable

import numpy as np

from ..coexistence.build import atlas
from ..coexistence.census import population_of
from ..graph.automatic import diagram
from ..graph.stretches import gaps, spread
from .completion import complete
from .outcomes import Findings, Outcome, Simulated, covered, unknown

NOT_YET = "not done yet: the survey was interrupted"  # note of a row
Family = Callable[[Mapping[str, float], Any], object]
"""(values, near) -> the system with these values and a solution of it to begin with; `near` is what `Carrying.starts` had of it, or None."""


@runtime_checkable
class Carrying(Protocol):
    """A family whose solutions begin with those of neighbours: one entry for each system, None where it begins by itself."""

    def starts(
        self, systems: Sequence[Mapping[str, float]], neighbours: Sequence[int | None]
    ) -> Sequence[object]: ...


@runtime_checkable
class Simulating(Protocol):
    """A family that simulates a system, from so many starts at each of some values of the parameter `over`."""

    def simulated(
        self, values: Mapping[str, float], over: str, at: Sequence[float], starts: int
    ) -> Sequence[Simulated]: ...


@runtime_checkable
class Sweeping(Protocol):
    """A family that tells the responses of a system by simulation alone: values of the parameter `over`, and a measure there."""

    def swept(
        self, values: Mapping[str, float], over: str, at: Sequence[float]
    ) -> Sequence[tuple[float, float]]: ...


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
        modulated and chaotic motions, and those that are not connected to any branch.
    values, starts : int
        At how many values of the interval it is simulated besides, and from how many starts each.
    options : dict
        Of `contvines.diagram`.
    atlas : mapping, optional
        Of `contvines.atlas`: with it an atlas of each system is made, so that motions count that are not connected to others.
    swept : int
        At so many values each system is simulated in place of a diagram, if the family can; the outcomes are then ``peak`` and ``lower_peak``.
    """

    family: Family
    over: str
    within: tuple[float, float]
    outcomes: tuple[Outcome, ...]
    gaps: int = 5
    values: int = 0
    starts: int = 1
    options: Mapping[str, Any] = field(default_factory=dict)
    atlas: Mapping[str, Any] | None = None
    swept: int = 0


@dataclass(frozen=True)
class Row:
    """What came out of one system.

    Attributes
    ----------
    index : int
    columns : dict
        Numbers by name, ``covered`` always among them; empty where the system failed.
    note : str
        Why it failed, or what is not known of it, as a sentence.
    """

    index: int
    columns: dict[str, float]
    note: str = ""


def work(job: Job, index: int, values: Mapping[str, float], near: object = None) -> Row:
    """The outcomes of one system; a system that fails is a row with its sentence."""
    columns: dict[str, float] = {}
    try:
        with np.errstate(all="ignore"):
            if job.swept and isinstance(job.family, Sweeping):
                return Row(index, _swept(job, job.family, values))
            seed = job.family(values, near)
            make, more = (diagram, {}) if job.atlas is None else (atlas, job.atlas)
            graph = make(seed, over=job.over, within=job.within, **job.options, **more)
            try:
                population = population_of(seed, job.over)
            except ValueError:  # equations that cannot be simulated from many starts
                population = None
            left = [] if population is None else complete(graph, population, job.gaps)
            open_ = gaps(graph) if population is None else []  # else they are looked at already
            found = Findings(graph, seed, _simulated(job, values, open_), left)
            for outcome in (*job.outcomes, covered):
                columns |= {name: float(value) for name, value in outcome(found).items()}
            note = unknown(found)
    except (ValueError, ArithmeticError, KeyError, np.linalg.LinAlgError) as error:
        sentence = str(error.args[0]) if isinstance(error, KeyError) and error.args else str(error)
        return Row(index, {}, sentence or f"{type(error).__name__} without a word of why")
    return Row(index, columns, note)


def _swept(job: Job, family: Sweeping, values: Mapping[str, float]) -> dict[str, float]:
    """The largest response by simulation alone, and the largest if at each value the lowest is met that was seen there."""
    grid = np.linspace(*job.within, job.swept).tolist()
    seen = [(p, x) for p, x in family.swept(values, job.over, grid) if np.isfinite(x)]
    lowest = {p: min(responses) for p in grid if (responses := [x for at, x in seen if at == p])}
    found = {"covered": len(lowest) / len(grid)}
    for name, motions in (("peak", seen), ("lower_peak", list(lowest.items()))):
        at, response = max(motions, key=lambda motion: motion[1], default=(np.nan, np.nan))
        found |= {name: response, f"{name}_at": at}
    return found


def _simulated(
    job: Job, values: Mapping[str, float], open_: Sequence[tuple[float, float]]
) -> list[Simulated]:
    """Motions on which simulations settle: in the gaps `open_`, and where else it is asked for."""
    if not isinstance(job.family, Simulating):
        return []
    found = []
    if places := spread(open_, job.within, job.gaps):
        found += job.family.simulated(values, job.over, places, 1)
    if job.values:
        places = np.linspace(*job.within, job.values + 2)[1:-1].tolist()
        found += job.family.simulated(values, job.over, places, job.starts)
    return found
