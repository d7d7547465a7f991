"""GMRES for the bordered system of a Jacobian that is a LinearOperator.

Unknowns and rows are in units of their scales. With a preconditioner P, an approximate inverse of F_u, the bordered matrix is preconditioned by
[[P^-1, F_p], [border]], which is inverted by block elimination. The border then adds no iterations, and the preconditioner is as good
next to a fold, where F_u is nearly singular, as elsewhere.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from scipy.sparse import csc_array, diags_array
from scipy.sparse.linalg import ArpackNoConvergence, LinearOperator, eigs, gmres

from ..settings import LINEAR
from ..spectra import NEAREST, without_roundoff

if TYPE_CHECKING:
    from collections.abc import Callable

    from scipy.sparse import csc_array

    from ..abilities import Linearised
    from ..dense import Equations


RESTART, ALL = 80, 300  # vectors after which GMRES restarts; up to ALL unknowns it does not restart
CYCLES = 40  # most restarts
GAIN = 0.5  # factor by which a cycle should reduce the residual ...
IDLE = 4  # ... GMRES ends after so many cycles that do not

Linear = Callable[[np.ndarray], np.ndarray]


def restarted(
    apply: Linear, side: np.ndarray, guess: np.ndarray | None, accuracy: float
) -> tuple[np.ndarray, float]:
    """Solve a linear system by restarted GMRES; return the solution and its residual relative to the right-hand side.

    It also ends when cycles no longer reduce the residual, since rounding limits the accuracy.

    Parameters
    ----------
    apply : callable
        The (preconditioned) matrix times a vector.
    side : ndarray, shape (n,)
        Right-hand side.
    guess : ndarray or None
    accuracy : float
        Requested relative residual.
    """
    n, size = len(side), float(np.linalg.norm(side))
    if size == 0.0:
        return np.zeros(n), 0.0
    matrix = LinearOperator((n, n), matvec=apply, dtype=float)  # type: ignore[call-arg]
    restart = n if n <= ALL else RESTART
    x = np.zeros(n) if guess is None else guess.copy()
    residual = side if guess is None else side - apply(x)
    gap = float(np.linalg.norm(residual)) / size
    if not gap < 1.0:
        x, residual, gap = np.zeros(n), side, 1.0
    idle = 0
    for _ in range(CYCLES):
        if gap <= accuracy:
            break
        step, missed = gmres(matrix, residual, rtol=accuracy / gap, atol=0.0, restart=restart, maxiter=1)
        trial = x + step
        rest_of_it = side - apply(trial)
        found = float(np.linalg.norm(rest_of_it)) / size
        idle = 0 if found <= GAIN * gap else idle + 1
        if not found < gap:
            break
        x, residual, gap = trial, rest_of_it, found
        if idle and (not missed or idle >= IDLE):
            break
    return x, gap


def solved(gap: float, growth: float) -> bool:
    """Whether a relative residual is acceptable; rounding errors grow with the ratio of the solution to the right-hand side, `growth`."""
    return gap < LINEAR.tolerated + LINEAR.growth * growth


class Bordered:
    """The bordered matrix [[F_u, F_p], [border]] in units of the scales, with its preconditioner.

    Parameters
    ----------
    data : AlgebraicProblem
    work
        Workspace with F_u and F_p.
    border : ndarray, shape (N + 1,)
    """

    def __init__(self, data: Equations, work: Linearised, border: np.ndarray) -> None:
        rows, units = data.sizes()
        width = 1.0 if data.scales is None else data.scales.parameter
        self.work, self.inverse = work, data.preconditioner_at()
        self.columns = np.append(units, width)
        self.border = border * self.columns
        self.length = float(np.linalg.norm(self.border)) or 1.0
        self.border /= self.length
        self.rows = np.append(rows, self.length)
        self.column, self.corner = self._eliminated()
        self.shift = 0.0  # subtracted from the diagonal of F_u, in units of rows and unknowns
        self.growth = 0.0  # ratio of the last solution to its right-hand side

    def _eliminated(self) -> tuple[np.ndarray | None, float]:
        """The preconditioner times F_p, and the Schur complement; None if the latter is only rounding."""
        if self.inverse is None:
            return None, 1.0
        column = np.ravel(self.inverse @ self.work.derivative) / self.columns[:-1] * self.columns[-1]
        part = float(self.border[:-1] @ column)
        corner = float(self.border[-1]) - part
        fine = np.isfinite(corner) and abs(corner) > LINEAR.border * (abs(part) + abs(float(self.border[-1])))
        return (column, corner) if fine else (None, 1.0)

    def product(self, x: np.ndarray) -> np.ndarray:
        """Multiply the matrix, in units of unknowns and rows, with a vector."""
        inner = x[:-1] * self.columns[:-1]
        top = np.ravel(self.work.jacobian @ inner) + self.work.derivative * (x[-1] * self.columns[-1])
        return np.append(top / self.rows[:-1] - self.shift * x[:-1], self.border @ x)

    def precondition(self, side: np.ndarray) -> np.ndarray:
        """Multiply the preconditioner, from units of rows to those of unknowns, with a vector."""
        if self.inverse is None:
            return side
        top = np.ravel(self.inverse @ (side[:-1] * self.rows[:-1])) / self.columns[:-1]
        if self.column is None:
            return np.append(top, side[-1])
        last = (side[-1] - float(self.border[:-1] @ top)) / self.corner
        return np.append(top - self.column * last, last)

    def solve(self, side: np.ndarray, guess: np.ndarray | None, accuracy: float) -> tuple[np.ndarray, float]:
        """Return the solution in the problem's units, and its relative residual."""
        start = None if guess is None else guess / self.columns
        right = self.precondition(side / self.rows)
        found, gap = restarted(lambda x: self.precondition(self.product(x)), right, start, accuracy)
        size = float(np.linalg.norm(right))
        self.growth = float(np.linalg.norm(found)) / size if size > 0.0 else 0.0
        return found * self.columns, gap


def iterate(
    data: Equations,
    work: Linearised,
    border: np.ndarray,
    sides: np.ndarray,
    tangent: np.ndarray | None,
) -> tuple[np.ndarray, Bordered]:
    """Solve the bordered system for two right-hand sides; return the solutions and the system.

    The last `tangent` is the guess for the second solution. Where GMRES does not converge, the solution is NaN and ``data.unsolved`` is set.
    """
    matrix = Bordered(data, work, border)
    data.unsolved = False
    result = np.zeros_like(sides)
    for k in range(2):
        if not np.any(sides[:, k]):
            continue
        guess = _scaled_tangent(tangent, border, sides) if k == 1 else None
        for matrix.shift in (0.0, LINEAR.singular):
            found, gap = matrix.solve(sides[:, k], guess, LINEAR.iterated)
            if solved(gap, matrix.growth):
                break
        else:
            data.unsolved = True
            found = np.full(len(found), np.nan)
        result[:, k] = found
    return result, matrix


def _scaled_tangent(tangent: np.ndarray | None, border: np.ndarray, sides: np.ndarray) -> np.ndarray | None:
    """The last tangent, scaled so that it fulfils the border equation; None if that is impossible."""
    if tangent is None or not (sides[:-1, 1] == 0.0).all():
        return None
    along = float(border @ tangent)
    return tangent * (sides[-1, 1] / along) if along != 0.0 else None


def distance_to_singular(data: Equations, matrix: Bordered) -> float | None:
    """Return the distance |M^-1 b| / |M^-1 M^-1 b| of the bordered matrix from a singular one; see :mod:`contvines.problems.spectra`.

    Since the sign of the determinant is unknown, branch points are found by this number alone. One application of the inverse is not
    enough, since the null vector may have a small component in its result by chance. None if GMRES does not converge.
    """
    side, sizes = data.side, []
    for _ in range(2):
        found, gap = matrix.solve(side, None, LINEAR.rough)
        if not solved(gap, matrix.growth):
            return None
        found = found / matrix.columns
        sizes.append(float(np.linalg.norm(found)))
        side = np.append(found[:-1] * matrix.rows[:-1], 0.0)
    return sizes[0] / sizes[1] if sizes[1] > 0.0 else 0.0


class Inverse:
    """(F_u - shift)^-1 by GMRES, with the interface of factors.

    The shift is in units of rows and unknowns or, if `plain`, in units of the eigenvalues of F_u.
    """

    def __init__(self, data: Equations, work: Linearised, shift: float, plain: bool = False) -> None:
        self.rows, self.columns = data.sizes()
        self.jacobian, self.inverse = work.jacobian, data.preconditioner_at()
        self.shift = shift * (self.columns if plain else self.rows)
        self.unsolved = False  # whether GMRES has failed, as it does if the matrix is singular

    def _precondition(self, side: np.ndarray) -> np.ndarray:
        if self.inverse is None:
            return side / self.rows
        return np.ravel(self.inverse @ side) / self.columns

    def _product(self, x: np.ndarray) -> np.ndarray:
        return np.ravel(self.jacobian @ (x * self.columns)) - self.shift * x

    def solve(self, side: np.ndarray) -> np.ndarray:
        """Apply the inverse to a vector."""
        right = self._precondition(np.ravel(side))
        found, gap = restarted(lambda x: self._precondition(self._product(x)), right, None, LINEAR.iterated)
        size = float(np.linalg.norm(right))
        self.unsolved |= not solved(gap, float(np.linalg.norm(found)) / size if size > 0.0 else 0.0)
        return found * self.columns


def nearest_eigenvalues(data: Equations, work: Linearised) -> np.ndarray:
    """Return the eigenvalues of F_u nearest to zero, relative to the sizes of rows and unknowns; a singular F_u is shifted first."""
    rows, units = data.sizes()
    values = np.zeros(0)
    for shift in (0.0, LINEAR.singular):
        inverse = Inverse(data, work, shift)
        values = nearest_sparse(inverse, csc_array(diags_array(rows / units)), len(rows)) + shift
        if np.isfinite(values).all() and not inverse.unsolved:
            break
    return values


class Solving(Protocol):
    """Factors of a matrix, or another object that solves linear systems with it."""

    def solve(self, sides: np.ndarray, /) -> np.ndarray: ...


def by_arpack(solve: Callable[..., Any], matrix: object, n: int, **options: Any) -> np.ndarray:
    """Return the eigenvalues that ARPACK (`solve`: eigs or eigsh) finds from a fixed start: the converged ones, none if it fails."""
    start = np.random.default_rng(5).standard_normal(n)
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        try:
            found = solve(matrix, v0=start, tol=LINEAR.eigenvalues, return_eigenvectors=False, **options)
        except ArpackNoConvergence as error:
            found = error.eigenvalues
        except RuntimeError:
            found = np.zeros(0)
    return np.asarray(found, dtype=complex)


def nearest_sparse(factors: Solving | None, reference: csc_array, n: int) -> np.ndarray:
    """Return the NEAREST eigenvalues to zero of reference^-1 F_u, as inverses of the largest eigenvalues of F_u^-1 reference.

    Parameters
    ----------
    factors
        Factors of F_u; None if it is singular.
    reference : sparse matrix, shape (n, n)
    n : int
    """
    if factors is None:
        return np.zeros(NEAREST, dtype=complex)
    operator = LinearOperator((n, n), matvec=lambda x: factors.solve(reference @ x), dtype=float)  # type: ignore[call-arg]
    found = by_arpack(eigs, operator, n, k=NEAREST)
    with np.errstate(all="ignore"):
        values = without_roundoff(1.0 / found)
    if not len(values):
        return np.full(NEAREST, np.nan, dtype=complex)
    values = values[np.argsort(np.abs(values), kind="stable")][:NEAREST]
    return np.append(values, np.full(NEAREST - len(values), values[-1]))
