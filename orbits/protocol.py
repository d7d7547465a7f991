"""What an orbit problem hands to a continuation code: symmetries, larger problems, seeds of branches."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from orbits.problem import OrbitProblem


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

    problem: OrbitProblem
    u: np.ndarray
    p: float
    tangent: np.ndarray | None
    kind: str
    note: str
    persistence: bool
