"""Roots of a function of one variable: bracketed, and interpolated through a singularity of its evaluation."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

BISECTIONS = 2  # before a function is taken for one with a jump or a kink at its zero
ENOUGH = 0.25  # part of a function's value that a secant may leave
SHORT = 0.02  # part of the way back that is gone where a secant has gone too far


def bracketed_root(
    f: Callable[[float], float],
    a: float,
    b: float,
    fa: float,
    fb: float,
    tolerance: float = 1e-14,
    jump: float = np.inf,
) -> tuple[float, float, float, float, float]:
    """Root of f between a and b by Chandrupatla's method (Adv. Eng. Software 28 (1997) 145).

    Bisection with inverse quadratic steps where they are safe; f need not be continuous. Where these are not, as at a jump or a
    kink, secants on one side of the zero take the place of bisection.

    Parameters
    ----------
    f : callable
        May return NaN where it cannot be evaluated; such a point is replaced by a bisection nearby.
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
    if fa == 0.0:
        return a, a, a, fa, fa
    if fb == 0.0:
        return b, b, b, fb, fb
    width = abs(b - a)
    x1, x2, f1, f2 = b, a, fb, fa
    x3, f3 = x1, f1
    sides = _Sides()
    t = 0.5
    for _ in range(100):
        x = x1 + t * (x2 - x1)
        fx = f(x)
        if not math.isfinite(fx):
            x = x1 + 0.37 * (x2 - x1)
            fx = f(x)
            if not math.isfinite(fx):
                break
        sides.add(x, fx)
        if (fx > 0.0) == (f1 > 0.0):
            x3, f3 = x1, f1
        else:
            x3, f3 = x2, f2
            x2, f2 = x1, f1
        x1, f1 = x, fx
        if f1 == 0.0:
            return x1, x1, x1, f1, f1
        limit = 0.5 * tolerance * width / max(abs(x2 - x1), 1e-300)
        if abs(f1 - f2) > jump and abs(x2 - x1) < 1e-5 * width:
            break
        if limit > 0.5 or abs(x2 - x1) <= tolerance * width:
            break
        xi, phi = (x1 - x2) / (x3 - x2), (f1 - f2) / (f3 - f2) if f3 != f2 else 2.0
        if phi * phi < xi and (1.0 - phi) ** 2 < 1.0 - xi:
            t = (f1 / (f2 - f1)) * (f3 / (f2 - f3)) + ((x3 - x1) / (x2 - x1)) * (f1 / (f3 - f1)) * (
                f2 / (f3 - f2)
            )
        else:
            t = (sides.ahead(x1, x2) - x1) / (x2 - x1)
        t = min(1.0 - limit, max(limit, t))
    best = x1 if abs(f1) < abs(f2) else x2
    (low, flow), (high, fhigh) = sorted(((x1, f1), (x2, f2)))
    return best, low, high, flow, fhigh


class _Sides:
    """The last points at which a function was positive, and those at which it was negative.

    Where it jumps or has a kink at its zero, what is beyond says nothing of it, and the zero is that of the secant on one side.
    """

    def __init__(self) -> None:
        self.points: tuple[list[tuple[float, float]], list[tuple[float, float]]] = ([], [])
        self.wait = BISECTIONS  # steps of bisection before secants are tried
        self.aimed: int | None = None  # the side from which the last step was a secant
        self.beyond = False  # whether it ended on the other side

    def add(self, x: float, fx: float) -> None:
        side, aimed = int(fx > 0.0), self.aimed
        if aimed is not None and aimed != side:
            self.beyond = True
        elif aimed is not None and not abs(fx) < ENOUGH * abs(self.points[side][-1][1]):
            self.wait = BISECTIONS  # it is not that smooth
        self.points[side].append((x, fx))
        self.aimed = None

    def ahead(self, x1: float, x2: float) -> float:
        """Where to look next in a bracket whose last end is `x1`."""
        beyond, self.beyond = self.beyond, False
        if beyond:  # a secant ended beyond the zero, hardly: a little before its end
            self.wait = 0
            return x1 + SHORT * (x2 - x1)
        if self.wait > 0:
            self.wait -= 1
            return 0.5 * (x1 + x2)
        best = math.inf
        where = 0.5 * (x1 + x2)
        for side, points in enumerate(self.points):
            if len(points) < 2:
                continue
            (xa, fa), (xb, fb) = points[-2:]
            if not abs(fb) < abs(fa):
                continue
            step = fb * (xb - xa) / (fa - fb)
            if abs(step) < best and min(x1, x2) < xb + step < max(x1, x2):
                best, where, self.aimed = abs(step), xb + step, side
        return where


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


def chebyshev_value(coefficients: np.ndarray, x: Any) -> Any:
    """The Chebyshev series at x."""
    return np.polynomial.chebyshev.chebval(x, coefficients)
