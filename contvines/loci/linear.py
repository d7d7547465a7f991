"""A problem's linearisation from Python: solves with borders, null vectors, the spectrum, at single points."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..interrupts import HELD
from ..problems.protocol import Problem, array_of

SWEEPS = 4  # renewals of random borders until they are null vectors to roundoff, where the matrix is singular
STIRRED = 0.1  # part of a random vector in those of a neighbour


class Null(NamedTuple):
    """The null direction of a nearly singular matrix, the borders that belong to it, and the test g that is zero where it is singular.

    With unknowns and equations in units of their scales the borders are the left and the right null vector, of unit length.
    """

    right: np.ndarray
    column: np.ndarray
    row: np.ndarray
    test: float


def sizes_of(problem: Problem) -> tuple[np.ndarray, np.ndarray]:
    """Typical sizes of a problem's unknowns and equations; 1 where it has natural units."""
    scales, n = problem.scales, int(problem.dimension)
    if scales is None or len(scales.unknowns) != n:
        return np.ones(n), np.ones(n)
    return np.asarray(scales.unknowns, dtype=float), np.asarray(scales.rows, dtype=float)


class Linearisation:
    """F, F_u and F_p of a problem at one point, and solves with them through the problem's own kernels.

    Parameters
    ----------
    problem : Problem
        With the optional kernels of the protocol.
    """

    def __init__(self, problem: Problem) -> None:
        self.problem, self.kernels, self.data = problem, problem.kernels, problem.data
        self.size = int(problem.dimension)
        self.units, self.rows = sizes_of(problem)
        self.work, self.other = problem.workspace(), problem.workspace()
        column = self.kernels.column
        self.F, self.Q = array_of(self.work).reshape(-1), array_of(self.work, column).reshape(-1)
        self.other_F = array_of(self.other).reshape(-1)
        self.line, self.step, self.tangent = (np.zeros(self.size + 1) for _ in range(3))
        self.residual = self.slope = np.zeros(self.size)
        self.point: tuple[np.ndarray, float] = (np.zeros(self.size), 0.0)
        self.overwritten = True  # F and F_p, by sides of a solve
        self.used_up = True  # all of it, by an inspection or a flip

    def at(self, u: np.ndarray, p: float) -> float:
        """Linearise; returns the largest residual. ``residual`` and ``slope`` are then copies of F and F_p."""
        self.point = np.array(u, dtype=float), float(p)
        largest = self._linearise()
        self.residual, self.slope = self.F.copy(), self.Q.copy()
        return largest

    def _linearise(self) -> float:
        self.overwritten = self.used_up = False
        return float(self.kernels.linearise(self.data, self.point[0], self.point[1], self.work))

    def _matrix(self) -> None:
        """Linearise at the same point once more if F_u has been used up; its F and F_p are about to be overwritten."""
        if self.used_up:
            self._linearise()
        self.overwritten = True

    def _solved(self, side: np.ndarray | float, b: np.ndarray, c: np.ndarray) -> None:
        """Solve with F_u, bordered by b and c: (side, 0) on the right, into `step`, and (0, 1), into `tangent`."""
        self._matrix()
        self.F[:], self.Q[:], self.line[:-1], self.line[-1] = -side, b, c, 0.0
        self.kernels.bordered(self.data, self.work, self.line, 0.0, self.step, self.tangent)

    def solve(self, side: np.ndarray, b: np.ndarray, c: np.ndarray) -> tuple[np.ndarray, float]:
        """(x, s) with F_u x + b s = side and c.x = 0."""
        self._solved(side, b, c)
        return self.step[:-1].copy(), float(self.step[-1])

    def null(self, b: np.ndarray, c: np.ndarray) -> tuple[np.ndarray, float]:
        """(v, g) with F_u v + b g = 0 and c.v = 1."""
        self._solved(0.0, b, c)
        return self.tangent[:-1].copy(), float(self.tangent[-1])

    def left(self, b: np.ndarray, c: np.ndarray) -> tuple[np.ndarray, float]:
        """(w, g) with F_u^T w + c g = 0 and b.w = 1."""
        self._matrix()
        assert self.kernels.transpose is not None
        self.kernels.transpose(self.data, self.work, np.ascontiguousarray(c), self.other)
        self.other_F[:], self.line[:-1], self.line[-1] = 0.0, b, 0.0
        self.kernels.bordered(self.data, self.other, self.line, 0.0, self.step, self.tangent)
        return self.tangent[:-1].copy(), float(self.tangent[-1])

    @contextmanager
    def flipped(self) -> Iterator[None]:
        """Within it F_u is that of perturbations that change sign over the period."""
        self._matrix()
        assert self.kernels.flip is not None
        self.kernels.flip(self.data, self.work, -1.0)
        try:
            yield
        finally:
            self.used_up = True

    def null_vectors(self, flipped: bool = False, near: Null | None = None) -> Null:
        """The null vectors of the matrix, or of the flipped one; for a regular one those of its smallest singular values.

        ``near`` are those of a neighbour.
        """
        v, w = np.random.default_rng(5).standard_normal((2, self.size)) / np.sqrt(self.size)
        b, c, sweeps = self.rows * w, v / self.units, SWEEPS
        if (
            near is not None
        ):  # of another singular value, where those have passed one another: a part of all others must be left
            b, c, sweeps = near.column + STIRRED * b, near.row + STIRRED * c, 1
        with self.flipped() if flipped else nullcontext():
            for _ in range(sweeps):
                c = self.border_of(self.null(b, c)[0])
                w = self.left(b, c)[0] * self.rows
                b = self.rows * (w / np.linalg.norm(w))
            v, g = self.null(b, c)
        return Null(v / np.linalg.norm(v / self.units), b, c, g)

    def border_of(self, direction: np.ndarray) -> np.ndarray:
        """The row along a direction of the unknowns, of unit length in units of their scales."""
        scaled = direction / self.units
        return scaled / np.linalg.norm(scaled) / self.units

    def row(self) -> np.ndarray:
        """Multipliers as (re, im) pairs, then margins."""
        row = np.zeros(2 * int(self.problem.n_multipliers) + int(self.problem.n_margins))
        if self.overwritten or self.used_up:
            self._linearise()
        with HELD:
            self.kernels.inspect(self.data, self.point[0], self.point[1], self.work, row)
        self.used_up = True
        return row

    def spectrum(self) -> NDArray[np.complex128]:
        """Raw multipliers, or eigenvalues."""
        m = int(self.problem.n_multipliers)
        row = self.row()
        return row[0 : 2 * m : 2] + 1j * row[1 : 2 * m : 2]
