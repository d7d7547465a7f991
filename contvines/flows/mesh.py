"""Gauss collocation on one interval; piecewise polynomials on the meshes of cycles, their estimated errors, and equidistribution.

Reference: Ascher, Mattheij and Russell, Numerical Solution of Boundary Value Problems (SIAM 1995), chapter 5.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from math import factorial

import numpy as np
from numpy.polynomial import Polynomial
from numpy.polynomial.legendre import leggauss

EVEN = 0.3  # part of its mean that is added to the error density before equidistribution, to limit the ratio of intervals
SLACK = 1.1  # ratio of the largest to the mean share of the error up to which a mesh is not changed


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
        Matrices from values at the nodes to values and derivatives at the Gauss points.
    rates : ndarray, shape (m, m + 1)
        Matrix from values at the nodes to derivatives at all nodes except the last.
    barycentric : ndarray, shape (m + 1,)
        Weights of the barycentric interpolation formula.
    top : ndarray, shape (m + 1,)
        Weights of the values at the nodes in the m-th derivative, a constant.
    constant : float
        The largest error of the polynomial is ``constant * h^(m + 1) * |x^(m + 1)|``.
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
        """Degree m."""
        return len(self.points)

    @property
    def resolved(self) -> float:
        """Largest |z| = |h lambda| that an interval resolves; for larger z, |R(z)| tends to 1, see `stability`.

        All zeros and poles of R lie within |z| < 2 m + 4 / 3: Saff and Varga, in Pade and Rational Approximation (1977), p. 195.
        """
        return 2.0 * (self.degree + 2.0 / 3.0)

    def stability(self, z: np.ndarray) -> np.ndarray:
        """Return R(z), the growth of x' = lambda x over an interval of length h by collocation, z = h lambda: the Pade approximant of exp(z)."""
        m = self.degree
        terms = [factorial(2 * m - k) / (factorial(k) * factorial(m - k)) for k in range(m, -1, -1)]
        return np.polyval(terms, z) / np.polyval(terms, -z)

    def blocks(self, jacobian: np.ndarray) -> np.ndarray:
        """Return the derivatives of the collocation equations by the values at the nodes of their interval, shape (N, m d, (m + 1) d).

        Parameters
        ----------
        jacobian : ndarray, shape (N m, d, d)
            df/dx at the Gauss points, times the length of the interval.
        """
        m, d = self.degree, jacobian.shape[-1]
        found = -np.einsum("cj,icab->icajb", self.values, jacobian.reshape(-1, m, d, d))
        each = np.arange(d)
        found[:, :, each, :, each] += self.slopes
        return found.reshape(-1, m * d, (m + 1) * d)

    def interpolation(self, places: np.ndarray) -> np.ndarray:
        """Return the matrix from values at the nodes to values at places in [0, 1], shape (len(places), m + 1)."""
        gaps = np.asarray(places, dtype=float)[:, None] - self.nodes
        hit = gaps == 0.0
        gaps[hit] = 1.0
        parts = self.barycentric / gaps
        parts[hit.any(axis=1)] = 0.0
        parts[hit] = 1.0
        return parts / parts.sum(axis=1, keepdims=True)


@lru_cache(maxsize=16)
def rule(degree: int) -> Rule:
    """Return the rule of a degree.

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
    # the leading error of Gauss collocation is the integral of the polynomial that vanishes at the Gauss points
    kernel = Polynomial.fromroots(points).integ()
    constant = float(np.abs(kernel(np.linspace(0.0, 1.0, 401)) - kernel(0.0)).max()) / factorial(m)
    return Rule(nodes, points, weights, values, slopes, rates, barycentric, top, constant)


# ------------------------------------------------------------------ piecewise polynomials
def closed(x: np.ndarray) -> np.ndarray:
    """Append the last node (the first of the next interval) to each interval: shape (..., N, m + 1, d) from (..., N, m, d)."""
    after = np.concatenate([x[..., 1:, :1, :], x[..., :1, :1, :]], axis=-3)
    return np.concatenate([x, after], axis=-2)


def at_gauss_points(matrix: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Return values, or derivatives, at the Gauss points of all intervals, shape (N m, d), from values at the nodes, shape (N, m, d)."""
    return np.matmul(matrix, closed(x)).reshape(-1, x.shape[-1])


def phase_row(rule: Rule, widths: np.ndarray, rates: np.ndarray) -> tuple[np.ndarray, float]:
    """Return the normalised row of the phase condition, shape (N, m d), and its original length, from rates at the Gauss points, shape (N, m, d)."""
    row = np.matmul(rule.values.T, (widths[:, None] * rule.weights)[:, :, None] * rates)
    row[1:, 0] += row[:-1, -1]
    row[0, 0] += row[-1, -1]
    phase = row[:, :-1].reshape(len(widths), -1)
    size = math.sqrt(np.vdot(phase, phase))
    return phase / (size or 1.0), size


def halved(rule: Rule, x: np.ndarray) -> np.ndarray:
    """Return the same curve, or curves, on a mesh with every interval halved, shape (..., 2 N, m, d)."""
    places = 0.5 * rule.nodes[:-1]
    matrix = rule.interpolation(np.concatenate([places, 0.5 + places]))
    ends = closed(x)[..., None, :]
    # a sum in this order gives the same result for one curve and for one of many, to the last bit
    found = sum(matrix[:, j, None] * ends[..., j, :, :] for j in range(rule.degree + 1))
    return np.reshape(found, (*x.shape[:-3], 2 * x.shape[-3], *x.shape[-2:]))


def evaluate(rule: Rule, widths: np.ndarray, x: np.ndarray, places: np.ndarray) -> np.ndarray:
    """Evaluate a periodic piecewise polynomial at places in units of the period, shape (len(places), d)."""
    return reading(rule, widths, places)(x)


def reading(rule: Rule, widths: np.ndarray, places: np.ndarray) -> Callable[[np.ndarray], np.ndarray]:
    """Return a function that evaluates periodic piecewise polynomials on this mesh at these places."""
    edges = np.append(0.0, np.cumsum(widths))
    edges /= edges[-1]
    places = np.mod(places, 1.0)
    i = np.clip(np.searchsorted(edges, places, side="right") - 1, 0, len(widths) - 1)
    weights = rule.interpolation((places - edges[i]) / (edges[i + 1] - edges[i]))
    return lambda x: np.einsum("ij,ijk->ik", weights, closed(x)[i])


def places(widths: np.ndarray, inside: np.ndarray) -> np.ndarray:
    """Return the places at the fractions `inside` of each interval, in units of the period, shape (N len(inside),)."""
    begins = np.append(0.0, np.cumsum(widths)[:-1])
    return (begins[:, None] + widths[:, None] * inside).reshape(-1)


def phases(widths: np.ndarray, inside: np.ndarray, copies: int, rounds: int) -> np.ndarray:
    """Return the phases of a forcing, in units of its period, at the fractions `inside` of each interval, shape (N len(inside),).

    The mesh consists of `copies` equal parts, and the cycle covers `rounds` periods of the forcing. Where both repeat, the phases are equal to the
    last bit, so that a cycle which repeats a shorter one solves the same equations exactly.
    """
    parts = math.gcd(copies, rounds)
    return np.tile(np.mod(rounds * places(widths[: len(widths) // parts], inside), 1.0), parts)


def node_places(rule: Rule, widths: np.ndarray) -> np.ndarray:
    """Return the places of the nodes, without the last one of each interval, in units of the period, shape (N m,)."""
    return places(widths, rule.nodes[:-1])


def alike(rule: Rule, widths: np.ndarray, x: np.ndarray, y: np.ndarray) -> float:
    """Return the cosine of the angle between the velocities of two curves on one mesh, with the inner product averaged over the period."""
    roots = np.sqrt(rule.weights / widths[:, None])[:, :, None]
    a, b = (roots * np.matmul(rule.slopes, closed(z)) for z in (x, y))
    return float(np.vdot(a, b) / np.sqrt(np.vdot(a, a) * np.vdot(b, b)))


def along_data(times: np.ndarray, states: np.ndarray, count: int, copies: int) -> np.ndarray:
    """Return the widths of `count` intervals, each with an equal share of time plus arclength of a curve through data; the mesh consists of equal copies."""
    parts = 20 * count
    places = np.linspace(times[0], times[-1], parts + 1)
    curve = np.column_stack([np.interp(places, times, column) for column in states.T])
    lengths = np.linalg.norm(np.diff(curve, axis=0), axis=1).reshape(copies, -1).max(axis=0)
    shares = np.append(0.0, np.cumsum(lengths / (lengths.sum() or 1.0) + 1.0 / len(lengths)))
    edges = np.interp(
        np.linspace(0.0, shares[-1], count // copies + 1), shares, np.linspace(0.0, 1.0, len(shares))
    )
    return np.tile(np.diff(edges) / copies, copies)


def with_equal_halves(widths: np.ndarray) -> np.ndarray:
    """Return the widths of a mesh with twice as many intervals and two equal halves, each as fine as both old halves together."""
    number, places = np.arange(len(widths) + 1.0), np.append(0.0, np.cumsum(widths))
    folded = np.unique(np.clip(np.concatenate([places, places - 0.5, [0.5]]), 0.0, 0.5))
    passed = np.interp(folded, places, number) + np.interp(folded + 0.5, places, number)
    return np.tile(np.diff(np.interp(number, passed - passed[0], folded)), 2)


def density(rule: Rule, widths: np.ndarray, x: np.ndarray, scale: np.ndarray) -> np.ndarray:
    """Return |x^(m + 1)|^(1 / (m + 1)) on each interval, in units of the period and the scale, estimated from jumps of the m-th derivative."""
    m = rule.degree
    ring = np.arange(-1, len(widths) + 1) % len(widths)  # each interval with its neighbours
    w = widths[ring, None]
    top = np.matmul(rule.top, closed(x) / scale)[ring] / w**m
    jumps = np.abs(top[1:] - top[:-1]) / (w[1:] + w[:-1])
    return (jumps[1:] + jumps[:-1]).max(axis=1) ** (1.0 / (m + 1))


def error(rule: Rule, widths: np.ndarray, x: np.ndarray, scale: np.ndarray) -> float:
    """Estimate the largest error of the curve between the mesh points, in units of the scale."""
    share = density(rule, widths, x, scale) * widths
    return float(rule.constant * share.max() ** (rule.degree + 1))


def equidistributed(
    rule: Rule, widths: np.ndarray, x: np.ndarray, scale: np.ndarray, copies: int = 1
) -> np.ndarray | None:
    """Return the widths of the same number of intervals with equal shares of the error; None if the given ones are good enough.

    Parameters
    ----------
    copies : int
        Number of equal parts of which the mesh consists.
    """
    current = density(rule, widths, x, scale)
    mean = float((current * widths).sum())
    if not mean > 0.0 or not np.isfinite(mean):
        return None
    target = current + EVEN * mean
    parts = target.reshape(copies, -1).max(axis=0)
    part = widths.reshape(copies, -1)[0]
    shares = parts * part
    if shares.max() <= SLACK * shares.mean():
        return None
    edges = np.append(0.0, np.cumsum(shares))
    places = np.append(0.0, np.cumsum(part))
    new = np.interp(np.linspace(0.0, edges[-1], len(part) + 1), edges, places)
    return np.tile(np.diff(new), copies)
