"""Loci of motions that are born at a point of codimension two: cycles of twice the period, cycles beside an equilibrium."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..continuation.engine import Engine
from ..continuation.settings import Settings
from ..flows.cycles import CycleProblem
from ..problems.abilities import Adaptive
from ..problems.protocol import Problem
from .linear import Linearisation
from .plane_point import PlanePoint
from .starts import begin

DOUBLED, SMALL = "doubled", "small"  # cycles of twice the period, cycles beside an equilibrium

#: kind of a point -> what is born there, and the kind of the locus that begins there
BORN = {
    "generalized-period-doubling": (DOUBLED, "fold"),
    "generalized-hopf": (SMALL, "fold"),
    "zero-hopf": (SMALL, "neimark-sacker"),
    "double-hopf": (SMALL, "neimark-sacker"),
}
#: likewise, of cycles of flows
BORN_OF_CYCLES = {
    "resonance-1-2": (DOUBLED, "neimark-sacker"),
    "fold-flip": (DOUBLED, "neimark-sacker"),
}
AMPLITUDES = (0.05, 0.02, 0.1, 0.005)  # of the motion at which its special point is looked for


AMPLITUDES_OF_CYCLES = (
    0.1,
    0.2,
    0.05,
    0.4,
)  # likewise of flows; where they are smaller the tests are all but zero


@dataclass(frozen=True, eq=False)
class Candidate:
    """A special point at (p, q) from which a locus may be traced; ``index`` is that of the margin at a border."""

    problem: Problem
    kind: str
    u: np.ndarray
    p: float
    q: float
    index: int
    seed: str


class Child(NamedTuple):
    """A problem in which the motion at a point is a branch point, its unknowns there, and the direction in which others leave."""

    problem: Problem
    u: np.ndarray
    direction: np.ndarray


def born(
    point: PlanePoint, bounds: tuple[float, float], over: str, within: tuple[float, float]
) -> list[Candidate]:
    """Starts of the loci of what is born at a point."""
    table = BORN | BORN_OF_CYCLES if isinstance(point.attached, Adaptive) else BORN
    if point.kind not in table:
        return []
    what, kind = table[point.kind]
    found = []
    for child in _doubled(point) if what == DOUBLED else _small(point):
        start = _started(child, kind, point, bounds, over, within)
        if start is not None:
            found.append(start)
    return found


def _doubled(point: PlanePoint) -> Iterator[Child]:
    problem, (p, _) = point.attached, point.value
    line = Linearisation(problem)
    line.at(point.u, p)
    right = line.null_vectors(flipped=True).right
    for child in problem.offspring(problem.flip_kind, point.u, p, np.append(right, 0.0), -1.0 + 0.0j)[:1]:
        states = problem.states if isinstance(problem, CycleProblem) else len(point.u)
        direction = np.asarray(child.tangent, dtype=float)[:-1].copy()
        direction[states : 2 * states] *= -1.0
        direction[2 * states :] = 0.0
        yield Child(child.problem, np.asarray(child.u, dtype=float), direction)


def _small(point: PlanePoint) -> Iterator[Child]:
    u = np.asarray(point.u, dtype=float)
    for child in point.attached.offspring("hopf", u, point.value[0], np.zeros(len(u) + 1), 1j):
        yield Child(
            child.problem, np.asarray(child.u, dtype=float), np.asarray(child.tangent, dtype=float)[:-1]
        )


def _started(
    child: Child,
    kind: str,
    point: PlanePoint,
    bounds: tuple[float, float],
    over: str,
    within: tuple[float, float],
) -> Candidate | None:
    """A special point of this kind of a motion of a given small amplitude."""
    p, q = point.value
    units = Linearisation(child.problem).units
    cycles = isinstance(child.problem, Adaptive)  # of a flow: many unknowns, of which the largest counts
    direction = child.direction / np.linalg.norm(child.direction / units, np.inf if cycles else 2)
    n = len(direction)
    for amplitude in AMPLITUDES_OF_CYCLES if cycles else AMPLITUDES:
        size = amplitude * (1.0 + float(np.abs(child.u / units).max()))
        guess = child.u + size * direction
        locus = begin(child.problem, kind, guess, p, over, 0, bounds)
        engine = Engine(locus, within, Settings())
        border = np.zeros(locus.dimension + 1)
        border[:n] = direction / units**2
        solved = engine.solve(locus.joined(guess, p), q, border, float(border[:n] @ guess))
        if solved is None or np.abs((solved.u[:n] - guess) / units).max() > 10.0 * size:
            continue
        value = float(locus.split(solved.u)[1])
        return Candidate(locus.at(solved.p), kind, solved.u[:n], value, solved.p, 0, point.label)
    return None
