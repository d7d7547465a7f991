"""Normal forms of a cycle of a flow, by its return map: those of a map of few unknowns, whatever the mesh of the cycle."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...problems.abilities import Returning
from ...problems.protocol import Problem
from .coefficients import Forms
from .taylor import Line


def forms_at(problem: Problem, u: np.ndarray, p: float) -> Forms:
    """Normal forms of a problem at a point: of cycles of flows those of the return map.

    Raises
    ------
    ValueError
        If the equations cannot be evaluated there.
    """
    if isinstance(problem, Returning):
        return ReturnForms(problem, u, p)
    return Forms(problem, u, p)


class ReturnForms(Forms):
    """Normal forms of x -> P(x) at x = 0, P being the return map of a cycle. Equations are P(x) - x' = 0, x' the next return.

    Critical vectors have unit length as states.
    """

    unknown = "motions cannot be followed for a period"

    def __init__(self, problem: Problem, u: np.ndarray, p: float) -> None:
        self.problem, self.p, self.rough = problem, float(p), False
        assert isinstance(problem, Returning)
        self.returns = problem.return_map(u, p)
        self.n = self.returns.basis.shape[1]
        self.flow, self.rate, self.reach = False, 1.0, 1.0
        self.units, self.u, self.whole = np.ones(self.n), np.zeros(self.n), np.zeros(self.n)
        matrix = self.returns.varied(np.zeros((1, self.n)))[1][0]
        if not np.isfinite(matrix).all():
            raise ValueError(f"{self.unknown} beside the cycle")
        self.J, self.K = matrix - np.eye(self.n), -np.eye(self.n)
        self.lines: dict[bytes, Line] = {}
        self._nulls: dict[complex, tuple[np.ndarray, np.ndarray]] = {}

    def along(self, direction: np.ndarray) -> np.ndarray:
        """A direction of the cycle's unknowns as one of the section."""
        return self.returns.inverse @ direction[: self.returns.node]

    def spectrum(self) -> NDArray[np.complex128]:
        """Multipliers."""
        return np.asarray(np.linalg.eigvals(self.J + np.eye(self.n)), dtype=complex)

    def extended(self, x: np.ndarray, factor: complex) -> np.ndarray:
        return x

    def unit(self, vector: np.ndarray) -> np.ndarray:
        return vector / (np.linalg.norm(self.returns.basis @ vector) or np.nan)

    def rows(self, points: np.ndarray) -> np.ndarray | None:
        found = self.returns.varied(points)[1]
        return found if np.isfinite(found).all() else None

    def rests(self, here: np.ndarray, following: np.ndarray | None) -> np.ndarray:
        assert following is not None
        return self.returns(here) - following
