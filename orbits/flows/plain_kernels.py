"""Kernels in plain Python: bordered solution, Newton's method and the examination of one solution, for all sorts of machines."""

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
"""Number of steps that leave the residual unchanged and below `accepted`, after which it counts as roundoff."""


Data = TypeVar("Data")
Work = TypeVar("Work", bound=tuple)


@cache
def _gesv() -> Callable[..., tuple[np.ndarray, np.ndarray, np.ndarray, int]]:
    """LAPACK's solver that also returns the factors; unlike getrs it starts no threads for a matrix of a few rows."""
    from scipy.linalg import get_lapack_funcs

    return get_lapack_funcs(("gesv",), (np.zeros((1, 1)),))[0]


class PlainKernels(ABC, Generic[Data, Work]):
    """The kernels of a continuation (signatures as in `contvines.core.table.TableKernels`), and `newton` and `examine`."""

    compiled = False
    column: int
    """Index of F_p among the arrays of a workspace; F is the first."""
    accepted = 0.0
    """Largest residual that is accepted as roundoff if further steps do not reduce it."""
    patience = math.inf
    """Evaluations, as a share of the limit of steps, that Newton's method may spend on steps that do not halve the residual."""

    @abstractmethod
    def linearise(self, data: Data, u: np.ndarray, p: float, work: Work) -> float:
        """Write residual and derivatives into `work`; return the largest residual, infinity if it cannot be evaluated."""

    @abstractmethod
    def fill(self, data: Data, work: Work, matrix: np.ndarray) -> None:
        """Write F_u of the linearisation in `work`, shape (N, N), into a matrix of zeros."""

    def bordered(
        self, data: Data, work: Work, border: np.ndarray, target: float, step: np.ndarray, tangent: np.ndarray
    ) -> float:
        """Solve the bordered system with the linearisation in `work`.

        [[F_u, F_p], [border]] z = (-F, target) into `step`, and = (0, 1) into `tangent`. Returns the sign of the determinant; 0 if singular.
        """
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
        """Write multipliers of the closure map as pairs (re, im), then margins, into `row`."""

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
        """Newton's method at fixed p, or in the hyperplane with normal vector `border`; steps that do not reduce the residual are halved.

        Returns
        -------
        residual : float
            Infinity if the method does not converge.
        iterations : int
        p : float
            `u` is changed in place.
        """
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
        """Return the residual of one solution and write its `inspect` row; NaN if it cannot be evaluated."""
        residual = self.linearise(data, u, p, work)
        if math.isfinite(residual):
            self.inspect(data, u, p, work, row)
        else:
            row[:] = math.nan
        return residual
