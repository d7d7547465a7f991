"""What an orbit problem hands to a continuation code: symmetries, larger problems, seeds of branches."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

import numpy as np

from orbits.flows.protocol import Equations, Flow
from orbits.orbit import Orbit

if TYPE_CHECKING:
    from collections.abc import Callable

    from orbits.words import Word


class BorderPoint(Protocol):
    """What a problem is given of a special point at a border."""

    @property
    def u(self) -> np.ndarray: ...
    @property
    def value(self) -> float: ...
    @property
    def tangent(self) -> np.ndarray: ...
    @property
    def margin_index(self) -> int | None: ...


class CycleProblem(Protocol):
    """What borders, and answers about other motions, ask of the problem of the cycles with one word (`orbits.problem.OrbitProblem`)."""

    model: Any
    flow: Flow
    word: Word
    periods: int
    parameter: str
    params: np.ndarray
    symmetric: bool
    mirrored: bool
    forced: bool
    length: int
    dimension: int
    shift: float
    n_multipliers: int
    n_margins: int
    equations: Equations

    @property
    def spelling(self) -> str: ...

    @property
    def image_offset(self) -> Callable[[float], np.ndarray] | None: ...

    def values(self, p: float | np.ndarray) -> np.ndarray: ...

    def value(self, params: np.ndarray) -> float: ...

    def reduce(self, nodes: np.ndarray) -> np.ndarray: ...

    def expand(self, u: np.ndarray, p: float | np.ndarray | None = None) -> np.ndarray: ...

    def middle(self, p: float) -> float: ...

    def orbit(self, u: np.ndarray, p: float) -> Orbit: ...

    def sibling(
        self, word: Word, periods: int, symmetric: bool, params: np.ndarray | None = None
    ) -> CycleProblem: ...


class Symmetry(NamedTuple):
    """An image of a solution that solves the same problem; `root` reduces a solution that is its own image.

    `kind_at` tells the kind of the points where that depends on the solution; of machines it never does. `offset` (p) is added to
    the image, where the middle between the walls is not at w = 0.
    """

    kind: str
    apply: Callable[[np.ndarray], np.ndarray]
    root: Callable[[np.ndarray], tuple[Any, np.ndarray]] | None
    kind_at: Callable[[np.ndarray], str] | None = None
    offset: Callable[[float], np.ndarray] | None = None


class Embedding(NamedTuple):
    """A solution seen in a larger problem, in which it is a branch point."""

    problem: object
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
