"""Kernels in plain Python: what all of them have, Newton's method and the look at one solution."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from functools import cache
from typing import TYPE_CHECKING, Generic, TypeVar

import numpy as np

from orbits.arguments import ROUNDOFF
from orbits.settings import SOLVING

if TYPE_CHECKING:
    from collections.abc import Callable

FLAT = 2
"""Steps from a solution to itself after which its residual is roundoff."""


Data = TypeVar("Data")
Work = TypeVar("Work", bound=tuple)


@cache
def _gesv() -> Callable[..., tuple[np.ndarray, np.ndarray, np.ndarray, int]]:
    """LAPACK's solver with its factors: unlike getrs it does not wake other threads for a matrix of a few rows."""
    from scipy.linalg import get_lapack_funcs

    return get_lapack_funcs(("gesv",), (np.zeros((1, 1)),))[0]


class PlainKernels(ABC, Generic[Data, Work]):
    """The functions that a continuation calls, and two of this package's own; signatures as in `contvines.core.table.TableKernels`."""

    compiled = False
    column: int
    """Place of F_p among the arrays of a workspace; F is the first."""
    accepted = 0.0
    """Residual of a solution whose steps do not become any smaller."""
    patience = math.inf
    """Evaluations, as a share of the steps, that Newton's method may spend on steps that do not halve the residual."""

    @abstractmethod
    def linearise(self, data: Data, u: np.ndarray, p: float, work: Work) -> float:
        """Residual and derivatives into `work`; returns the largest residual, infinity where it cannot be evaluated."""

    @abstractmethod
    def fill(self, data: Data, work: Work, matrix: np.ndarray) -> None:
        """F_u of the linearisation in `work`, shape (N, N), into a matrix of zeros."""

    def bordered(
        self, data: Data, work: Work, border: np.ndarray, target: float, step: np.ndarray, tangent: np.ndarray
    ) -> float:
        """Solve [[F_u, F_p], [border]] z = (-F, target) into `step` and = (0, 1) into `tangent`; returns the determinant's sign, 0 if it is singular."""
        size = len(border) - 1
        matrix, sides = np.zeros((size + 1, size + 1), order="F"), np.zeros((size + 1, 2), order="F")
        self.fill(data, work, matrix[:size, :size])
        matrix[:size, size], matrix[size] = work[self.column].ravel(), border
        sides[:size, 0] = -work[0].ravel()
        sides[size, 0], sides[size, 1] = target, 1.0
        if not np.all(np.isfinite(matrix)):
            step[:] = tangent[:] = math.nan
            return 0.0
        factors, pivots, solution, singular = _gesv()(matrix, sides)
        flips = np.count_nonzero(pivots != np.arange(size + 1)) + np.count_nonzero(np.diagonal(factors) < 0.0)
        sign = -1.0 if flips % 2 else 1.0
        if singular:
            sign = 0.0
            nearby = matrix + ROUNDOFF * np.abs(matrix).max() * np.eye(size + 1)
            _, _, solution, singular = _gesv()(nearby, sides)
            if singular:
                return 0.0
        step[:], tangent[:] = solution[:, 0], solution[:, 1]
        return sign

    @abstractmethod
    def inspect(self, data: Data, u: np.ndarray, p: float, work: Work, row: np.ndarray) -> None:
        """Multipliers of the closure map as (re, im) pairs, then margins, into `row`."""

    def newton(
        self,
        data: Data,
        u: np.ndarray,
        p: float,
        work: Work,
        border: np.ndarray,
        step: np.ndarray,
        tangent: np.ndarray,
        tolerance: float,
        limit: int,
    ) -> tuple[float, int, float]:
        """Newton's method at fixed p, or on the hyperplane of `border`; steps that do not help are halved."""
        residual, idle, flat = self.linearise(data, u, p, work), 0, 0
        for iteration in range(limit):
            if not math.isfinite(residual):
                return math.inf, iteration, p
            if idle > self.patience * limit or flat > FLAT:
                break
            sign = self.bordered(data, work, border, 0.0, step, tangent)
            if sign == 0.0 or not np.isfinite(step).all():
                return math.inf, iteration, p
            length, share, trials = float(np.abs(step[:-1]).max(initial=0.0)), 1.0, 0
            while True:
                trials += 1
                trial, q = u + share * step[:-1], p + share * float(step[-1])
                found = self.linearise(data, trial, q, work)
                if found < residual or length < SOLVING.free_step or share < 0.02:
                    break
                share *= 0.5
            idle += trials if found > 0.5 * residual else 0
            flat += 0.5 * residual < found < self.accepted
            u[:], p, residual = trial, q, found
            if length * share < tolerance or (residual < SOLVING.rounding and length < SOLVING.near):
                return residual, iteration + 1, p
        return residual if residual < self.accepted else math.inf, limit, p

    def examine(self, data: Data, u: np.ndarray, p: float, work: Work, row: np.ndarray) -> float:
        """Residual, and the row of `inspect`, of one solution; the row is not a number where it cannot be evaluated."""
        residual = self.linearise(data, u, p, work)
        if math.isfinite(residual):
            self.inspect(data, u, p, work, row)
        else:
            row[:] = math.nan
        return residual
