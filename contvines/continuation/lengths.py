"""Sums over the unknowns: corrections, planes, angles. As loops, which are compiled with the continuation loop.

:mod:`contvines.continuation.arrays` has the same functions for problems made of Python callables, whose unknowns have scales of
their own; here all unknowns have scale 1 and one weight, so ``metric.scale`` and ``metric.weights`` are not read.
"""

import math
from typing import NamedTuple

import numpy as np


class Metric(NamedTuple):
    """How lengths are measured: <a, b> = sum of weights_j a_j b_j over unknowns and parameter.

    ``weights`` and ``scale`` (typical sizes) have shape (N + 1,); ``of_unknowns`` and ``of_parameter`` are the weights of
    unknowns whose scale is 1, and of the parameter.
    """

    weights: np.ndarray
    scale: np.ndarray
    of_unknowns: float
    of_parameter: float


def correction_size(step, u, p, metric):
    """Largest entry of a correction, relative to 1 + abs(unknown); infinity where it is not finite."""
    n = u.shape[0]
    size = total = abs(step[n]) / (1.0 + abs(p))
    for i in range(n):
        entry = abs(step[i]) / (1.0 + abs(u[i]))
        size = max(size, entry)
        total += entry  # maxima pass over what is not a number
    return size if total < math.inf else math.inf


def add(u, step):
    """Add the part of a correction that belongs to the unknowns."""
    for i in range(u.shape[0]):
        u[i] += step[i]


def remainder(border, u, p, target):
    """target - border.(u, p)."""
    gap = target - border[u.shape[0]] * p
    for i in range(u.shape[0]):
        gap -= border[i] * u[i]
    return gap


def fix_parameter(border):
    """Fill `border` with the row that picks the parameter."""
    n = border.shape[0] - 1
    for j in range(n):
        border[j] = 0.0
    border[n] = 1.0


def plane(tangent, u, p, metric, border):
    """Fill `border` with the plane through (u, p) across a tangent; returns border.(u, p)."""
    n = u.shape[0]
    target = 0.0
    for j in range(n):
        border[j] = metric.of_unknowns * tangent[j]
        target += border[j] * u[j]
    border[n] = metric.of_parameter * tangent[n]
    return target + border[n] * p


def compare(tangent, before, u, guess_u, p, guess, metric):
    """Length of a tangent, cosine of its angle with the unit tangent before, distance of a point from its guess."""
    n = u.shape[0]
    norm = metric.of_parameter * tangent[n] * tangent[n]
    cosine = metric.of_parameter * tangent[n] * before[n]
    error = metric.of_parameter * (p - guess) ** 2
    part_norm = 0.0
    part_cosine = 0.0
    part_error = 0.0
    for j in range(n):
        part_norm += tangent[j] * tangent[j]
        part_cosine += tangent[j] * before[j]
        part_error += (u[j] - guess_u[j]) ** 2
    norm = math.sqrt(norm + metric.of_unknowns * part_norm)
    cosine = (cosine + metric.of_unknowns * part_cosine) / norm
    return norm, cosine, math.sqrt(error + metric.of_unknowns * part_error)


def orient(tangent, along, border, metric):
    """Length of a tangent, its inner product with another vector, and border.tangent; the length is infinite where one is not finite."""
    n = tangent.shape[0] - 1
    part_norm, part_same = 0.0, 0.0
    across = border[n] * tangent[n]
    for j in range(n):
        part_norm += tangent[j] * tangent[j]
        part_same += tangent[j] * along[j]
        across += border[j] * tangent[j]
    square = metric.of_unknowns * part_norm + metric.of_parameter * tangent[n] * tangent[n]
    same = metric.of_unknowns * part_same + metric.of_parameter * tangent[n] * along[n]
    return math.sqrt(square) if square < math.inf else math.inf, same, across


def hermite(chord, s, u, guess):
    """Cubic Hermite interpolation at s in [0, 1]; fills u and guess alike, returns p. See :class:`contvines.events.segment.Segment`."""
    n = u.shape[0]
    a = (1.0 + 2.0 * s) * (1.0 - s) ** 2
    b = s * (1.0 - s) ** 2
    c = s * s * (3.0 - 2.0 * s)
    d = s * s * (s - 1.0)
    for j in range(n + 1):
        guess[j] = a * chord[0, j] + b * chord[1, j] + c * chord[2, j] + d * chord[3, j]
    for j in range(n):
        u[j] = guess[j]
    return guess[n]


def distance(u, p, guess, metric):
    """Distance of (u, p) from a guess."""
    n = u.shape[0]
    square = 0.0
    for j in range(n):
        square += (u[j] - guess[j]) ** 2
    return math.sqrt(metric.of_unknowns * square + metric.of_parameter * (p - guess[n]) ** 2)


def put(to, source, divisor):
    """Copy a vector, divided by a number."""
    for j in range(source.shape[0]):
        to[j] = source[j] / divisor


def extrapolate(points, values, tangents, i, h, metric, u):
    """Cubic Hermite extrapolation over a length h from point i - 1 (and i - 2); fills u, returns p.

    The length of the arc between the two points is their distance times 1 + angle^2/24 (exact to fourth order).
    """
    n = u.shape[0]
    if i < 2:
        for j in range(n):
            u[j] = points[i - 1, j] + h * tangents[i - 1, j]
        return values[i - 1] + h * tangents[i - 1, n]
    square = metric.of_parameter * (values[i - 1] - values[i - 2]) ** 2
    turn = metric.of_parameter * (tangents[i - 1, n] - tangents[i - 2, n]) ** 2
    chord = 0.0
    bend = 0.0
    for j in range(n):
        change = points[i - 1, j] - points[i - 2, j]
        chord += change * change
        change = tangents[i - 1, j] - tangents[i - 2, j]
        bend += change * change
    square += metric.of_unknowns * chord
    turn += metric.of_unknowns * bend
    d = math.sqrt(square) * (1.0 + turn / 24.0)
    if not (d > 0.0 and turn < 1.0 and h < 4.0 * d):
        for j in range(n):
            u[j] = points[i - 1, j] + h * tangents[i - 1, j]
        return values[i - 1] + h * tangents[i - 1, n]
    share = h / d
    for j in range(n):
        here = tangents[i - 1, j]
        there = tangents[i - 2, j]
        mean = (points[i - 1, j] - points[i - 2, j]) / d
        u[j] = points[i - 1, j] + h * (
            here + share * (2.0 * here + there - 3.0 * mean + share * (here + there - 2.0 * mean))
        )
    here = tangents[i - 1, n]
    there = tangents[i - 2, n]
    mean = (values[i - 1] - values[i - 2]) / d
    return values[i - 1] + h * (
        here + share * (2.0 * here + there - 3.0 * mean + share * (here + there - 2.0 * mean))
    )
