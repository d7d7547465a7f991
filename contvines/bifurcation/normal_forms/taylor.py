"""Second and third derivatives of a problem along given directions, from its Jacobians on a line through the point.

J(u + t x) is sampled at Chebyshev nodes in [-r, r] and fitted; its first and second derivative at t = 0 are the matrices
B(x, .) and C(x, x, .). The Jacobians are exact where the problem's are, so one or two derivatives remain, and the fit
converges like the Taylor series at the distance r. Two radii give an estimate of the error.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache
from typing import NamedTuple

import numpy as np

from ..roots import chebyshev_nodes
from ..settings import NORMAL_FORMS

NODES = 12
FEW = 5  # nodes where a few digits do
RADIUS = 0.4  # relative to the scale of the unknowns
SMALLER = 0.6
ROUGH = 0.02  # of the largest radius


class Line(NamedTuple):
    """B(x, .) and C(x, x, .) as matrices, and estimates of their largest errors."""

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
    """Derivatives of the Jacobian along a direction; None where it cannot be evaluated.

    Parameters
    ----------
    jacobians : callable
        points (k, N) -> F_u there, of any shape (k, m, N); None: not evaluable.
    u : ndarray, shape (N,)
    x : ndarray, shape (N,)
    scale : float
        Typical size of the unknowns.
    rough : bool
        One radius and few nodes: a few digits, for scanning. The error of the second derivative is then that of its differences
        over the inner and the outer nodes, which is more than that of the fit.
    """
    size = float(np.abs(x).max())
    if size == 0.0:
        here = jacobians(u[None, :])
        return None if here is None else Line(np.zeros_like(here[0]), np.zeros_like(here[0]), 0.0, 0.0)
    radius = RADIUS * scale / size
    if rough:
        samples = jacobians(_places(u, x, ROUGH * radius, FEW))
        if samples is None:
            return None
        inner, outer = ((samples[i] - samples[-1 - i]) / (2.0 * chebyshev_nodes(FEW)[i]) for i in (1, 0))
        return Line(
            *_fitted(samples, ROUGH * radius), float(np.abs(inner - outer).max()) / (ROUGH * radius), 0.0
        )
    best: Line | None = None
    reach = 0.0
    narrow = _fit(jacobians, u, x, radius)
    for _ in range(14):
        wide, narrow = narrow, _fit(jacobians, u, x, SMALLER * radius)
        if wide is not None and narrow is not None:
            errors = [float(np.abs(a - b).max()) for a, b in zip(wide, narrow)]
            if best is None or errors[1] < best.third_error:
                best, reach = Line(*wide, *errors), radius
            elif errors[1] > 8.0 * best.third_error and best.third_error * reach**2 <= _size(jacobians, u):
                break  # rounding grows; where the samples reached too far to say anything, a smaller radius may
            if all(
                error <= NORMAL_FORMS.enough * float(np.abs(part).max()) for error, part in zip(errors, wide)
            ):
                break
        radius *= SMALLER
    return best


def _size(jacobians: Callable[[np.ndarray], np.ndarray | None], u: np.ndarray) -> float:
    here = jacobians(u[None, :])
    return math.inf if here is None else float(np.abs(here).max())


def _fit(
    jacobians: Callable[[np.ndarray], np.ndarray | None], u: np.ndarray, x: np.ndarray, radius: float
) -> tuple[np.ndarray, np.ndarray] | None:
    samples = jacobians(_places(u, x, radius, NODES))
    return None if samples is None else _fitted(samples, radius)


def _places(u: np.ndarray, x: np.ndarray, radius: float, count: int) -> np.ndarray:
    return u + radius * chebyshev_nodes(count)[:, None] * x


def _fitted(samples: np.ndarray, radius: float) -> tuple[np.ndarray, np.ndarray]:
    """First and second derivative at the middle."""
    first, second = derivative_weights(len(samples))
    shape, flat = samples.shape[1:], samples.reshape(len(samples), -1)
    return (first @ flat).reshape(shape) / radius, (second @ flat).reshape(shape) / radius**2


@cache
def derivative_weights(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Weights of the samples in the first and second derivative at 0 of the polynomial through them, on [-1, 1]."""
    chebyshev = np.polynomial.chebyshev
    series = np.linalg.inv(chebyshev.chebvander(chebyshev_nodes(count), count - 1))
    unit = np.eye(count)
    first = np.array([chebyshev.chebval(0.0, chebyshev.chebder(row)) for row in unit])
    second = np.array([chebyshev.chebval(0.0, chebyshev.chebder(row, 2)) for row in unit])
    return first @ series, second @ series
