"""Interpreted kernels with a dense Jacobian, for problems made of Python callables."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from scipy.linalg import get_lapack_funcs

from .abilities import Nearing
from .functions import NotEvaluable
from .interpreted import assign, inspect
from .kernels import Kernels
from .nearness import distance, nearest
from .spectra import reference_of, watched

# solves and hands out the factors (scipy's getrs starts threads for the smallest matrices)
(FACTORISE_AND_SOLVE,) = get_lapack_funcs(("gesv",), dtype=np.float64)


class DenseWork(NamedTuple):
    """F, F_u, F_p, and room for the bordered matrix with its right-hand sides.

    F_u and F_p are parts of ``system``, whose last row is zero. ``image`` is the solution of a third right-hand side where one is
    watched, in units of the scales: it tells how near the matrix is to a singular one. ``flat``, ``last``, ``column``, ``inner``,
    ``first``, ``second``, ``image`` and ``diagonal`` are views. Solutions take the place of the right-hand sides.
    """

    residual: np.ndarray
    jacobian: np.ndarray
    derivative: np.ndarray
    system: np.ndarray
    flat: np.ndarray
    matrix: np.ndarray
    last: np.ndarray
    diagonal: np.ndarray
    sides: np.ndarray
    first: np.ndarray
    second: np.ndarray
    sizes: np.ndarray
    rows: np.ndarray
    column: np.ndarray
    inner: np.ndarray
    image: np.ndarray
    order: np.ndarray
    ones: np.ndarray
    parts: np.ndarray


def dense_workspace(n: int, watched: bool = False) -> DenseWork:
    """Arrays for n equations; with a third right-hand side if that is watched."""
    size = n + 1
    system, matrix = np.zeros((size, size), order="F"), np.zeros((size, size), order="F")
    sides, rows = np.zeros((size, 3 if watched else 2), order="F"), np.zeros(size)
    return DenseWork(
        residual=np.zeros(n),
        jacobian=system[:n, :n],
        derivative=system[:n, n],
        system=system,
        flat=system.T.reshape(-1),
        matrix=matrix,
        last=matrix[-1],
        diagonal=matrix.T.reshape(-1)[:: size + 1],
        sides=sides,
        first=sides[:n, 0],
        second=sides[:n, 1],
        sizes=np.zeros((size, size), order="F"),
        rows=rows,
        column=rows[:, None],
        inner=rows[:n],
        image=sides[:, -1],
        order=np.arange(size, dtype=np.int32),
        ones=np.ones(size * size),
        parts=np.zeros(n),
    )


def workspace(problem: Any) -> DenseWork:
    """Arrays for a problem."""
    return dense_workspace(problem.dimension, isinstance(problem, Nearing) and problem.many)


def row_sizes(work: DenseWork, scale: np.ndarray) -> np.ndarray:
    """Largest change of each equation when an unknown changes by its scale."""
    return (np.abs(work.jacobian) * scale).max(axis=1)


def linearise(data: Any, u: np.ndarray, p: float, work: DenseWork) -> float:
    """Evaluate ``data.equations(u, p)`` -> (F, F_u, F_p) into the work arrays; the residual is relative to its rows."""
    scales = data.scales
    with np.errstate(all="ignore"):
        try:
            work.residual[:], work.jacobian[:], work.derivative[:] = data.equations(u, p)
        except NotEvaluable as error:
            data.trouble = str(error)
            return math.inf
        except (ArithmeticError, ValueError, np.linalg.LinAlgError):
            return math.inf
        sizes = np.abs(work.residual, out=work.parts)
        if scales is not None:
            np.divide(sizes, scales.rows, out=sizes)
        size = float(np.maximum.reduce(sizes))
        # a sum is finite if its terms are, but for an overflow, which would not do either
        total = float(work.flat @ work.ones)
    return size if size - size == 0.0 and total - total == 0.0 else math.inf


def bordered(
    data: Any, work: DenseWork, border: np.ndarray, n: float, step: np.ndarray, tangent: np.ndarray
) -> float:
    """Solve [[F_u, F_p], [border]] x = (-F, n) and (0, 1); returns the sign of the determinant.

    One factorisation, of the matrix with columns in units of the scales and rows made equally large.
    """
    size = len(work.residual)
    sides, rows = work.sides, work.rows
    scales = data.scales
    units = None if scales is None else scales.vector
    matrix = _equilibrated(work, border, units)
    # F and -n: the solution is -x
    np.divide(work.residual, work.inner, out=work.first)
    work.second[:] = 0.0
    last = float(rows[size])
    sides[size, 0], sides[size, 1] = -n / last, 1.0 / last
    if sides.shape[1] > 2:
        np.divide(data.side, rows, out=work.image)
    _, pivots, _, singular = FACTORISE_AND_SOLVE(matrix, sides, overwrite_a=1, overwrite_b=1)
    if not singular:
        odd = np.count_nonzero(work.diagonal < 0.0) + np.count_nonzero(pivots != work.order)
        sign = -1.0 if odd % 2 else 1.0
    else:
        sides[:], sign = _least(_equilibrated(work, border, units), sides), 0.0
    if scales is None or units is None:
        np.negative(sides[:, 0], out=step)
        tangent[:] = sides[:, 1]
    else:
        np.multiply(sides[:, 0], scales.negative, out=step)
        np.multiply(sides[:, 1], units, out=tangent)
    return sign


def _least(matrix: np.ndarray, sides: np.ndarray) -> np.ndarray:
    """Solutions with a singular matrix, large along its null vectors; NaN where it is not finite."""
    if not np.isfinite(matrix).all():
        return np.full(sides.shape, np.nan)
    left, values, right = np.linalg.svd(matrix)
    values = np.maximum(values, 1e-18 * max(values[0], 1e-200))
    with np.errstate(all="ignore"):
        return right.T @ ((left.T @ sides) / values[:, None])


def _equilibrated(work: DenseWork, border: np.ndarray, units: np.ndarray | None) -> np.ndarray:
    """The bordered matrix with columns in units of the scales and rows made equally large."""
    matrix, rows = work.matrix, work.rows
    if units is None:
        matrix[:] = work.system
        work.last[:] = border
    else:
        np.multiply(work.system, units, out=matrix)
        np.multiply(border, units, out=work.last)
    np.abs(matrix, out=work.sizes)
    np.maximum.reduce(work.sizes, axis=1, out=rows)
    if np.count_nonzero(rows) != len(rows):
        rows[rows == 0.0] = 1.0
    return np.divide(matrix, work.column, out=matrix)


def distance_to_singular(data: Any, work: DenseWork) -> float:
    """1/|M^-1 b| for the bordered matrix M that was solved with last; see :mod:`.nearness`."""
    return distance(work.image)


def nearest_eigenvalues(data: Any, work: DenseWork) -> np.ndarray:
    """The eigenvalues of F_u next to zero, relative to its value where that was asked for the first time."""
    if data.reference is None:
        rows, units = data.sizes()
        data.reference = reference_of(work.jacobian, rows, units)
    return nearest(watched(work.jacobian, data.reference))


def matrix(data: Any, work: DenseWork) -> np.ndarray:
    """F_u as it stands in a workspace."""
    return work.jacobian.copy()


def flip(data: Any, work: DenseWork, sign: float) -> None:
    """Turn the closure of a cycle round (sign = -1), and back (sign = 1); see the protocol."""
    data.turn_closure(work.jacobian, sign)


def transpose(data: Any, work: DenseWork, column: np.ndarray, other: DenseWork) -> None:
    """The transposed Jacobian, with another last column, into another workspace."""
    other.jacobian[:] = work.jacobian.T
    other.derivative[:] = column


KERNELS = Kernels(
    linearise,
    bordered,
    inspect,
    compiled=False,
    assign=assign,
    flip=flip,
    transpose=transpose,
    column=2,
    matrix=matrix,
)
