"""Windows of periodic motion that few or no starts meet, reached from the unstable cycles beside them."""

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
from .census import Counted, Solution, add_root, remembered
from .effort import Effort
from .settings import ATLAS

CYCLES = "searches for unstable cycles"
MOST = 10_000  # branches traced apart


class Windows:
    """Branches traced from unstable cycles, apart from the graph: only what is stable somewhere goes on it, with one generation of what leaves it.

    Parameters
    ----------
    run : Run
        Of the atlas.
    population : Population
    apart : Run
        On which they are traced; see :func:`run_apart`.
    effort : Effort
        Nothing is begun once it is over.
    """

    def __init__(self, run: Run, population: Population, apart: Run, effort: Effort) -> None:
        self.run, self.population, self.apart, self.effort = run, population, apart, effort
        self.left = 0  # searches that have not begun, or were not completed

    def beside(self, found: Sequence[Counted]) -> None:
        """Add to the graph the branches that are stable somewhere and hold an unstable cycle of a chaotic motion.

        A window opens at a fold with a stable and an unstable cycle; the stable one doubles and is lost in chaos, the unstable one
        lives on in it (E. Ott, Chaos in Dynamical Systems, 2002, on periodic windows). So it leads back, through the fold, into a window that may be too
        narrow for starts to meet.
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
        """Add to the graph the branches that are stable somewhere and hold a cycle that Newton's method reaches from starts.

        What settles on a narrow or rare motion is hard to meet; the cycles that its branch turns into, unstable ones, reach far beyond.
        """
        population = self.population
        for p in values:
            self._search(
                f"cycles/{p!r}/{count}/{seed}",
                p,
                f"cycles from {count} starts",
                lambda p=p: population.returning(population.starts(count, seed, p), p),
            )

    def _search(self, key: str, p: float, what: str, cycles: Callable[[], Sequence[Solution]]) -> None:
        """Add to the graph what cycles at a value lead to, unless the work is over."""
        if self.effort.over:
            self.left += 1
            return
        where = f"{self.population.parameter} = {p:.6g}"
        self.run.tell(f"{what} at {where}", p)

        def recalled(known: Mapping[str, Any]) -> list[Solution] | None:
            """None where their problems take functions that are not at hand."""
            found = []
            for k, description in enumerate(known["problems"]):
                problem = self.population.restored(description, known[f"u{k}"], p)
                if problem is None:
                    return None
                found.append((problem, known[f"u{k}"]))
            return found

        with self.effort.piece(CYCLES):
            found = remembered(self.population, key, self.run.journal, cycles, _record, recalled)
            stable: list[tuple[Problem, np.ndarray, float]] = []
            for k, (problem, u) in enumerate(found):
                if self.effort.over:
                    self.left += 1
                    break
                if self.run.register.find(problem, u, p) is None:
                    told = f"cycle {k + 1} of {len(found)} at {where}: followed to where it is stable"
                    self.run.tell(told, p)
                    stable += self._traced(problem, u, p)
            for problem, u, at in stable:
                if self.run.register.find(problem, u, at, True) is None:
                    add_root(self.run, problem, u, at, max(self.run.depth - 1, 0))

    def _traced(self, problem: Problem, u: np.ndarray, p: float) -> list[tuple[Problem, np.ndarray, float]]:
        """Trace a cycle unless it has been; a point of each stable stretch of what is new."""
        apart, (low, high) = self.apart, self.run.graph.within
        if apart.register.find(problem, u, p) is not None:
            return []
        known = len(apart.graph.branches)
        try:
            begin(apart, problem, u, p)
            work(apart)
        except ValueError:  # it is real within rounding only
            return []
        return [
            (branch.attached, branch.points[i], float(branch.values[i]))
            for branch in list(apart.graph.branches.values())[known:]
            if branch.real
            for i in _middles(branch, ATLAS.narrow * (high - low))
        ]


def _record(cycles: Sequence[Solution]) -> dict[str, Any]:
    """What a journal keeps of cycles."""
    parts = {f"u{k}": np.asarray(u, dtype=float) for k, (_, u) in enumerate(cycles)}
    return {"problems": [problem.describe() for problem, _ in cycles], **parts}


def run_apart(run: Run) -> Run:
    """A run of its own for branches that are traced apart from the graph of another one."""
    whole = run.graph
    graph = Graph(
        parameter=whole.parameter, model=whole.model, within=whole.within, settings=dict(whole.settings)
    )
    settings = replace(run.settings, max_branches=MOST)
    return Run(graph, settings, Part(run.journal, "apart/"), 0, False, None, None, run.limits)


def _middles(branch: Branch, narrowest: float) -> Iterator[int]:
    """For every stable stretch that is not narrower the point that is nearest to its middle."""
    for low, high in branch.stable_intervals():
        if high - low < narrowest:
            continue
        inside = np.flatnonzero((branch.values >= low) & (branch.values <= high) & np.asarray(branch.stable))
        if inside.size:
            yield int(inside[np.argmin(np.abs(branch.values[inside] - 0.5 * (low + high)))])
