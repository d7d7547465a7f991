"""Kernels in Python with a dense Jacobian, for problems made of Python callables; `inspect` and `assign` serve sparse Jacobians, too."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from scipy.linalg import blas, get_lapack_funcs

from contvines.shared.numbers import LEAST

from .abilities import Linearised, Nearing
from .functions import NotEvaluable
from .protocol import Kernels
from .spectra import distance, reference_of, without_roundoff

if TYPE_CHECKING:
    from scipy.sparse import csc_array

    from .functions import Operator, ParameterSet
    from .protocol import Problem
    from .scales import Scales


# gesv solves and returns the factors (scipy's getrs starts threads even for small matrices); geequ returns 1 / largest entry of each row
FACTORISE_AND_SOLVE, ROWS = get_lapack_funcs(("gesv", "geequ"), dtype=np.float64)
EVEN = 0.1  # smallest ratio of row sizes at which rows are not scaled; LAPACK's own threshold (dlaqge)


# BLAS functions for short vectors: numpy's take three times as long, and these are called at every point
dot = blas.ddot  # type: ignore[attr-defined]
"""``dot(x, y, n)``: the inner product (of the first n entries)."""
position = blas.idamax  # type: ignore[attr-defined]
"""``position(x)``: index of the largest absolute value."""


class Equations(Protocol):
    """The `data` of these kernels: members of a problem made of Python callables that they read."""

    values: ParameterSet
    scales: Scales | None
    reference: np.ndarray | csc_array | None
    trouble: str
    unsolved: bool
    n_multipliers: int

    @property
    def parameter(self) -> str: ...
    @property
    def side(self) -> np.ndarray: ...
    def preconditioner_at(self) -> np.ndarray | Operator | None: ...
    def equations(
        self, u: np.ndarray, p: float
    ) -> tuple[np.ndarray, np.ndarray | csc_array | Operator, np.ndarray]: ...
    def sizes(self) -> tuple[np.ndarray, np.ndarray]: ...
    def raw_spectrum(self, work: Linearised) -> np.ndarray: ...
    def margins(self, u: np.ndarray, p: float) -> np.ndarray: ...


class DenseWork:
    """F, F_u, F_p, and the bordered matrix with its right-hand sides.

    ``table`` contains F_u, F_p and F, and a last row of zeros: (F_u, F_p | F, 0). ``matrix`` is the same in units of the scales, with
    the border as last row; ``square``, ``last``, ``diagonal`` and ``sides`` are views of its parts. Solutions overwrite the right-hand
    sides. If `watched`, there is a third right-hand side (`Equations.side`); its solution ``image``, in units of the scales, measures how
    near the matrix is to a singular one. `take_units` updates the units when the scales of the problem change.

    Parameters
    ----------
    n : int
        Number of equations.
    watched : bool
        Whether there is a third right-hand side.
    """

    def __init__(self, n: int, watched: bool = False) -> None:
        size = n + 1
        table, matrix = np.zeros((2, size + (3 if watched else 2), size))
        self.table, self.matrix = table, matrix = table.T, matrix.T
        self.jacobian: np.ndarray = table[:n, :n]
        self.residual, self.derivative = table[:n, size], table[:n, n]
        self.flat = table.T.reshape(-1)
        self.square, self.sides = matrix[:, :size], matrix[:, size:]
        self.last, self.ends = matrix[-1, :size], matrix[-1, size:]
        self.image = matrix[:, -1]
        self.diagonal = matrix.T.reshape(-1)[: size * size : size + 1]
        self.order = np.arange(size, dtype=np.int32)
        self.odd = np.zeros(2 * size, dtype=bool)
        self.negative, self.swapped = self.odd[:size], self.odd[size:]
        self.ones, self.parts = np.ones(table.size), np.zeros(n)
        self.scales: Scales | DenseWork | None = self  # none yet
        self.units = self.columns = self.minus_columns = self.rows = np.ones(0)

    def __getitem__(self, i: int) -> np.ndarray:
        return (self.residual, self.jacobian, self.derivative)[i]

    def take_units(self, data: Equations) -> None:
        """Compute the factors of the entries of ``table`` from the problem's scales, and set the third right-hand side."""
        size = len(self.last)
        scales = self.scales = data.scales
        rows, columns = (np.ones(size - 1), np.ones(size)) if scales is None else (scales.rows, scales.vector)
        self.rows, self.columns, self.minus_columns = rows, columns, -columns
        self.units = np.ones(self.table.shape, order="F")
        self.units[:, :size] = columns
        self.units[:-1] /= rows[:, None]
        if self.table.shape[1] > size + 2:
            self.table[:, -1] = data.side


def workspace(problem: Problem) -> DenseWork:
    """Return the arrays for a problem."""
    return DenseWork(problem.dimension, isinstance(problem, Nearing) and problem.many)


def row_sizes(work: DenseWork, scale: np.ndarray) -> np.ndarray:
    """Largest change of each equation when an unknown changes by its scale."""
    return (np.abs(work.jacobian) * scale).max(axis=1)


def linearise(data: Equations, u: np.ndarray, p: float, work: DenseWork) -> float:
    """Evaluate ``data.equations(u, p)`` -> (F, F_u, F_p) into the work arrays; the residual is relative to its rows."""
    if work.scales is not data.scales:
        work.take_units(data)
    with np.errstate(all="ignore"):
        try:
            work.residual[:], work.jacobian[:], work.derivative[:] = data.equations(u, p)
        except NotEvaluable as error:
            data.trouble = str(error)
            return math.inf
        except (ArithmeticError, ValueError, np.linalg.LinAlgError):
            return math.inf
        sizes = np.divide(work.residual, work.rows, out=work.parts)
    # the sum is finite if and only if all entries are, apart from overflow, which counts as a failure, too
    total = dot(work.flat, work.ones)
    if total - total == 0.0:
        return abs(float(sizes[position(sizes)]))
    data.trouble = not_finite(work.residual, work.jacobian, work.derivative)
    return math.inf


def bordered(
    data: Equations, work: DenseWork, border: np.ndarray, n: float, step: np.ndarray, tangent: np.ndarray
) -> float:
    """Solve [[F_u, F_p], [border]] x = (-F, n) and (0, 1); return the sign of the determinant.

    One factorisation serves both. The matrix is in units of the scales, with its rows scaled to equal size if they differ.
    """
    sides = work.sides
    if work.scales is not data.scales:
        work.take_units(data)
    _equilibrate(work, border, n)
    _, pivots, _, singular = FACTORISE_AND_SOLVE(work.square, sides, overwrite_a=1, overwrite_b=1)
    if not singular:
        np.less(work.diagonal, 0.0, out=work.negative)
        np.not_equal(pivots, work.order, out=work.swapped)
        sign = -1.0 if np.count_nonzero(work.odd) % 2 else 1.0
    else:
        _equilibrate(work, border, n)
        sides[:], sign = _least(work.square, sides), 0.0
    # with F and -n on the right the solution is -x
    np.multiply(sides[:, 0], work.minus_columns, out=step)
    np.multiply(sides[:, 1], work.columns, out=tangent)
    return sign


def _least(matrix: np.ndarray, sides: np.ndarray) -> np.ndarray:
    """Solutions for a singular matrix, large along its null vectors; NaN if the matrix is not finite."""
    if not np.isfinite(matrix).all():
        return np.full(sides.shape, np.nan)
    left, values, right = np.linalg.svd(matrix)
    values = np.maximum(values, LEAST * values[0])
    with np.errstate(all="ignore"):
        return right.T @ ((left.T @ sides) / values[:, None])


def _equilibrate(work: DenseWork, border: np.ndarray, n: float) -> None:
    """Write the bordered matrix and its right-hand sides (F, -n) and (0, 1) into the workspace, with rows of similar size."""
    last, ends = work.last, work.ends
    np.multiply(work.table, work.units, out=work.matrix)
    np.multiply(border, work.columns, out=last)
    size = abs(float(last[position(last)])) or 1.0
    np.divide(last, size, out=last)
    ends[0], ends[1] = -n / size, 1.0 / size
    factors, _, ratio, _, _, failed = ROWS(work.square)
    if not ratio >= EVEN or failed:
        if 0 < failed <= len(last):  # a row of zeros
            rows = np.abs(work.square).max(axis=1)
            rows[rows == 0.0] = 1.0
            factors = 1.0 / rows
        np.multiply(work.matrix, factors[:, None], out=work.matrix)


def distance_to_singular(data: Equations, work: DenseWork) -> float:
    """Return 1/|M^-1 b| for the bordered matrix M of the last solution; see :mod:`.spectra`."""
    return distance(work.image)


def nearest_eigenvalues(data: Equations, work: DenseWork) -> np.ndarray:
    """Return the eigenvalues of F_u nearest to zero, relative to F_u at the first call (the reference)."""
    if not isinstance(data.reference, np.ndarray):
        data.reference = reference_of(work.jacobian, *data.sizes())
    values = without_roundoff(np.linalg.eigvals(data.reference @ work.jacobian))
    if len(values) > data.n_multipliers:
        values = values[np.argsort(np.abs(values), kind="stable")][: data.n_multipliers]
    return values


def matrix(data: Equations, work: DenseWork) -> np.ndarray:
    """Return a copy of F_u in a workspace."""
    return work.jacobian.copy()


def flip(data: Any, work: DenseWork, sign: float) -> None:
    """Change the closure x_n = x_0 of a cycle in F_u to x_n = -x_0 (sign = -1), or back (sign = 1); see the protocol."""
    data.turn_closure(work.jacobian, sign)


def transpose(data: Equations, work: DenseWork, column: np.ndarray, other: DenseWork) -> None:
    """Write the transposed Jacobian, and another last column, into another workspace."""
    other.jacobian[:] = work.jacobian.T
    other.derivative[:] = column


def inspect(data: Equations, u: np.ndarray, p: float, work: Linearised, row: np.ndarray) -> None:
    """Write the raw spectrum of the linearisation into `row`, then the margins if the problem has any."""
    spectrum = data.raw_spectrum(work)
    m = 2 * len(spectrum)
    row[:m].view(np.complex128)[:] = spectrum
    if len(row) > m:
        row[m:] = data.margins(u, p)


def not_finite(residual: np.ndarray, jacobian: np.ndarray, derivative: np.ndarray) -> str:
    """Return a sentence with the first of F, F_u and F_p that is not finite, and the row."""
    names = (
        ("F", residual),
        ("the derivative of F in the unknowns", jacobian),
        ("the one in the parameter", derivative),
    )
    for name, values in names:
        bad = ~np.isfinite(values if values.ndim == 1 else values.sum(axis=1))
        if bad.any():
            return f"{name} is not finite in row {int(np.argmax(bad))}"
    return ""


def assign(data: Equations, other: Equations, value: float) -> None:
    """Set, in ``data`` and in place, the parameter that varies in ``other``."""
    data.values.assign(other.parameter, value)


KERNELS = Kernels(
    linearise, bordered, inspect, compiled=False, assign=assign, flip=flip, transpose=transpose, column=2, matrix=matrix
)  # fmt: skip
