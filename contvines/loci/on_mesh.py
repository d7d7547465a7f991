"""OnMesh: what loci ask of problems whose unknowns belong to a mesh, the cycles of flows."""

from __future__ import annotations

from typing import Protocol, Self, runtime_checkable

import numpy as np

from ..problems.abilities import Adaptive
from ..problems.protocol import Problem


@runtime_checkable
class OnMesh(Adaptive, Problem, Protocol):
    """Cycles of a flow: ``states`` values at mesh points, then the period of autonomous ones, at ``period_place``.

    ``reference`` keeps the phase; ``waiting`` guesses a cycle of another period, ``with_unknowns`` has the cycles on another mesh.
    """

    reference: tuple[np.ndarray, np.ndarray] | None
    states: int
    free_period: int
    intervals: int
    copies: int

    @property
    def period_place(self) -> int: ...
    def refined(self) -> Self: ...
    def root(
        self, u: np.ndarray, p: float, loose: float | None = None
    ) -> tuple[Problem, np.ndarray] | None: ...
    def center(self, u: np.ndarray) -> tuple[np.ndarray, float]: ...
    def resting(self, u: np.ndarray, x: np.ndarray) -> np.ndarray: ...
    def from_rest(self, u: np.ndarray, p: float) -> float: ...
    def waiting(self, u: np.ndarray, p: float, period: float) -> np.ndarray: ...
    def with_unknowns(
        self, u: np.ndarray, p: float, intervals: int, copies: int, rounds: int | None = None
    ) -> Self: ...


def on_mesh(problem: Problem) -> OnMesh:
    """The problem, which is one of cycles of a flow.

    Raises
    ------
    TypeError
        If it is none.
    """
    if not isinstance(problem, OnMesh):
        raise TypeError(f"a {type(problem).__name__} has no mesh")
    return problem
