"""Interpreted kernels with a dense Jacobian, for problems made of Python callables."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from .protocol import Kernels


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
        np.zeros(n), np.zeros((n, n)), np.zeros(n), np.zeros((n + 1, n + 1)), np.zeros((n + 1, 2))
    )


def linearise(data: Any, u: np.ndarray, p: float, work: DenseWork) -> float:
    """Evaluate ``data.equations(u, p)`` -> (F, F_u, F_p) into the work arrays."""
    with np.errstate(all="ignore"):
        try:
            work.residual[:], work.jacobian[:], work.derivative[:] = data.equations(u, p)
        except (ArithmeticError, ValueError, np.linalg.LinAlgError):
            return math.inf
        size = float(np.abs(work.residual).max())
        if not (np.isfinite(work.jacobian).all() and np.isfinite(work.derivative).all()):
            return math.inf
    return size if size == size else math.inf


def bordered(
    data: Any, work: DenseWork, border: np.ndarray, n: float, step: np.ndarray, tangent: np.ndarray
) -> float:
    """Solve [[F_u, F_p], [border]] x = (-F, n) and (0, 1); returns the sign of the determinant."""
    size = len(work.residual)
    matrix, sides = work.matrix, work.sides
    matrix[:size, :size] = work.jacobian
    matrix[:size, size] = work.derivative
    matrix[size] = border
    sides[:size, 0] = -work.residual
    sides[size, 0] = n
    sides[:size, 1] = 0.0
    sides[size, 1] = 1.0
    try:
        solution = np.linalg.solve(matrix, sides)
        sign = float(np.linalg.slogdet(matrix)[0])
    except np.linalg.LinAlgError:
        left, values, right = np.linalg.svd(matrix)
        values = np.maximum(values, 1e-18 * max(values[0], 1e-200))
        with np.errstate(all="ignore"):
            solution = right.T @ ((left.T @ sides) / values[:, None])
        sign = 0.0
    step[:] = solution[:, 0]
    tangent[:] = solution[:, 1]
    return sign


def inspect(data: Any, u: np.ndarray, p: float, work: DenseWork, row: np.ndarray) -> None:
    """Raw spectrum of the linearisation; dense problems have no margins."""
    spectrum = data.raw_spectrum(work)
    row[0 : 2 * len(spectrum) : 2] = spectrum.real
    row[1 : 2 * len(spectrum) : 2] = spectrum.imag


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
