"""One system of a survey: protocols of its family, its seed, its diagram and its outcomes. Worker processes run `work`."""

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
"""(values, near) -> seed of the diagram of the system with these parameter values; `near` is its entry of `Carrying.starts`, or None."""


@runtime_checkable
class Carrying(Protocol):
    """A family that finds the seed of a system from a solution of a neighbour; ``starts`` returns one start per system, None for a system without."""

    def starts(
        self, systems: Sequence[Mapping[str, float]], neighbours: Sequence[int | None]
    ) -> Sequence[object]: ...


@runtime_checkable
class Simulating(Protocol):
    """A family that can simulate a system, from `starts` starts at each of the values `at` of the parameter `over`."""

    def simulated(
        self, values: Mapping[str, float], over: str, at: Sequence[float], starts: int
    ) -> Sequence[Simulated]: ...


@runtime_checkable
class Sweeping(Protocol):
    """A family that computes the responses of a system by simulation alone; ``swept`` returns pairs of a value of the parameter `over` and the response there."""

    def swept(
        self, values: Mapping[str, float], over: str, at: Sequence[float]
    ) -> Sequence[tuple[float, float]]: ...


@dataclass(frozen=True)
class Job:
    """The settings that all systems of a survey share; sent to the worker processes.

    Attributes
    ----------
    family : callable
        ``family(values, near) -> seed`` of the system with these parameter values, found from a neighbour's solution (`near`, from
        ``family.near(seed)``) or, if `near` is None, independently.
    over, within
        The parameter of the diagrams and its interval.
    outcomes : tuple of callables
        ``outcome(found) -> {column: number}``; see `contvines.survey.outcomes`.
    gaps : int
        Smallest number of values at which the system is simulated in the gaps of its diagram (where no response is stable), if the
        family is `Simulating`. Modulated and chaotic motions lie there, and motions that are not connected to any branch.
    values, starts : int
        Number of further values, spread over the whole interval, at which the system is simulated, and number of starts at each.
    options : dict
        Arguments of `contvines.diagram`.
    atlas : mapping, optional
        Arguments of `contvines.atlas`; an atlas replaces the diagram, so that motions without connection to others are found, too.
    swept : int
        If positive and the family is `Sweeping`: number of values at which the system is simulated instead of computing a diagram; the
        outcomes are then ``peak`` and ``lower_peak``.
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
    """The outcomes of one system.

    Attributes
    ----------
    index : int
        Of the system in the plan.
    columns : dict
        Outcomes by name, ``covered`` always among them; empty if the system failed.
    note : str
        Reason of the failure, or the gaps in the results.
    """

    index: int
    columns: dict[str, float]
    note: str = ""


def work(job: Job, index: int, values: Mapping[str, float], near: object = None) -> Row:
    """Compute the row of one system; a failed system's row gives the reason in `note`.

    Parameters
    ----------
    job : Job
    index : int
        Of the system in the plan.
    values : mapping
        Its parameter values.
    near : object
        The start from its neighbour, or None.
    """
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
            open_ = gaps(graph) if population is None else []  # otherwise `complete` has simulated in them
            found = Findings(graph, seed, _simulated(job, values, open_), left)
            for outcome in (*job.outcomes, covered):
                columns |= {name: float(value) for name, value in outcome(found).items()}
            note = unknown(found)
    except (ValueError, ArithmeticError, KeyError, np.linalg.LinAlgError) as error:
        sentence = str(error.args[0]) if isinstance(error, KeyError) and error.args else str(error)
        return Row(index, {}, sentence or f"{type(error).__name__} without a word of why")
    return Row(index, columns, note)


def _swept(job: Job, family: Sweeping, values: Mapping[str, float]) -> dict[str, float]:
    """Return the outcomes by simulation alone: the largest response, and the largest over the values of the lowest response at each value."""
    grid = np.linspace(*job.within, job.swept).tolist()
    responses_at = [(p, x) for p, x in family.swept(values, job.over, grid) if np.isfinite(x)]
    lowest = {p: min(responses) for p in grid if (responses := [x for at, x in responses_at if at == p])}
    found = {"covered": len(lowest) / len(grid)}
    for name, motions in (("peak", responses_at), ("lower_peak", list(lowest.items()))):
        at, response = max(motions, key=lambda motion: motion[1], default=(np.nan, np.nan))
        found |= {name: response, f"{name}_at": at}
    return found


def _simulated(
    job: Job, values: Mapping[str, float], open_: Sequence[tuple[float, float]]
) -> list[Simulated]:
    """Return motions on which simulations settle, in the gaps `open_` and at the further values of the job."""
    if not isinstance(job.family, Simulating):
        return []
    found = []
    if places := spread(open_, job.within, job.gaps):
        found += job.family.simulated(values, job.over, places, 1)
    if job.values:
        places = np.linspace(*job.within, job.values + 2)[1:-1].tolist()
        found += job.family.simulated(values, job.over, places, job.starts)
    return found
