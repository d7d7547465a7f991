"""Predictor: extrapolation along the branch.

Runs compiled and interpreted: see :mod:`contvines.continuation.march`.
"""

import math


def predict(points, values, tangents, i, h, metric_u, metric_p, u):
    """Cubic Hermite extrapolation over a length h from point i - 1 (and i - 2); fills u, returns p.

    The length of the arc between the two points is their distance times 1 + angle^2/24 (exact to fourth order).
    """
    n = u.shape[0]
    if i < 2:
        for j in range(n):
            u[j] = points[i - 1, j] + h * tangents[i - 1, j]
        return values[i - 1] + h * tangents[i - 1, n]
    square = metric_p * (values[i - 1] - values[i - 2]) ** 2
    turn = metric_p * (tangents[i - 1, n] - tangents[i - 2, n]) ** 2
    chord = 0.0
    bend = 0.0
    for j in range(n):
        change = points[i - 1, j] - points[i - 2, j]
        chord += change * change
        change = tangents[i - 1, j] - tangents[i - 2, j]
        bend += change * change
    square += metric_u * chord
    turn += metric_u * bend
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
