"""Second and third derivatives of a problem along given directions, from its Jacobians on a line through the point.

J(u + t x) is sampled at Chebyshev nodes t in [-r, r] and fitted by a polynomial; its first and second derivatives at t = 0 are the matrices
B(x, .) and C(x, x, .). Only one or two derivatives are taken numerically, and the fit converges like the Taylor series at the
distance r. Two radii give an estimate of the error.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.polynomial.chebyshev import cheb2poly

from ..locate import chebyshev_nodes, chebyshev_series
from ..settings import NORMAL_FORMS

NODES = 12  # Chebyshev nodes on a line
FEW = 5  # nodes, if a few digits are enough
RADIUS = 0.4  # first radius, relative to the scale of the unknowns
SMALLER = 0.6  # ratio of successive radii
ROUGH = 0.02  # radius relative to the first one, if a few digits are enough


class Line(NamedTuple):
    """Derivatives along a line: B(x, .) and C(x, x, .) as matrices, and estimates of their largest errors."""

    second: np.ndarray
    third: np.ndarray
    second_error: float
    third_error: float


def along_line(
    jacobians: Callable[[np.ndarray], np.ndarray | None],
    u: np.ndarray,
    x: np.ndarray,
    scale: float = 1.0,
    rough: bool = False,
) -> Line | None:
    """Compute the derivatives of the Jacobian along a direction; None if it cannot be evaluated.

    Parameters
    ----------
    jacobians : callable
        points, shape (k, N) -> F_u there, of any shape (k, m, N); None if not evaluable.
    u : ndarray, shape (N,)
        The point.
    x : ndarray, shape (N,)
        The direction.
    scale : float
        Typical size of the unknowns.
    rough : bool
        Use one radius and few nodes, for a few digits. The error of the second derivative is then estimated from differences over the inner and the
        outer nodes, which is larger than the error of the fit.
    """
    size = float(np.abs(x).max())
    if size == 0.0:
        matrix = jacobians(u[None, :])
        return None if matrix is None else Line(np.zeros_like(matrix[0]), np.zeros_like(matrix[0]), 0.0, 0.0)

    def samples(radius: float, count: int) -> np.ndarray | None:
        return jacobians(u + radius * chebyshev_nodes(count)[:, None] * x)

    def largest() -> float:
        matrix = jacobians(u[None, :])
        return np.inf if matrix is None else float(np.abs(matrix).max())

    radius = RADIUS * scale / size
    if rough:
        found = samples(ROUGH * radius, FEW)
        if found is None:
            return None
        inner, outer = ((found[i] - found[-1 - i]) / (2.0 * chebyshev_nodes(FEW)[i]) for i in (1, 0))
        missed = float(np.abs(inner - outer).max()) / (ROUGH * radius)
        return Line(*_fitted(found, ROUGH * radius), missed, 0.0)
    best: Line | None = None
    reach, wide = 0.0, None
    for _ in range(15):
        found = samples(radius, NODES)
        narrow = None if found is None else _fitted(found, radius)
        if wide is not None and narrow is not None:
            errors = [float(np.abs(a - b).max()) for a, b in zip(wide, narrow)]
            if best is None or errors[1] < best.third_error:
                best, reach = Line(*wide, *errors), radius / SMALLER
            elif errors[1] > 8.0 * best.third_error and best.third_error * reach**2 <= largest():
                break  # rounding grows; go on only if all radii so far were too large to converge
            sizes = [float(np.abs(part).max()) for part in wide]
            if all(error <= NORMAL_FORMS.enough * most for error, most in zip(errors, sizes)):
                break
        wide, radius = narrow, SMALLER * radius
    return best


def _fitted(samples: np.ndarray, radius: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the first and second derivatives at the middle from samples at Chebyshev nodes."""
    first, second = (
        k * (taylor_weights(len(samples), k) @ samples.reshape(len(samples), -1)) for k in (1, 2)
    )
    shape = samples.shape[1:]
    return first.reshape(shape) / radius, second.reshape(shape) / radius**2


@cache
def taylor_weights(count: int, degree: int) -> np.ndarray:
    """Return the weights, shape (count,), with which samples at Chebyshev nodes in [-1, 1] give the coefficient of t^degree of their polynomial."""
    parts = [cheb2poly(row)[degree] if k >= degree else 0.0 for k, row in enumerate(np.eye(count))]
    return np.array(parts) @ chebyshev_series(count)
