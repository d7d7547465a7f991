"""Gauss collocation on one interval: nodes, values and slopes at the Gauss points, and the constant of the error.

Reference: Ascher, Mattheij and Russell, Numerical Solution of Boundary Value Problems (SIAM 1995), chapter 5.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from math import factorial

import numpy as np
from numpy.polynomial import Polynomial
from numpy.polynomial.legendre import leggauss


@dataclass(frozen=True)
class Rule:
    """Polynomials of degree m on [0, 1], given by their values at m + 1 nodes.

    Attributes
    ----------
    nodes : ndarray, shape (m + 1,)
        Chebyshev points of the second kind, both ends included.
    points, weights : ndarray, shape (m,)
        Gauss points and weights.
    values, slopes : ndarray, shape (m, m + 1)
        From values at the nodes to values and derivatives at the Gauss points.
    rates : ndarray, shape (m, m + 1)
        From values at the nodes to derivatives at all nodes but the last.
    barycentric : ndarray, shape (m + 1,)
        Weights of the interpolation formula.
    top : ndarray, shape (m + 1,)
        From values at the nodes to the m-th derivative, a constant.
    constant : float
        Largest error of the polynomial is ``constant * h^(m + 1) * |x^(m + 1)|``.
    """

    nodes: np.ndarray
    points: np.ndarray
    weights: np.ndarray
    values: np.ndarray
    slopes: np.ndarray
    rates: np.ndarray
    barycentric: np.ndarray
    top: np.ndarray
    constant: float

    @property
    def degree(self) -> int:
        """m."""
        return len(self.points)

    @property
    def resolved(self) -> float:
        """Size of z = h lambda from which on R(z) has no zeros and poles, and comes nearer to 1 in size the larger z is.

        Its zeros and poles are smaller than 2 m + 4 / 3: Saff and Varga, in Pade and Rational Approximation (1977), p. 195.
        """
        return 2.0 * (self.degree + 2.0 / 3.0)

    def stability(self, z: np.ndarray) -> np.ndarray:
        """R(z), what collocation makes of x' = lambda x in an interval of length h, for z = h lambda: Pade's approximant of exp(z)."""
        m = self.degree
        terms = [factorial(2 * m - k) / (factorial(k) * factorial(m - k)) for k in range(m, -1, -1)]
        return np.polyval(terms, z) / np.polyval(terms, -z)

    def interpolation(self, places: np.ndarray) -> np.ndarray:
        """Matrix from values at the nodes to values at some places in [0, 1], shape (len(places), m + 1)."""
        gaps = np.asarray(places, dtype=float)[:, None] - self.nodes
        hit = gaps == 0.0
        gaps[hit] = 1.0
        parts = self.barycentric / gaps
        parts[hit.any(axis=1)] = 0.0
        parts[hit] = 1.0
        return parts / parts.sum(axis=1, keepdims=True)


@lru_cache(maxsize=16)
def rule(degree: int) -> Rule:
    """The rule of a degree.

    Raises
    ------
    ValueError
        If the degree is not 2 to 7.
    """
    if not (isinstance(degree, (int, np.integer)) and 2 <= degree <= 7):
        raise ValueError(f"degree = {degree!r} must be a whole number from 2 to 7")
    m = int(degree)
    nodes = 0.5 - 0.5 * np.cos(np.pi * np.arange(m + 1) / m)
    points, weights = leggauss(m)
    points, weights = 0.5 + 0.5 * points, 0.5 * weights
    values, slopes, rates = np.empty((3, m, m + 1))
    barycentric, top = np.empty((2, m + 1))
    for j in range(m + 1):
        others = np.delete(nodes, j)
        barycentric[j] = 1.0 / np.prod(nodes[j] - others)
        basis = Polynomial.fromroots(others) * barycentric[j]
        values[:, j], slopes[:, j], rates[:, j] = (
            basis(points),
            basis.deriv()(points),
            basis.deriv()(nodes[:-1]),
        )
        top[j] = factorial(m) * barycentric[j]
    # the error of Gauss collocation begins with the integral of the polynomial that vanishes at the Gauss points
    kernel = Polynomial.fromroots(points).integ()
    constant = float(np.abs(kernel(np.linspace(0.0, 1.0, 401)) - kernel(0.0)).max()) / factorial(m)
    return Rule(nodes, points, weights, values, slopes, rates, barycentric, top, constant)
