"""Roots of a function of one variable: bracketed, and interpolated through a singularity of its evaluation."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np

from ..continuation.bracketing import Bracket
from ..shared.floating_point import ROUNDED


def bracketed_root(
    f: Callable[[float], float],
    a: float,
    b: float,
    fa: float,
    fb: float,
    tolerance: float = ROUNDED,
    jump: float = np.inf,
) -> tuple[float, float, float, float, float]:
    """Root of f between a and b; see :mod:`contvines.continuation.bracketing`.

    Parameters
    ----------
    f : callable
        May return NaN where it cannot be evaluated; such a point is replaced by one nearby.
    a, b, fa, fb : float
        Bracket, fa and fb of opposite sign (or one of them zero).
    tolerance : float
        Width of the final bracket relative to the first one.
    jump : float
        Give up where f still changes by more than this over a bracket of 1e-5 of the first one: f has a jump there.

    Returns
    -------
    (root, low, high, f(low), f(high)) : tuple of float
        The best estimate and the final bracket.
    """
    bracket = Bracket(b, fb, 0.0, a, fa, 0.0, tolerance, jump)
    bracket.narrow(lambda x: (f(x), 0.0))
    (low, flow), (high, fhigh) = sorted(((bracket.x1, bracket.f1), (bracket.x2, bracket.f2)))
    return bracket.best, low, high, flow, fhigh


@cache
def chebyshev_nodes(n: int) -> np.ndarray:
    """The n roots of the Chebyshev polynomial T_n, none of them 0 for even n."""
    return np.cos((2.0 * np.arange(n) + 1.0) * np.pi / (2 * n))


def chebyshev_fit(values: np.ndarray) -> np.ndarray:
    """Coefficients of the Chebyshev series through values at ``chebyshev_nodes(n)``; shape (n, ...)."""
    n = len(values)
    k = np.arange(n)
    angles = (2.0 * np.arange(n) + 1.0) * np.pi / (2 * n)
    coefficients = 2.0 / n * np.cos(np.outer(k, angles)) @ values.reshape(n, -1)
    coefficients[0] *= 0.5
    return coefficients.reshape(values.shape)


def chebyshev_value(coefficients: np.ndarray, x: np.ndarray | float) -> np.ndarray:
    """The Chebyshev series at x."""
    return np.asarray(np.polynomial.chebyshev.chebval(x, coefficients))
