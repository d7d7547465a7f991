"""Interpreted kernels with a dense Jacobian, for problems made of Python callables."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np
from scipy.linalg import get_lapack_funcs

from contvines.shared.floating_point import LEAST

from .abilities import Nearing
from .blas import dot, position
from .functions import NotEvaluable
from .interpreted import assign, inspect, not_finite
from .nearness import distance, nearest
from .protocol import Kernels
from .spectra import reference_of, watched

if TYPE_CHECKING:
    from .interpreted import Equations
    from .protocol import Problem
    from .scales import Scales

# solves and hands out the factors (scipy's getrs starts threads for the smallest matrices); 1 / largest entry of each row
FACTORISE_AND_SOLVE, ROWS = get_lapack_funcs(("gesv", "geequ"), dtype=np.float64)
EVEN = 0.1  # rows whose sizes differ by less than this are left as they are; LAPACK's own threshold (dlaqge)


class Units:
    """What the entries of the table of a workspace are multiplied with, made anew when the scales of a problem change."""

    def __init__(self) -> None:
        self.scales: Scales | Units | None = self  # none yet
        self.table = self.columns = self.negative = self.rows = np.ones(0)

    def take(self, data: Equations, work: DenseWork) -> None:
        """Those of a problem as it is now; the right-hand side that is watched comes with them."""
        size = len(work.last)
        scales = self.scales = data.scales
        rows, columns = (np.ones(size - 1), np.ones(size)) if scales is None else (scales.rows, scales.vector)
        self.rows, self.columns, self.negative = rows, columns, -columns
        self.table = np.ones(work.table.shape, order="F")
        self.table[:, :size] = columns
        self.table[:-1] /= rows[:, None]
        if work.table.shape[1] > size + 2:
            work.table[:, -1] = data.side


@dataclass(eq=False, slots=True)
class DenseWork:
    """F, F_u, F_p, and room for the bordered matrix with its right-hand sides.

    F_u, F_p and F are parts of ``table``, whose last row is zero: (F_u, F_p | F, 0). A third right-hand side is watched where it is
    there: ``image`` is its solution, in units of the scales, and tells how near the matrix is to a singular one. ``matrix`` is the
    same in units of the scales, with the border as last row; ``square``, ``last``, ``diagonal`` and ``sides`` are parts of it.
    Solutions take the place of the right-hand sides.
    """

    residual: np.ndarray
    jacobian: np.ndarray
    derivative: np.ndarray
    table: np.ndarray
    flat: np.ndarray
    matrix: np.ndarray
    square: np.ndarray
    last: np.ndarray
    diagonal: np.ndarray
    sides: np.ndarray
    ends: np.ndarray
    image: np.ndarray
    order: np.ndarray
    odd: np.ndarray
    negative: np.ndarray
    swapped: np.ndarray
    ones: np.ndarray
    parts: np.ndarray
    units: Units

    def __getitem__(self, i: int) -> np.ndarray:
        return (self.residual, self.jacobian, self.derivative)[i]


def dense_workspace(n: int, watched: bool = False) -> DenseWork:
    """Arrays for n equations; with a third right-hand side if that is watched."""
    size = n + 1
    table, matrix = np.zeros((2, size + (3 if watched else 2), size))
    table, matrix = table.T, matrix.T
    odd = np.zeros(2 * size, dtype=bool)
    return DenseWork(
        residual=table[:n, size],
        jacobian=table[:n, :n],
        derivative=table[:n, n],
        table=table,
        flat=table.T.reshape(-1),
        matrix=matrix,
        square=matrix[:, :size],
        last=matrix[-1, :size],
        diagonal=matrix.T.reshape(-1)[: size * size : size + 1],
        sides=matrix[:, size:],
        ends=matrix[-1, size:],
        image=matrix[:, -1],
        order=np.arange(size, dtype=np.int32),
        odd=odd,
        negative=odd[:size],
        swapped=odd[size:],
        ones=np.ones(table.size),
        parts=np.zeros(n),
        units=Units(),
    )


def workspace(problem: Problem) -> DenseWork:
    """Arrays for a problem."""
    return dense_workspace(problem.dimension, isinstance(problem, Nearing) and problem.many)


def row_sizes(work: DenseWork, scale: np.ndarray) -> np.ndarray:
    """Largest change of each equation when an unknown changes by its scale."""
    return (np.abs(work.jacobian) * scale).max(axis=1)


def linearise(data: Equations, u: np.ndarray, p: float, work: DenseWork) -> float:
    """Evaluate ``data.equations(u, p)`` -> (F, F_u, F_p) into the work arrays; the residual is relative to its rows."""
    units = work.units
    if units.scales is not data.scales:
        units.take(data, work)
    with np.errstate(all="ignore"):
        try:
            work.residual[:], work.jacobian[:], work.derivative[:] = data.equations(u, p)
        except NotEvaluable as error:
            data.trouble = str(error)
            return math.inf
        except (ArithmeticError, ValueError, np.linalg.LinAlgError):
            return math.inf
        sizes = np.divide(work.residual, units.rows, out=work.parts)
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
    units, sides = work.units, work.sides
    if units.scales is not data.scales:
        units.take(data, work)
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
    np.multiply(sides[:, 0], units.negative, out=step)
    np.multiply(sides[:, 1], units.columns, out=tangent)
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
    np.multiply(work.table, work.units.table, out=work.matrix)
    np.multiply(border, work.units.columns, out=last)
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
    """1/|M^-1 b| for the bordered matrix M that was solved with last; see :mod:`.nearness`."""
    return distance(work.image)


def nearest_eigenvalues(data: Equations, work: DenseWork) -> np.ndarray:
    """The eigenvalues of F_u next to zero, relative to its value where that was asked for the first time."""
    if not isinstance(data.reference, np.ndarray):
        rows, units = data.sizes()
        data.reference = reference_of(work.jacobian, rows, units)
    return nearest(watched(work.jacobian, data.reference))


def matrix(data: Equations, work: DenseWork) -> np.ndarray:
    """F_u as it stands in a workspace."""
    return work.jacobian.copy()


class Cyclic(Protocol):
    """What `flip` reads of the problem of the cycles of a map."""

    def turn_closure(self, jacobian: np.ndarray, sign: float) -> None: ...


def flip(data: Cyclic, work: DenseWork, sign: float) -> None:
    """Turn the closure of a cycle round (sign = -1), and back (sign = 1); see the protocol."""
    data.turn_closure(work.jacobian, sign)


def transpose(data: Equations, work: DenseWork, column: np.ndarray, other: DenseWork) -> None:
    """The transposed Jacobian, with another last column, into another workspace."""
    other.jacobian[:] = work.jacobian.T
    other.derivative[:] = column


KERNELS = Kernels(
    linearise, bordered, inspect, compiled=False, assign=assign, flip=flip, transpose=transpose, column=2, matrix=matrix
)  # fmt: skip
