"""Motions that a chart knows from continuation, carried to a place of the plane: what is stable there by its multipliers and margins.

A simulation from a few starts may miss a motion with a small basin. What the graph and the loci have is therefore continued to the
place, in straight steps of both parameters, and counts as found where it is stable and admissible and a simulation of one period agrees.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..branches.branch import Branch
from ..continuation.engine import Engine
from ..continuation.layout import MARGIN, Solved
from ..continuation.settings import Settings
from ..problems.abilities import Attracting
from .layout import BRANCH, FOLD
from .locus import Locus
from .settings import VANISHING

if TYPE_CHECKING:
    from ..problems.protocol import Problem


STEPS = (1, 6, 24)  # on the way to the place
NEAREST = 3  # starts of one word that are tried


class Start(NamedTuple):
    """A motion at (p, q), and the key of its word."""

    problem: Problem
    u: np.ndarray
    p: float
    q: float
    key: str


class KnownMotions:
    """Stable motions of a graph and regular ones on loci, as starts.

    Parameters
    ----------
    branches : iterable of Branch
        At one value of the second parameter.
    loci : iterable of Locus
    over : str
        The second parameter.
    within : (interval, interval)
        Of both parameters.
    """

    def __init__(
        self,
        branches: Iterable[Branch],
        loci: Iterable[Locus],
        over: str,
        within: tuple[tuple[float, float], tuple[float, float]],
    ) -> None:
        self.over, self.within = over, within
        self.starts = [start for branch in branches for start in self._of_branch(branch)]
        self.starts += [start for locus in loci for start in self._of_locus(locus)]

    def _of_branch(self, branch: Branch) -> list[Start]:
        problem = branch.problem
        if problem is None or not branch.real or not _can_be_listed(problem):
            return []
        q, key, found = problem.parameters[self.over], _key(problem, branch.label), []
        for first, last, stable in branch.pieces():
            if stable:
                for i in sorted({first, (first + last) // 2, last}):
                    found.append(Start(problem, branch.points[i], float(branch.values[i]), q, key))
        return found

    def _of_locus(self, locus: Locus) -> list[Start]:
        problem = locus.problem
        if problem is None or problem.condition in (FOLD, BRANCH) or not _can_be_listed(problem.base):
            return []
        key, found = _key(problem.base, locus.label), []
        for i in np.linspace(0, len(locus) - 1, 12).astype(int):
            u, p = problem.split(locus.branch.points[i])
            found.append(Start(problem.base, u, float(p), float(locus.branch.values[i]), key))
        return found

    def at(self, place: tuple[float, float]) -> list[dict[str, Any]]:
        """The motions that are stable at (p, q), each word once."""
        (plow, phigh), (qlow, qhigh) = self.within
        found: dict[str, dict[str, Any]] = {}
        tried: dict[str, int] = {}

        def far(start: Start) -> float:
            return max(abs(start.p - place[0]) / (phigh - plow), abs(start.q - place[1]) / (qhigh - qlow))

        for start in sorted(self.starts, key=far):
            if start.key in found or tried.get(start.key, 0) >= NEAREST:
                continue
            tried[start.key] = tried.get(start.key, 0) + 1
            entry = self._carried(start, place)
            if entry is not None:
                found[start.key] = entry
        return list(found.values())

    def _carried(self, start: Start, place: tuple[float, float]) -> dict[str, Any] | None:
        for steps in STEPS:
            reached = self._followed(start, place, steps)
            if reached is None:
                continue
            engine, solved = reached
            if not _counts(engine, solved):
                return None
            problem, u, p = engine.problem, solved.u, solved.p
            deviation = problem.replay(u, p)
            if deviation is not None and not deviation < Settings.same:
                return None
            while (smaller := problem.root(u, p)) is not None:
                problem, u = smaller
            if problem is not engine.problem and not self._holds(problem, u, p):
                return None
            return problem.attractor(u, p) if isinstance(problem, Attracting) else None
        return None

    def _holds(self, problem: Problem, u: np.ndarray, p: float) -> bool:
        """Whether what a motion only repeats is one: a cycle whose period has gone to zero stays at a state where nothing need rest."""
        engine = Engine(problem, self.within[0], Settings())
        solved = engine.at_value(u, p)
        if solved is None or not _counts(engine, solved):
            return False
        far = np.abs(solved.u - u)
        return bool((far <= VANISHING.loose * np.maximum(np.abs(u), engine.scale[:-1])).all())

    def _followed(self, start: Start, place: tuple[float, float], steps: int) -> tuple[Engine, Solved] | None:
        """The motion of a start carried in so many equal steps to a place."""
        wide, reached, u = self.within[0][1] - self.within[0][0], None, start.u
        for share in np.arange(1, steps + 1) / steps:
            p = start.p + share * (place[0] - start.p)
            q = start.q + share * (place[1] - start.q)
            problem = start.problem.against(start.problem.parameter, {self.over: float(q)})
            engine = Engine(problem, (p - wide, p + wide), Settings())
            solved = engine.at_value(u, p)
            if solved is None:
                return None
            reached, u = (engine, solved), solved.u
        return reached


def _counts(engine: Engine, solved: Solved) -> bool:
    return bool(engine.stable(solved.row)) and float(engine.smallest_margin(solved.row)) > MARGIN


def _can_be_listed(problem: Problem) -> bool:
    """Whether a solution can be listed as `simulated_attractors` lists it; one without events is seen by any simulation."""
    about = problem.describe()
    return isinstance(problem, Attracting) and about.get("word") != ""


def _key(problem: Problem, label: str) -> str:
    """Equal for motions of one word; of what has no words every branch is tried."""
    about = problem.describe()
    if "word" not in about or "flow" in about:  # words of flows say "cycle" alone
        return label
    return f"{about.get('word')} {about.get('periods')} {bool(about.get('symmetric'))}"


def together(
    simulated: list[dict[str, Any]], known: list[dict[str, Any]], size: float = 0.0
) -> list[dict[str, Any]]:
    """What simulation found, and what it missed of the known ones; `size` is that of the unknowns, beside which rounding is zero."""
    result = list(simulated)
    for one in known:
        if not any(_one(one, other, size) for other in result):
            result.append(one)
    return result


def _one(a: dict[str, Any], b: dict[str, Any], unit: float) -> bool:
    if (a["word"], a["periods"]) != (b["word"], b["periods"]):
        return False
    if "u" not in a or "u" not in b:
        return True
    size = VANISHING.loose * max(float((np.abs(a["u"]) + np.abs(b["u"])).max()), unit)
    return bool(np.abs(np.subtract(a["u"], b["u"])).max() <= size)
