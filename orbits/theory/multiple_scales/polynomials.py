"""Reliable computation of all real roots of many small polynomials at once."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from orbits.settings import THEORY

_BISECTIONS = 110  # halvings of each bracket, enough for full precision


def _value(coefficients: NDArray, x: NDArray) -> NDArray:
    """Evaluate polynomials by Horner's rule; `coefficients` (..., n+1) highest power first, `x` (..., m)."""
    total = np.zeros_like(x)
    for k in range(coefficients.shape[-1]):
        total = total * x + coefficients[..., k : k + 1]
    return total


def root_bound(coefficients: ArrayLike) -> NDArray:
    """Cauchy's bound on the modulus of the roots; leading coefficients that are zero to rounding are ignored.

    Parameters
    ----------
    coefficients : array_like, shape (..., n+1)
        Highest power first.

    Returns
    -------
    ndarray, shape (...)
        No root of the polynomial is larger in modulus.
    """
    c = np.abs(np.asarray(coefficients, dtype=float))
    largest = np.max(c, axis=-1, keepdims=True)
    counts = c > THEORY.rounding * np.where(largest > 0, largest, 1.0)
    first = np.argmax(counts, axis=-1)[..., None]
    leading = np.take_along_axis(c, first, axis=-1)
    leading = np.where(leading > 0, leading, 1.0)
    after = np.where(np.arange(c.shape[-1]) > first, c, 0.0)
    return 1.0 + np.max(after / leading, axis=-1)


def real_roots(coefficients: ArrayLike, low: ArrayLike, high: ArrayLike) -> NDArray[np.float64]:
    """Return all real roots in an interval, of every polynomial in an array.

    Between two neighbouring roots of its derivative a polynomial is monotone, so it has at most one
    root there; bisection finds it if the sign changes. The roots of the derivative are computed in the
    same way. So no root is missed, whatever the conditioning. A double root (a fold of the
    equilibria) is returned once, if the polynomial is zero there to rounding.

    Parameters
    ----------
    coefficients : array_like, shape (..., n+1)
        Highest power first.
    low, high : array_like, broadcastable to shape (...)
        Ends of the interval.

    Returns
    -------
    ndarray, shape (..., n)
        Roots in ascending order, padded with nan.
    """
    c = np.asarray(coefficients, dtype=float)
    degree = c.shape[-1] - 1
    shape = c.shape[:-1]
    a = np.broadcast_to(np.asarray(low, dtype=float), shape)[..., None]
    b = np.broadcast_to(np.asarray(high, dtype=float), shape)[..., None]
    if degree == 0:
        return np.empty((*shape, 0))
    powers = np.arange(degree, 0, -1)
    turning = real_roots(c[..., :-1] * powers, a[..., 0], b[..., 0]) if degree > 1 else np.empty((*shape, 0))
    turning = np.where(np.isnan(turning), b, turning)
    knots = np.concatenate([a, turning, b], axis=-1)
    values = _value(c, knots)
    scale = _value(np.abs(c), np.abs(knots))
    values = np.where(np.abs(values) <= 8 * np.finfo(float).eps * scale, 0.0, values)

    left, right = knots[..., :-1].copy(), knots[..., 1:].copy()
    at_left, at_right = values[..., :-1], values[..., 1:]
    bracketed = at_left * at_right < 0
    sign = np.sign(at_left)
    for _ in range(_BISECTIONS):
        middle = 0.5 * (left + right)
        before = np.sign(_value(c, middle)) == sign
        left = np.where(before, middle, left)
        right = np.where(before, right, middle)
    inside = np.where(bracketed, 0.5 * (left + right), np.nan)
    touched = np.where((values == 0.0) & (np.diff(knots, prepend=-np.inf, axis=-1) > 0), knots, np.nan)
    found = np.sort(np.concatenate([inside, touched], axis=-1), axis=-1)
    return found[..., :degree]
