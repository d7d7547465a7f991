"""Sums over the unknowns: corrections, planes, angles. Every unknown has its scale.

The native core (native/march.hpp) has the same with loops, for unknowns that all have scale 1 and one weight.
"""

from __future__ import annotations

import math

import numpy as np

from ..problems.dense import dot, position
from .layout import Metric


def correction_size(step: np.ndarray, u: np.ndarray, p: float, metric: Metric) -> float:
    """Largest entry of a correction, relative to scale + abs(unknown); infinity where it is not finite."""
    part = np.abs(u)
    part += metric.scale[:-1]
    np.divide(step[:-1], part, out=part)
    change = abs(float(step[-1])) / (float(metric.scale[-1]) + abs(p))
    if not dot(part, part) + change < math.inf:
        return math.inf
    return max(abs(float(part[position(part)])), change)


def add(u: np.ndarray, step: np.ndarray) -> None:
    """Add the part of a correction that belongs to the unknowns."""
    u += step[:-1]


def remainder(border: np.ndarray, u: np.ndarray, p: float, target: float) -> float:
    """target - border.(u, p)."""
    return target - float(border[-1]) * p - dot(border, u, len(u))


def fix_parameter(border: np.ndarray) -> None:
    """Fill `border` with the row that picks the parameter."""
    border[:-1] = 0.0
    border[-1] = 1.0


def plane(
    tangent: np.ndarray,
    u: np.ndarray,
    p: float,
    metric: Metric,
    border: np.ndarray,
) -> float:
    """Fill `border` with the plane through (u, p) across a tangent; returns border.(u, p)."""
    np.multiply(metric.weights, tangent, out=border)
    return dot(border, u, len(u)) + float(border[-1]) * p


def compare(
    tangent: np.ndarray,
    before: np.ndarray,
    u: np.ndarray,
    guess_u: np.ndarray,
    p: float,
    guess: float,
    metric: Metric,
) -> tuple[float, float, float]:
    """Length of a tangent, cosine of its angle with the unit tangent before, distance of a point from its guess."""
    weighted = metric.weights * tangent
    norm = math.sqrt(dot(weighted, tangent))
    gap = u - guess_u
    error = math.sqrt(dot(metric.weights[:-1] * gap, gap) + metric.of_parameter * (p - guess) ** 2)
    return norm, dot(weighted, before) / norm, error


def orient(
    tangent: np.ndarray,
    along: np.ndarray,
    border: np.ndarray,
    metric: Metric,
) -> tuple[float, float, float]:
    """Length of a tangent, its inner product with another vector, and border.tangent; the length is infinite where one is not finite."""
    weighted = metric.weights * tangent
    norm = math.sqrt(dot(weighted, tangent)) if np.isfinite(tangent).all() else math.inf
    return norm, dot(weighted, along), dot(border, tangent)


def hermite(chord: np.ndarray, s: float, u: np.ndarray, guess: np.ndarray) -> float:
    """Cubic Hermite interpolation at s in [0, 1]; fills u and guess alike, returns p. See :class:`contvines.bifurcation.segment.Segment`."""
    a, b = (1.0 + 2.0 * s) * (1.0 - s) ** 2, s * (1.0 - s) ** 2
    c, d = s * s * (3.0 - 2.0 * s), s * s * (s - 1.0)
    guess[:] = a * chord[0] + b * chord[1] + c * chord[2] + d * chord[3]
    u[:] = guess[:-1]
    return float(guess[-1])


def distance(u: np.ndarray, p: float, guess: np.ndarray, metric: Metric) -> float:
    """Distance of (u, p) from a guess."""
    gap = u - guess[:-1]
    return math.sqrt(dot(metric.weights[:-1] * gap, gap) + metric.of_parameter * (p - float(guess[-1])) ** 2)


def put(to: np.ndarray, source: np.ndarray, divisor: float) -> None:
    """Copy a vector, divided by a number."""
    if divisor == 1.0:
        to[:] = source
    else:
        np.divide(source, divisor, out=to)


def extrapolate(
    points: np.ndarray,
    values: np.ndarray,
    tangents: np.ndarray,
    i: int,
    h: float,
    metric: Metric,
    u: np.ndarray,
) -> float:
    """Cubic Hermite extrapolation over a length h from point i - 1 (and i - 2); fills u, returns p.

    The length of the arc between the two points is their distance times 1 + angle^2/24 (exact to fourth order).
    """
    here, value, point = tangents[i - 1], float(values[i - 1]), points[i - 1]
    if i >= 2:
        there = tangents[i - 2]
        chord, bend = point - points[i - 2], here - there
        change = value - float(values[i - 2])
        turn = dot(metric.weights * bend, bend)
        square = dot(metric.weights[:-1] * chord, chord) + metric.of_parameter * change**2
        d = math.sqrt(square) * (1.0 + turn / 24.0)
        if d > 0.0 and turn < 1.0 and h < 4.0 * d:
            share = h / d
            a = h * (1.0 + 2.0 * share + share * share)
            b = h * (share + share * share)
            c = h * (3.0 * share + 2.0 * share * share) / d
            chord *= -c
            chord += point
            way = a * here
            way += np.multiply(there, b, out=bend)
            np.add(chord, way[:-1], out=u)
            if metric.moving is not None:
                # nothing corrects these: their errors grow by the formula above, and do not by that of Adams and Bashforth
                held = metric.moving.held
                u[held] = point[held] + h * (
                    (1.0 + 0.5 * share) * here[:-1][held] - 0.5 * share * there[:-1][held]
                )
            return value - c * change + float(way[-1])
    np.add(point, h * here[:-1], out=u)
    return value + h * float(here[-1])
