"""Kernels in Python with a sparse Jacobian: one sparse factorisation for each step.

With the factors of A = F_u the bordered system is solved by block elimination and iterative refinement. Next to a fold A is
nearly singular while the bordered matrix is not. If refinement does not converge there, the whole bordered matrix is factorised; its
last row is made small so that it is the last pivot and the factors stay sparse (about twice the work).

A LinearOperator is never factorised: GMRES solves the bordered system, with the user's preconditioner for A.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import scipy.sparse as sp
from scipy.sparse import csc_array
from scipy.sparse.linalg import LinearOperator, eigs, eigsh, splu

from ..dense import assign, inspect
from ..functions import NotEvaluable, Operator
from ..protocol import Kernels
from ..settings import LINEAR
from ..spectra import LARGEST, distance
from . import matrix_free
from .matrix_free import by_arpack, nearest_sparse
from .sparse_factors import Factors, Method, SuperLUFactors

if TYPE_CHECKING:
    from ..dense import Equations
    from ..protocol import Problem
    from .matrix_free import Bordered


SWEEPS = 8  # most refinements with the factors of an earlier Jacobian


class Elimination(NamedTuple):
    """A block elimination: factors of F_u, border, ``column`` = F_u^-1 F_p, and ``corner``, the Schur complement."""

    factors: Factors
    border: np.ndarray
    column: np.ndarray
    corner: float


@dataclass
class SparseWork:
    """F, F_u, F_p and the factors of F_u, which are computed on first use; `near` are the factors of the previous Jacobian, if `keep`."""

    residual: np.ndarray
    derivative: np.ndarray
    jacobian: csc_array | Operator = field(default_factory=lambda: csc_array((0, 0)))
    factors: Factors | None = None
    near: Factors | None = None
    keep: bool = True
    failed: bool = False
    method: Method = field(default_factory=Method)
    eliminated: Elimination | None = None  # the last block elimination
    iterated: Bordered | None = None  # the last bordered system of a matrix-free Jacobian
    distance: float = 1.0
    tangent: np.ndarray | None = None  # the last tangent of a matrix-free Jacobian: guess for the next one

    @property
    def matrix(self) -> csc_array:
        """The Jacobian, which must be a matrix."""
        assert not isinstance(self.jacobian, Operator)
        return self.jacobian

    def __getitem__(self, i: int) -> np.ndarray:
        return (self.residual, self.derivative)[i]


def workspace(problem: Problem) -> SparseWork:
    """Return the arrays for a problem."""
    # eigenvalues need the factors of the current Jacobian, so that those of an earlier one save nothing
    keep = problem.spectrum == "none"
    return SparseWork(np.zeros(problem.dimension), np.zeros(problem.dimension), keep=keep)


def row_sizes(work: SparseWork, scale: np.ndarray) -> np.ndarray:
    """Largest change of each equation when an unknown changes by its scale."""
    if isinstance(work.jacobian, Operator):
        return np.abs(work.jacobian @ scale)
    return np.asarray(abs(work.matrix).multiply(scale[None, :]).max(axis=1).todense()).reshape(-1)


def linearise(data: Equations, u: np.ndarray, p: float, work: SparseWork) -> float:
    """Evaluate ``data.equations(u, p)`` -> (F, F_u, F_p) into the work arrays; the residual is relative to its rows."""
    with np.errstate(all="ignore"):
        try:
            residual, jacobian, derivative = data.equations(u, p)
        except NotEvaluable as error:
            data.trouble = str(error)
            return math.inf
        work.residual[:], work.derivative[:] = residual, derivative
        if work.keep and work.factors is not None and work.factors.dear:
            work.near = work.factors
        work.factors, work.failed = None, False
        total = float(derivative.sum())
        assert not isinstance(jacobian, np.ndarray)
        if not isinstance(jacobian, Operator):
            jacobian = csc_array(jacobian, dtype=float, copy=True)
            total += float(jacobian.data.sum())
        work.jacobian = jacobian
        sizes = np.abs(residual)
        size = float((sizes if data.scales is None else sizes / data.scales.rows).max())
    return size if size - size == 0.0 and total - total == 0.0 else math.inf


# ---------------------------------------------------------------------- factors
def _factorise(work: SparseWork) -> Factors | None:
    """Factors of F_u; None if it is singular."""
    if work.factors is None and not work.failed:
        work.near = None  # to save memory, only one set of factors is kept
        try:
            work.factors = work.method.factorise(work.matrix)
        except RuntimeError:
            work.failed = True
    return work.factors


def _border_matrix(work: SparseWork, border: np.ndarray, factor: float) -> csc_array:
    return csc_array(
        sp.bmat(
            [
                [work.matrix, work.derivative[:, None]],
                [factor * border[None, :-1], np.array([[factor * border[-1]]])],
            ],
            format="csc",
        )
    )


def _product(work: SparseWork, border: np.ndarray, x: np.ndarray) -> np.ndarray:
    top = work.jacobian @ x[:-1] + np.outer(work.derivative, x[-1])
    return np.vstack([top, border @ x])


def _eliminate(work: SparseWork, border: np.ndarray, sides: np.ndarray) -> tuple[np.ndarray, float] | None:
    """Block elimination with refinement, first with the factors of an earlier Jacobian, then with new ones; None if it is not accurate."""
    if work.factors is None and work.near is not None:
        found = _refined(work, work.near, border, sides, LINEAR.gain, SWEEPS, LINEAR.reused)
        if found is not None:
            return found
    factors = _factorise(work)
    return None if factors is None else _refined(work, factors, border, sides, 0.5, 4, LINEAR.enough)


def _refined(
    work: SparseWork,
    factors: Factors,
    border: np.ndarray,
    sides: np.ndarray,
    shrink: float,
    sweeps: int,
    enough: float,
) -> tuple[np.ndarray, float] | None:
    """Block elimination with factors of F_u or of a matrix near it, and iterative refinement.

    Parameters
    ----------
    work, factors, border, sides
    shrink : float
        Each refinement must reduce the residual by this factor.
    sweeps : int
        Most refinements.
    enough : float
        Largest accepted relative residual.

    Returns
    -------
    (ndarray, float) or None
        Solutions and sign of the determinant; None if the residual is too large. The sign is that of the bordered matrix with the factored
        matrix in place of F_u. Since refinement converges, the ratio of the two determinants is positive. (Beyond a fold, the determinants of
        the factored matrix and of F_u alone may have different signs.)
    """
    with np.errstate(all="ignore"):
        columns = factors.solve(np.column_stack([sides[:-1, 0], work.derivative]))
        column = columns[:, 1]
        corner = border[-1] - border[:-1] @ column
        if corner == 0.0 or not np.isfinite(columns).all():
            return None
        x = np.empty((len(border), 2))
        x[-1, 0] = (sides[-1, 0] - border[:-1] @ columns[:, 0]) / corner
        x[:-1, 0] = columns[:, 0] - column * x[-1, 0]
        x[-1, 1] = sides[-1, 1] / corner
        x[:-1, 1] = -column * x[-1, 1]
        size = np.abs(sides).max(axis=0)
        size[size == 0.0] = 1.0
        scale = float(np.abs(work.matrix.data).max(initial=0.0))
        before = error = math.inf
        for _ in range(sweeps):
            residual = sides - _product(work, border, x)
            rough = np.abs(residual).max(axis=0) / np.maximum(size, scale * np.abs(x).max(axis=0))
            error = float(rough.max())
            if not error > LINEAR.refined or not error < shrink * before:
                break
            before = error
            more = factors.solve(residual[:-1])
            low = (residual[-1] - border[:-1] @ more) / corner
            x[-1] += low
            x[:-1] += more - np.outer(column, low)
        if not error < enough:
            return None
    work.eliminated = Elimination(factors, border.copy(), column, corner)
    return x, factors.sign * math.copysign(1.0, float(corner))


def _direct(work: SparseWork, border: np.ndarray, sides: np.ndarray) -> tuple[np.ndarray, float]:
    """Factorise the whole bordered matrix; return solutions and sign of the determinant (0: singular)."""
    top = float(np.abs(work.matrix.data).max(initial=1.0))
    factor = LINEAR.border * top / float(np.abs(border).max())
    scaled = sides.copy()
    scaled[-1] *= factor
    for shift in (0.0, LINEAR.shift * top):
        matrix = _border_matrix(work, border, factor)
        if shift:
            matrix = (matrix + shift * sp.identity(len(border), format="csc")).tocsc()
        try:
            factors = SuperLUFactors(matrix, work.method.ordering or "COLAMD")
        except RuntimeError:
            continue
        x = factors.solve(scaled)
        residual = scaled - matrix @ x
        more = factors.solve(residual)
        return (x + more if np.isfinite(more).all() else x), (0.0 if shift else factors.sign)
    return np.full_like(sides, np.nan), 0.0


def bordered(
    data: Equations, work: SparseWork, border: np.ndarray, n: float, step: np.ndarray, tangent: np.ndarray
) -> float:
    """Solve [[F_u, F_p], [border]] x = (-F, n) and (0, 1); return the sign of the determinant (1 if F_u is matrix-free)."""
    sides = np.zeros((len(border), 2))
    sides[:-1, 0] = -work.residual
    sides[-1] = n, 1.0
    if isinstance(work.jacobian, Operator):
        solution, work.iterated = matrix_free.iterate(data, work, border, sides, work.tangent)
        work.tangent = solution[:, 1] if np.isfinite(solution[:, 1]).all() else None
        sign = 1.0
    else:
        work.eliminated = None
        found = _eliminate(work, border, sides)
        solution, sign = _direct(work, border, sides) if found is None else found
    step[:], tangent[:] = solution[:, 0], solution[:, 1]
    return sign


# ---------------------------------------------------------------------- eigenvalues
def distance_to_singular(data: Equations, work: SparseWork) -> float:
    """Return 1/|M^-1 b| for the bordered matrix M of the last solution, without refinement; see :mod:`contvines.problems.spectra`."""
    if work.iterated is not None:
        found = matrix_free.distance_to_singular(data, work.iterated)
        work.distance = work.distance if found is None else found
        return work.distance
    if work.eliminated is None:
        return work.distance
    factors, border, column, corner = work.eliminated
    with np.errstate(all="ignore"):
        image = factors.solve(data.side[:-1])
        last = -float(border[:-1] @ image) / corner
        image = np.append(image - column * last, last)
        work.distance = distance(image if data.scales is None else image / data.scales.vector)
    return work.distance


def nearest_eigenvalues(data: Equations, work: SparseWork) -> np.ndarray:
    """Return the eigenvalues of F_u nearest to zero, relative to F_u at the first call (the reference)."""
    if isinstance(work.jacobian, Operator):
        return matrix_free.nearest_eigenvalues(data, work)
    factors, reference = _factorise(work), data.reference
    if reference is None:
        rows, units = data.sizes()
        reference = csc_array(sp.diags_array(rows / units)) if factors is None else work.matrix
        data.reference = reference
    assert not isinstance(reference, np.ndarray)
    return nearest_sparse(factors, reference, len(work.residual))


def leading(data: Equations, work: SparseWork, count: int, shift: float) -> np.ndarray:
    """Return the eigenvalues of F_u nearest to a shift, by ARPACK in shift-invert mode; if the shift is 0, with the existing factors.

    A matrix-free F_u is inverted by GMRES with the user's preconditioner; without a preconditioner the rightmost eigenvalues are
    computed instead.

    Parameters
    ----------
    data : AlgebraicProblem
    work : SparseWork
    count : int
    shift : float

    Returns
    -------
    ndarray of complex, shape (count,)
        If ARPACK finds fewer, the leftmost one is repeated.
    """
    matrix, n = work.jacobian, len(work.residual)
    if count >= n - 1:
        values = np.linalg.eigvals(matrix @ np.eye(n) if isinstance(matrix, Operator) else matrix.toarray())
        order = np.argsort(np.abs(values - shift), kind="stable")
        return values[order][:count]
    options: dict[str, Any] = {"k": count}
    solve = eigs
    if not isinstance(matrix, Operator):
        factors = _factorise(work) if shift == 0.0 else None
        if (abs(matrix - matrix.T)).max() == 0.0:
            solve = eigsh
        options["sigma"] = shift if shift != 0.0 or factors is not None else LINEAR.shift * abs(matrix).max()
        if factors is not None:
            options["OPinv"] = LinearOperator((n, n), matvec=factors.solve, dtype=float)  # type: ignore[call-arg]
    elif data.preconditioner_at() is not None:
        inverse = matrix_free.Inverse(data, work, shift, plain=True)
        options["OPinv"], options["sigma"] = LinearOperator((n, n), matvec=inverse.solve, dtype=float), shift  # type: ignore[call-arg]
    else:
        options["which"] = "LR"
    values = by_arpack(solve, matrix, n, **options)
    if not len(values):
        return np.full(count, np.nan, dtype=complex)
    values = values[np.argsort(np.abs(values - shift), kind="stable")][:count]
    return np.append(values, np.full(count - len(values), values[np.argmin(np.real(values))]))


def eigenvectors(matrix: csc_array | Operator, values: np.ndarray) -> np.ndarray:
    """Return unit eigenvectors as columns, in the order of the given eigenvalues, by inverse iteration.

    Raises
    ------
    ValueError
        If the matrix is a LinearOperator.
    """
    if isinstance(matrix, Operator):
        raise ValueError(
            "a matrix-free Jacobian has no factors, so eigenvectors cannot be obtained from its eigenvalues"
        )
    n = len(matrix.indptr) - 1
    size = float(abs(matrix).max())
    columns = []
    for k, value in enumerate(np.asarray(values, dtype=complex)):
        near = value + LINEAR.offset * size * (1.0 + 0.3j)
        factors = splu((matrix - near * sp.identity(n)).tocsc().astype(complex))
        vector = np.random.default_rng(k).standard_normal(n).astype(complex)
        for _ in range(3):
            vector = factors.solve(vector)
            vector /= np.linalg.norm(vector)
        columns.append(vector)
    return np.array(columns).T.reshape(n, len(columns))


def transpose(data: Equations, work: SparseWork, column: np.ndarray, other: SparseWork) -> None:
    """Write the transposed Jacobian, and another last column, into another workspace."""
    if isinstance(work.jacobian, Operator):
        raise ValueError(
            "loci need the transposed Jacobian: give it as an array or a sparse matrix, not as a LinearOperator"
        )
    other.jacobian, other.factors, other.failed = work.matrix.T.tocsc(), None, False
    other.derivative[:] = column


def matrix(data: Equations, work: SparseWork) -> np.ndarray:
    """Return F_u of a workspace as a dense array."""
    if len(work.residual) > LARGEST or isinstance(work.jacobian, Operator):
        raise ValueError(f"it needs the matrix of F_u, of up to {LARGEST} unknowns")
    return work.matrix.toarray()


KERNELS = Kernels(
    linearise, bordered, inspect, compiled=False, assign=assign, transpose=transpose, column=1, matrix=matrix
)  # fmt: skip
