"""Maps and equations of motion made of Python callables, simulated: in the piece in which the state is, not that of a solution."""

from __future__ import annotations

from typing import Any

import numpy as np

from .functions import NotEvaluable


class MapSection:
    """A map applied once per period of a cycle; see :mod:`contvines.circles.section`.

    Parameters
    ----------
    problem : MapProblem
    p : float
    """

    def __init__(self, problem: Any, p: float) -> None:
        self.problem, self.p = problem, float(p)
        self.pieces = problem.pieces.repeated(1, 1)
        self.functions = problem.functions
        if self.pieces.count:
            self.functions = problem.functions.of(*problem._wrapped(self.pieces))

    @property
    def names(self) -> tuple[str, ...]:
        """x0, x1, ..."""
        return tuple(f"x{j}" for j in range(self.problem.node))

    def through(self, u: np.ndarray) -> np.ndarray:
        """The first point of the cycle."""
        return np.array(u[: self.problem.node], dtype=float)

    def image(self, x: np.ndarray) -> np.ndarray:
        """f at a point, in the piece in which it lies; NaN where f is not defined."""
        try:
            if self.pieces.count:
                self.pieces.choose(x, self.p)
            with np.errstate(all="ignore"):
                return np.asarray(self.functions.value(x, self.p), dtype=float)
        except NotEvaluable:
            return np.full(self.problem.node, np.nan)

    def step(self, x: np.ndarray) -> np.ndarray:
        """One period of the cycle later."""
        for _ in range(self.problem.cycle):
            x = self.image(x)
        return x


class SimulatedMap:
    """What a MapProblem says of its motions."""

    def section(self, p: float) -> MapSection:
        """Its motions, once per period of the cycle."""
        return MapSection(self, p)
