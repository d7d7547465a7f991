"""Linearisation of a problem at single points: bordered solutions, null vectors, multipliers and margins, through the problem's kernels."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from ..long_work import HELD
from ..problems.protocol import Problem, array_of
from .kernels import BRANCH, FLIP, FOLD, pair_of

SWEEPS = 4  # inverse iterations from random borders to null vectors, which are then accurate to roundoff if the matrix is singular
STIRRED = 0.1  # part of a random vector that is added to the null vectors of a neighbouring point before an iteration


class Null(NamedTuple):
    """Right null vector of a nearly singular matrix, borders ``column`` and ``row``, and the test g, which is zero if the matrix is singular.

    In units of unknowns and equations the borders are the left and the right null vector, of unit length.
    """

    right: np.ndarray
    column: np.ndarray
    row: np.ndarray
    test: float


class Linearisation:
    """F, F_u and F_p of a problem at one point, and linear systems with F_u, solved by the problem's own kernels.

    Parameters
    ----------
    problem : Problem
        Its kernels must have the optional entries of the protocol.

    Attributes
    ----------
    units, rows : ndarray, shape (N,)
        Typical sizes of the unknowns and of the equations; 1 if the problem has no scales.
    largest : float
        Largest residual.
    residual, slope : ndarray, shape (N,)
        F and F_p.
    """

    def __init__(self, problem: Problem) -> None:
        self.problem, self.kernels, self.data = problem, problem.kernels, problem.data
        self.size, self.m = int(problem.dimension), int(problem.n_multipliers)
        self.flow = problem.spectrum == "flow"
        self.units, self.rows = np.ones((2, self.size))
        if (scales := problem.scales) is not None and len(scales.unknowns) == self.size:
            self.units[:], self.rows[:] = scales.unknowns, scales.rows
        self.work, self.other = problem.workspace(), problem.workspace()
        column = self.kernels.column
        self.F, self.Q = array_of(self.work).reshape(-1), array_of(self.work, column).reshape(-1)
        self.other_F = array_of(self.other).reshape(-1)
        self.line, self.step, self.tangent = np.zeros((3, self.size + 1))
        self.largest, self.residual, self.slope = np.inf, *np.zeros((2, self.size))
        self.point: tuple[np.ndarray, float] = (np.zeros(self.size), 0.0)
        self._row: np.ndarray | None = None
        self.overwritten = True  # whether right-hand sides have overwritten F and F_p in the workspace
        self.used_up = True  # whether an inspection or a flip has changed F_u in the workspace

    def at(self, u: np.ndarray, p: float) -> Self:
        """Linearise at a point; return self."""
        self.point, self._row = (np.array(u, dtype=float), float(p)), None
        self.largest = self._linearise()
        self.residual, self.slope = self.F.copy(), self.Q.copy()
        return self

    def _linearise(self) -> float:
        self.overwritten = self.used_up = False
        return float(self.kernels.linearise(self.data, *self.point, self.work))

    def _matrix(self) -> None:
        """Make sure that the workspace holds F_u, by linearising again if necessary; the caller will overwrite F and F_p."""
        if self.used_up:
            self._linearise()
        self.overwritten = True

    # ------------------------------------------------------------------ solves
    def _solved(self, side: np.ndarray | float, b: np.ndarray, c: np.ndarray) -> None:
        """Solve [[F_u, b], [c, 0]] x = (side, 0) into ``step``, and = (0, 1) into ``tangent``."""
        self._matrix()
        self.F[:], self.Q[:], self.line[:-1], self.line[-1] = -side, b, c, 0.0
        self.kernels.bordered(self.data, self.work, self.line, 0.0, self.step, self.tangent)

    def solve(self, side: np.ndarray, b: np.ndarray, c: np.ndarray) -> tuple[np.ndarray, float]:
        """Return (x, s) with F_u x + b s = side and c.x = 0."""
        self._solved(side, b, c)
        return self.step[:-1].copy(), float(self.step[-1])

    def null(self, b: np.ndarray, c: np.ndarray) -> tuple[np.ndarray, float]:
        """Return (v, g) with F_u v + b g = 0 and c.v = 1."""
        self._solved(0.0, b, c)
        return self.tangent[:-1].copy(), float(self.tangent[-1])

    def left(self, b: np.ndarray, c: np.ndarray) -> tuple[np.ndarray, float]:
        """Return (w, g) with F_u^T w + c g = 0 and b.w = 1."""
        self._matrix()
        assert self.kernels.transpose is not None
        self.kernels.transpose(self.data, self.work, np.ascontiguousarray(c), self.other)
        self.other_F[:], self.line[:-1], self.line[-1] = 0.0, b, 0.0
        self.kernels.bordered(self.data, self.other, self.line, 0.0, self.step, self.tangent)
        return self.tangent[:-1].copy(), float(self.tangent[-1])

    @contextmanager
    def flipped(self) -> Iterator[None]:
        """Context in which F_u acts on perturbations that change sign over the period."""
        self._matrix()
        assert self.kernels.flip is not None
        self.kernels.flip(self.data, self.work, -1.0)
        try:
            yield
        finally:
            self.used_up = True

    def null_vectors(self, flipped: bool = False, near: Null | None = None) -> Null:
        """Return the null vectors of F_u, or of the flipped F_u; for a regular matrix approximate singular vectors of the smallest singular value.

        Parameters
        ----------
        flipped : bool
        near : Null, optional
            Null vectors of a neighbouring point, from which one iteration is enough.
        """
        v, w = np.random.default_rng(5).standard_normal((2, self.size)) / np.sqrt(self.size)
        b, c, sweeps = self.rows * w, v / self.units, SWEEPS
        if near is not None:
            # the smallest singular value may have changed places with another one: keep a component along all singular vectors
            b, c, sweeps = near.column + STIRRED * b, near.row + STIRRED * c, 1
        with self.flipped() if flipped else nullcontext():
            for _ in range(sweeps):
                c = self.border_of(self.null(b, c)[0])
                w = self.left(b, c)[0] * self.rows
                b = self.rows * (w / np.linalg.norm(w))
            v, g = self.null(b, c)
        return Null(v / np.linalg.norm(v / self.units), b, c, g)

    def border_of(self, direction: np.ndarray) -> np.ndarray:
        """Return the row along a direction of the unknowns, of unit length in units of their scales."""
        scaled = direction / self.units
        return scaled / np.linalg.norm(scaled) / self.units

    # ------------------------------------------------------------------ multipliers and margins
    @property
    def row(self) -> np.ndarray:
        """Raw multipliers as (re, im) pairs, then margins."""
        if self._row is None:
            self._row = np.zeros(2 * self.m + int(self.problem.n_margins))
            if self.overwritten or self.used_up:
                self._linearise()
            with HELD:
                self.kernels.inspect(self.data, *self.point, self.work, self._row)
            self.used_up = True
        return self._row

    @property
    def margins(self) -> np.ndarray:
        """Margins: distances from borders, positive inside."""
        return self.row[2 * self.m :]

    @property
    def spectrum(self) -> NDArray[np.complex128]:
        """Raw multipliers, or eigenvalues."""
        return self.row[0 : 2 * self.m : 2] + 1j * self.row[1 : 2 * self.m : 2]

    def pair(self, reference: float) -> tuple[float, float]:
        """Return (test, position) of the pair of multipliers nearest to the stability boundary and to a reference; see ``pair_of``."""
        return pair_of(self.row, self.m, self.flow, reference)

    def positions(self) -> np.ndarray:
        """Return the positions of all complex pairs, see ``pair_of``, the most critical one first."""
        pairs = critical_first(self.spectrum, self.flow)
        return np.abs(pairs) ** 2 if self.flow else pairs.real


def critical_first(spectrum: NDArray[np.complex128], flow: bool) -> NDArray[np.complex128]:
    """Return the multipliers, or eigenvalues, with positive imaginary part, those nearest to the stability boundary first."""
    upper = spectrum[spectrum.imag > 0.0]
    return upper[np.argsort(np.abs(upper.real if flow else np.abs(upper) - 1.0), kind="stable")]


def singularity(problem: Problem, u: np.ndarray, p: float) -> float:
    """Return the magnitude of the test g, which vanishes where F_u is singular."""
    return abs(Linearisation(problem).at(u, p).null_vectors().test)


def fresh_borders(size: int) -> np.ndarray:
    """Return random borders, shape (4, size + 1)."""
    return np.random.default_rng(5).standard_normal((4, size + 1)) / np.sqrt(size)


def borders_at(
    problem: Problem, wanted: int, u: np.ndarray, p: float, near: np.ndarray | None = None
) -> np.ndarray:
    """Compute the borders of a locus at a point: null vectors of the matrix that is singular there.

    Parameters
    ----------
    problem : Problem
    wanted : int
        Condition of the locus; see :mod:`contvines.loci.kernels`.
    u, p
        The point.
    near : ndarray, optional
        Borders of a neighbouring point, whose orientation is kept, since the sign of the determinant depends on it.

    Returns
    -------
    ndarray, shape (4, N + 1)
    """
    if near is not None and wanted not in (FOLD, BRANCH, FLIP):
        return near.copy()
    line = Linearisation(problem).at(u, p)
    n = line.size
    borders = fresh_borders(n) if near is None else near.copy()
    # null vectors of the neighbour from its borders
    before = [None, None] if near is None else [Null(c, b, c, 0.0) for b, c in near[:, :-1].reshape(2, 2, n)]
    null = line.null_vectors(near=before[0])
    if wanted in (FOLD, BRANCH):
        borders[0, :n], borders[1, :n] = null.column, null.row
    elif near is None:  # F_u is regular: any generic borders do
        b = line.rows * (np.random.default_rng(6).standard_normal(n) / np.sqrt(n))
        v, _ = line.null(b, null.row)
        borders[0, :n], borders[1, :n] = b, line.border_of(v)
    if wanted == FLIP:
        null = line.null_vectors(True, before[1])
        borders[2, :n], borders[3, :n] = null.column, null.row
    return borders
