"""What an orbit problem hands to a continuation code: symmetries, larger problems, seeds of branches."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

import numpy as np

from orbits.flows.protocol import Equations
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
    """What borders ask of the problem of the cycles with one word (`orbits.problem.OrbitProblem`)."""

    model: Any
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
    data: object
    equations: Equations

    @property
    def spelling(self) -> str: ...

    @property
    def scratch(self) -> object: ...

    def values(self, p: float | np.ndarray) -> np.ndarray: ...

    def value(self, params: np.ndarray) -> float: ...

    def reduce(self, nodes: np.ndarray) -> np.ndarray: ...

    def expand(self, u: np.ndarray, p: float | np.ndarray | None = None) -> np.ndarray: ...

    def middle(self, p: float) -> float: ...

    def orbit(self, u: np.ndarray, p: float) -> Orbit: ...

    def sibling(
        self, word: Word, periods: int, symmetric: bool, params: np.ndarray | None = None
    ) -> CycleProblem: ...


class Answers:
    """What every problem of a machine's motions answers a continuation code alike.

    Its unknowns are counted in units of the machine's own size, its equations are exact to roundoff and smooth between the
    borders, so that there is nothing to learn, to doubt or to explain.
    """

    detection = ""
    scales = None
    scales_learned = False
    noise = 0.0

    def at_each_point(self, name: str, u: np.ndarray, p: np.ndarray) -> None:
        """A measure at every point of a cycle: those of a motion have no order."""
        return None

    def explain_end(self, u: np.ndarray, p: float, tangent: np.ndarray, evaluable: bool) -> str:
        """Why a branch ends where Newton's method fails."""
        return ""

    def uncertainty(self) -> float:
        """Relative accuracy of the equations."""
        return 0.0

    def check(self, u: np.ndarray, p: float) -> None:
        """What is wrong with the derivatives at a solution."""
        return None


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
