"""Interpreted kernels with a dense Jacobian, for problems made of Python callables."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from scipy.linalg import get_lapack_funcs

from .functions import NotEvaluable
from .kernels import Kernels

# solves and hands out the factors (scipy's getrs starts threads for the smallest matrices)
(FACTORISE_AND_SOLVE,) = get_lapack_funcs(("gesv",), dtype=np.float64)


class DenseWork(NamedTuple):
    """F, F_u, F_p and the bordered matrix with its two right-hand sides."""

    residual: np.ndarray
    jacobian: np.ndarray
    derivative: np.ndarray
    matrix: np.ndarray
    sides: np.ndarray


def dense_workspace(n: int) -> DenseWork:
    """Arrays for n equations."""
    return DenseWork(
        np.zeros(n),
        np.zeros((n, n)),
        np.zeros(n),
        np.zeros((n + 1, n + 1), order="F"),
        np.zeros((n + 1, 2), order="F"),
    )


def workspace(problem: Any) -> DenseWork:
    """Arrays for a problem."""
    return dense_workspace(problem.dimension)


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
        size = float((sizes if scales is None else sizes / scales.rows).max())
        # a sum is finite if its terms are, but for an overflow, which would not do either
        total = float(work.jacobian.sum() + work.derivative.sum())
    return size if size - size == 0.0 and total - total == 0.0 else math.inf


def bordered(
    data: Any, work: DenseWork, border: np.ndarray, n: float, step: np.ndarray, tangent: np.ndarray
) -> float:
    """Solve [[F_u, F_p], [border]] x = (-F, n) and (0, 1); returns the sign of the determinant.

    One factorisation, of the matrix with columns in units of the scales and rows made equally large.
    """
    size = len(work.residual)
    matrix, sides = work.matrix, work.sides
    scales = data.scales
    matrix[:size, :size] = work.jacobian
    matrix[:size, size] = work.derivative
    matrix[size] = border
    units = None
    if scales is not None:
        units = scales.joined()
        matrix *= units
    with np.errstate(all="ignore"):
        rows = np.abs(matrix).max(axis=1)
        rows[~(rows > 0.0)] = 1.0
        matrix /= rows[:, None]
        sides[:size, 0] = -work.residual
        sides[size, 0] = n
        sides[:size, 1] = 0.0
        sides[size, 1] = 1.0
        sides /= rows[:, None]
        factors, pivots, solution, singular = FACTORISE_AND_SOLVE(matrix, sides)
        diagonal = factors.diagonal()
        if not singular:
            swaps = int((pivots != np.arange(size + 1)).sum())
            sign = -1.0 if (int((diagonal < 0.0).sum()) + swaps) % 2 else 1.0
        else:
            left, values, right = np.linalg.svd(matrix)
            values = np.maximum(values, 1e-18 * max(values[0], 1e-200))
            solution = right.T @ ((left.T @ sides) / values[:, None])
            sign = 0.0
        if units is not None:
            solution = solution * units[:, None]
    step[:] = solution[:, 0]
    tangent[:] = solution[:, 1]
    return sign


def inspect(data: Any, u: np.ndarray, p: float, work: DenseWork, row: np.ndarray) -> None:
    """Raw spectrum of the linearisation, then the margins of problems that have any."""
    spectrum = data.raw_spectrum(work)
    m = 2 * len(spectrum)
    row[0:m:2] = spectrum.real
    row[1:m:2] = spectrum.imag
    if len(row) > m:
        row[m:] = data.margins(u, p)


def matrix(data: Any, work: DenseWork) -> np.ndarray:
    """F_u as it stands in a workspace."""
    return work.jacobian.copy()


def assign(data: Any, other: Any, value: float) -> None:
    """Give the parameter that varies in ``other`` a value in ``data``, in place."""
    data.values.assign(other.parameter, value)


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
