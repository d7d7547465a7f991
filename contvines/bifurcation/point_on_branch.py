"""PointOnBranch: a solution as the test functions of kinds see it."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Protocol

import numpy as np

if TYPE_CHECKING:
    from ..continuation.engine import Engine, Solved
    from ..problems.protocol import Problem
    from .segment import Segment


class Point(Protocol):
    """What the functions of a kind may ask of a point, on a branch or on a locus; see `PointOnBranch`."""

    @property
    def u(self) -> np.ndarray: ...
    @property
    def value(self) -> float: ...
    @property
    def problem(self) -> Problem: ...
    @property
    def parameters(self) -> dict[str, float]: ...
    @cached_property
    def multipliers(self) -> np.ndarray: ...
    @property
    def margins(self) -> np.ndarray: ...
    @cached_property
    def jacobian(self) -> np.ndarray: ...
    def measure(self, name: str) -> float: ...


class PointOnBranch:
    """A point of a branch; what takes time is computed when it is asked for.

    Attributes
    ----------
    u : ndarray, shape (N,)
    value : float
        Of the parameter.
    tangent : ndarray, shape (N + 1,)
        Unit tangent of the branch, its last entry that of the parameter.
    problem : Problem
    """

    def __init__(
        self,
        engine: Engine,
        solved: Solved,
        segment: Segment | None = None,
        position: float = 0.0,
        index: int = 0,
    ) -> None:
        self.engine, self.solved, self.segment, self.position, self.index = (
            engine,
            solved,
            segment,
            position,
            index,
        )

    @property
    def u(self) -> np.ndarray:
        return self.solved.u

    @property
    def value(self) -> float:
        return self.solved.p

    @property
    def tangent(self) -> np.ndarray:
        return self.solved.tangent

    @property
    def problem(self) -> Problem:
        return self.engine.problem

    @property
    def parameters(self) -> dict[str, float]:
        """All parameters by name, the varying one included."""
        problem = self.engine.problem
        return {**problem.parameters, problem.parameter: self.solved.p}

    @cached_property
    def multipliers(self) -> np.ndarray:
        """Of the full period (eigenvalues for flows), complex."""
        return self.engine.multipliers(self.solved.row)

    @property
    def margins(self) -> np.ndarray:
        """Distances from borders, positive on a real solution; +inf where one does not apply."""
        return self.engine.margins(self.solved.row)

    @cached_property
    def jacobian(self) -> np.ndarray:
        """F_u of the problem's equations, shape (N, N)."""
        engine, kernels = self.engine, self.engine.problem.kernels
        engine.residual(self.solved.u, self.solved.p)
        if kernels.matrix is None:
            raise ValueError(f"a {type(engine.problem).__name__} does not tell its Jacobian")
        return np.array(kernels.matrix(engine.problem.data, engine.work))

    def measure(self, name: str) -> float:
        """A measure of the solution by its name."""
        if name == self.engine.problem.parameter:
            return self.solved.p
        found = self.engine.problem.measures((name,), self.solved.u[None, :], np.array([self.solved.p]))
        return float(found[name][0])
