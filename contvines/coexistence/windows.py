"""Narrow windows of periodic motion, which few or no starts meet, reached by continuation from unstable cycles."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from ..branches import Branch
from ..graph import Graph
from ..graph.builder import begin, work
from ..graph.run import Run
from ..journal import Part
from ..problems.abilities import Population
from ..problems.protocol import Problem
from .census import CountedMotion, Solution, add_root, recorded_or_computed
from .effort import Effort
from .settings import ATLAS

CYCLES = "searches for unstable cycles"
MOST = 10_000  # largest number of branches traced in the search for windows


class Windows:
    """Search for windows: branches of unstable cycles are traced on a separate graph, and those that are stable somewhere are added to the atlas.

    With each added branch, the branches that leave it directly are added, too.

    Parameters
    ----------
    run : Run
        Of the atlas.
    population : Population
    apart : Run
        The run with the separate graph; see :func:`separate_run`.
    effort : Effort
        No search begins once its budget is used up.
    """

    def __init__(self, run: Run, population: Population, separate: Run, effort: Effort) -> None:
        self.run, self.population, self.separate, self.effort = run, population, separate, effort
        self.left = 0  # number of searches not begun or not completed

    def near_chaos(self, found: Sequence[CountedMotion]) -> None:
        """Search from the unstable cycles in chaotic motions.

        A window opens at a fold with a stable and an unstable cycle; the stable cycle doubles and ends in chaos, the unstable one
        persists in it (E. Ott, Chaos in Dynamical Systems, 2002, on periodic windows). Its branch therefore leads back, through the fold,
        into a window that may be too narrow for starts to meet.

        Parameters
        ----------
        found : sequence of CountedMotion
            Motions; those that are chaotic are used.
        """
        chaotic = [
            (c.state, c.attractor.value)
            for c in found
            if c.attractor.kind == "chaotic" and c.state is not None
        ]
        self.effort.expect(CYCLES, self.effort.waiting.get(CYCLES, 0) + len(chaotic))
        for state, p in chaotic:
            self._search(
                f"cycles/{p!r}",
                p,
                "unstable cycles in the chaos",
                partial(self.population.embedded, state, p),
            )

    def around(self, values: Sequence[float], count: int, seed: int) -> None:
        """Search from the cycles that Newton's method reaches from starts.

        Few starts settle on a motion with a narrow window; the unstable cycles on the same branch exist over a wider interval.

        Parameters
        ----------
        values : sequence of float
            Of the parameter.
        count, seed : int
            Number and random seed of the starts at each value.
        """
        population = self.population
        for p in values:
            self._search(
                f"cycles/{p!r}/{count}/{seed}",
                p,
                f"cycles from {count} starts",
                lambda p=p: population.returning(population.starts(count, seed, p), p),
            )

    def _search(self, key: str, p: float, name: str, cycles: Callable[[], Sequence[Solution]]) -> None:
        """Trace the cycles at a value and add the stable branches found to the atlas, unless the budget is used up."""
        if self.effort.over:
            self.left += 1
            return
        place = f"{self.population.parameter} = {p:.6g}"
        self.run.tell(f"{name} at {place}", p)

        def recalled(record: Mapping[str, Any]) -> list[Solution] | None:
            """Return the recorded cycles; None if a problem needs user functions that are not available."""
            found = []
            for k, description in enumerate(record["problems"]):
                problem = self.population.restored(description, record[f"u{k}"], p)
                if problem is None:
                    return None
                found.append((problem, record[f"u{k}"]))
            return found

        with self.effort.piece(CYCLES):
            found = recorded_or_computed(self.population, key, self.run.journal, cycles, _record, recalled)
            stable: list[tuple[Problem, np.ndarray, float]] = []
            for k, (problem, u) in enumerate(found):
                if self.effort.over:
                    self.left += 1
                    break
                if self.run.register.find(problem, u, p) is None:
                    message = f"cycle {k + 1} of {len(found)} at {place}: followed to where it is stable"
                    self.run.tell(message, p)
                    stable += self._traced(problem, u, p)
            for problem, u, at in stable:
                if self.run.register.find(problem, u, at, True) is None:
                    add_root(self.run, problem, u, at, max(self.run.depth - 1, 0))

    def _traced(self, problem: Problem, u: np.ndarray, p: float) -> list[tuple[Problem, np.ndarray, float]]:
        """Trace a cycle on the separate graph, unless known there; return a point of each stable stretch of the new branches."""
        separate, (low, high) = self.separate, self.run.graph.within
        if separate.register.find(problem, u, p) is not None:
            return []
        count = len(separate.graph.branches)
        try:
            begin(separate, problem, u, p)
            work(separate)
        except ValueError:  # the cycle is real only within rounding errors
            return []
        return [
            (branch.attached, branch.points[i], float(branch.values[i]))
            for branch in list(separate.graph.branches.values())[count:]
            if branch.real
            for i in _middles(branch, ATLAS.narrow * (high - low))
        ]


def _record(cycles: Sequence[Solution]) -> dict[str, Any]:
    """Return the journal's record of cycles."""
    parts = {f"u{k}": np.asarray(u, dtype=float) for k, (_, u) in enumerate(cycles)}
    return {"problems": [problem.describe() for problem, _ in cycles], **parts}


def separate_run(run: Run) -> Run:
    """Return a run with a separate graph, for branches that another run traces without adding them to its graph."""
    whole = run.graph
    graph = Graph(
        parameter=whole.parameter, model=whole.model, within=whole.within, settings=dict(whole.settings)
    )
    settings = replace(run.settings, max_branches=MOST)
    return Run(graph, settings, Part(run.journal, "apart/"), 0, False, None, None, run.limits)


def _middles(branch: Branch, narrowest: float) -> Iterator[int]:
    """Yield for every stable stretch, unless narrower than `narrowest`, the index of the point nearest to its middle."""
    for low, high in branch.stable_intervals():
        if high - low < narrowest:
            continue
        inside = np.flatnonzero((branch.values >= low) & (branch.values <= high) & np.asarray(branch.stable))
        if inside.size:
            yield int(inside[np.argmin(np.abs(branch.values[inside] - 0.5 * (low + high)))])
