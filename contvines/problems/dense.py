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
    """F, F_u, F_p, the bordered matrix with its right-hand sides, and scratch.

    ``images`` are the solutions: step, tangent, and, where a third side is watched, what tells how near the matrix is to a singular one.
    """

    residual: np.ndarray
    jacobian: np.ndarray
    derivative: np.ndarray
    matrix: np.ndarray
    sides: np.ndarray
    images: np.ndarray
    sizes: np.ndarray
    rows: np.ndarray
    order: np.ndarray
    ones: np.ndarray


def dense_workspace(n: int, watched: bool = False) -> DenseWork:
    """Arrays for n equations; with a third right-hand side if that is watched."""
    count = 3 if watched else 2
    return DenseWork(
        np.zeros(n),
        np.zeros((n, n)),
        np.zeros(n),
        np.zeros((n + 1, n + 1), order="F"),
        np.zeros((n + 1, count), order="F"),
        np.zeros((n + 1, count), order="F"),
        np.zeros((n + 1, n + 1), order="F"),
        np.zeros(n + 1),
        np.arange(n + 1),
        np.ones(n),
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
        sizes = np.abs(work.residual)
        if scales is not None:
            sizes /= scales.rows
        size = float(np.maximum.reduce(sizes))
        # a sum is finite if its terms are, but for an overflow, which would not do either
        total = float(work.ones @ (work.jacobian @ work.ones + work.derivative))
    return size if size - size == 0.0 and total - total == 0.0 else math.inf


def bordered(
    data: Any, work: DenseWork, border: np.ndarray, n: float, step: np.ndarray, tangent: np.ndarray
) -> float:
    """Solve [[F_u, F_p], [border]] x = (-F, n) and (0, 1); returns the sign of the determinant.

    One factorisation, of the matrix with columns in units of the scales and rows made equally large.
    """
    size = len(work.residual)
    matrix, sides, rows = work.matrix, work.sides, work.rows
    scales = data.scales
    units = None if scales is None else scales.vector
    with np.errstate(all="ignore"):
        matrix[:size, :size] = work.jacobian
        matrix[:size, size] = work.derivative
        matrix[size] = border
        if units is not None:
            matrix *= units
        np.abs(matrix, out=work.sizes)
        np.maximum.reduce(work.sizes, axis=1, out=rows)
        if not rows.all():
            rows[rows == 0.0] = 1.0
        matrix /= rows[:, None]
        sides[:size, 0] = work.residual
        sides[size, 0] = -n
        sides[:size, 1] = 0.0
        sides[size, 1] = -1.0
        if sides.shape[1] > 2:
            sides[:, 2] = data.side
        sides /= -rows[:, None]
        factors, pivots, solution, singular = FACTORISE_AND_SOLVE(matrix, sides)
        if not singular:
            odd = np.count_nonzero(factors.diagonal() < 0.0) + np.count_nonzero(pivots != work.order)
            sign = -1.0 if odd % 2 else 1.0
        else:
            left, values, right = np.linalg.svd(matrix)
            values = np.maximum(values, 1e-18 * max(values[0], 1e-200))
            solution = right.T @ ((left.T @ sides) / values[:, None])
            sign = 0.0
        if units is None:
            work.images[:] = solution
        else:
            np.multiply(solution, units[:, None], out=work.images)
    step[:] = work.images[:, 0]
    tangent[:] = work.images[:, 1]
    return sign


def distance_to_singular(data: Any, work: DenseWork) -> float:
    """1/|M^-1 b| for the bordered matrix M that was solved with last; see :mod:`.nearness`."""
    return distance(work.images[:, -1], None if data.scales is None else data.scales.vector)


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
