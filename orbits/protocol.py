"""What an orbit problem hands to a continuation code: symmetries, larger problems, seeds of branches."""

from __future__ import annotations

from typing import Any, NamedTuple, Protocol

import numpy as np

from orbits.cycles.solution import Solution
from orbits.machines.base import Model
from orbits.words import Word


class CycleProblem(Protocol):
    """What borders ask of the problem of the cycles with one word (`orbits.problem.OrbitProblem`)."""

    model: Model
    word: Word
    periods: int
    parameter: str
    params: np.ndarray
    symmetric: bool
    length: int
    dimension: int
    shift: float
    n_multipliers: int
    n_margins: int
    data: Any
    equations: Any

    @property
    def spelling(self) -> str: ...

    @property
    def scratch(self) -> Any: ...

    def values(self, p: Any) -> np.ndarray: ...

    def value(self, params: np.ndarray) -> float: ...

    def reduce(self, nodes: np.ndarray) -> np.ndarray: ...

    def expand(self, u: np.ndarray) -> np.ndarray: ...

    def orbit(self, u: np.ndarray, p: float) -> Solution: ...

    def sibling(self, word: Word, periods: int, symmetric: bool, params: np.ndarray | None = None) -> Any: ...


class Symmetry(NamedTuple):
    """An image of a solution that solves the same problem; `root` reduces a solution that is its own image."""

    kind: str
    apply: Any
    root: Any


class Embedding(NamedTuple):
    """A solution seen in a larger problem, in which it is a branch point."""

    problem: Any
    u: np.ndarray
    tangent: np.ndarray
    kind: str


class Seed(NamedTuple):
    """Where the branch on the other side begins; `tangent` leads away from the border."""

    problem: CycleProblem
    u: np.ndarray
    p: float
    tangent: np.ndarray | None
    kind: str
    note: str
    persistence: bool
