"""Interpreted kernels with a dense Jacobian, for problems made of Python callables; and what those with a sparse one share with them."""

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


# solves and hands out the factors (scipy's getrs starts threads for the smallest matrices); 1 / largest entry of each row
FACTORISE_AND_SOLVE, ROWS = get_lapack_funcs(("gesv", "geequ"), dtype=np.float64)
EVEN = 0.1  # rows whose sizes differ by less than this are left as they are; LAPACK's own threshold (dlaqge)


# BLAS for short vectors, at every point: numpy's own functions take three times as long
dot = blas.ddot  # type: ignore[attr-defined]
"""``dot(x, y, n)``: the inner product (of the first n entries)."""
position = blas.idamax  # type: ignore[attr-defined]
"""``position(x)``: where the largest absolute value stands."""


class Equations(Protocol):
    """What the kernels read of a problem made of Python callables, their `data`."""

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
    """F, F_u, F_p, and room for the bordered matrix with its right-hand sides.

    F_u, F_p and F are parts of ``table``, whose last row is zero: (F_u, F_p | F, 0). A third right-hand side is watched where it is
    there: ``image`` is its solution, in units of the scales, and tells how near the matrix is to a singular one. ``matrix`` is the
    same in units of the scales, with the border as last row; ``square``, ``last``, ``diagonal`` and ``sides`` are parts of it.
    Solutions take the place of the right-hand sides. Units are made anew when the scales of a problem change (`take_units`).

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
        """What the entries of ``table`` are multiplied with, of a problem as it is now; the right-hand side that is watched comes with them."""
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
    """Arrays for a problem."""
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
    # a sum is finite if its terms are, but for an overflow, which would not do either
    total = dot(work.flat, work.ones)
    if total - total == 0.0:
        return abs(float(sizes[position(sizes)]))
    data.trouble = not_finite(work.residual, work.jacobian, work.derivative)
    return math.inf


def bordered(
    data: Equations, work: DenseWork, border: np.ndarray, n: float, step: np.ndarray, tangent: np.ndarray
) -> float:
    """Solve [[F_u, F_p], [border]] x = (-F, n) and (0, 1); returns the sign of the determinant.

    One factorisation, of the matrix in units of the scales, with rows made equally large where they are not.
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
    """Solutions with a singular matrix, large along its null vectors; NaN where it is not finite."""
    if not np.isfinite(matrix).all():
        return np.full(sides.shape, np.nan)
    left, values, right = np.linalg.svd(matrix)
    values = np.maximum(values, LEAST * values[0])
    with np.errstate(all="ignore"):
        return right.T @ ((left.T @ sides) / values[:, None])


def _equilibrate(work: DenseWork, border: np.ndarray, n: float) -> None:
    """The bordered matrix and its right-hand sides (F, -n) and (0, 1), with rows of about one size."""
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
    """1/|M^-1 b| for the bordered matrix M that was solved with last; see :mod:`.spectra`."""
    return distance(work.image)


def nearest_eigenvalues(data: Equations, work: DenseWork) -> np.ndarray:
    """The eigenvalues of F_u next to zero, relative to its value where that was asked for the first time."""
    if not isinstance(data.reference, np.ndarray):
        data.reference = reference_of(work.jacobian, *data.sizes())
    values = without_roundoff(np.linalg.eigvals(data.reference @ work.jacobian))
    if len(values) > data.n_multipliers:
        values = values[np.argsort(np.abs(values), kind="stable")][: data.n_multipliers]
    return values


def matrix(data: Equations, work: DenseWork) -> np.ndarray:
    """F_u as it stands in a workspace."""
    return work.jacobian.copy()


def flip(data: Any, work: DenseWork, sign: float) -> None:
    """Turn the closure of a cycle round (sign = -1), and back (sign = 1); see the protocol."""
    data.turn_closure(work.jacobian, sign)


def transpose(data: Equations, work: DenseWork, column: np.ndarray, other: DenseWork) -> None:
    """The transposed Jacobian, with another last column, into another workspace."""
    other.jacobian[:] = work.jacobian.T
    other.derivative[:] = column


def inspect(data: Equations, u: np.ndarray, p: float, work: Linearised, row: np.ndarray) -> None:
    """Raw spectrum of the linearisation, then the margins of problems that have any."""
    spectrum = data.raw_spectrum(work)
    m = 2 * len(spectrum)
    row[:m].view(np.complex128)[:] = spectrum
    if len(row) > m:
        row[m:] = data.margins(u, p)


def not_finite(residual: np.ndarray, jacobian: np.ndarray, derivative: np.ndarray) -> str:
    """A sentence on what is not a finite number, and in which row."""
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
    """Give the parameter that varies in ``other`` a value in ``data``, in place."""
    data.values.assign(other.parameter, value)


KERNELS = Kernels(
    linearise, bordered, inspect, compiled=False, assign=assign, flip=flip, transpose=transpose, column=2, matrix=matrix
)  # fmt: skip
