"""Arithmetic that keeps its digits: small differences, reduced phases, positions beside a wall."""

from __future__ import annotations

import math

_TWO_PI = 2.0 * math.pi


def remainders(x):
    """sin x, 1 - cos x, x - sin x and x^2/2 - 1 + cos x, each to full relative accuracy for small x."""
    z = x * x
    if z < 0.25:
        third = 1 / 5040 - z * (1 / 362880 - z * (1 / 39916800 - z / 6227020800))
        third = x * z * (1 / 6 - z * (1 / 120 - z * third))
        fourth = 1 / 40320 - z * (1 / 3628800 - z * (1 / 479001600 - z / 87178291200))
        fourth = z * z * (1 / 24 - z * (1 / 720 - z * fourth))
        return x - third, 0.5 * z - fourth, third, fourth
    sine = math.sin(x)
    versine = 1.0 - math.cos(x)
    return sine, versine, x - sine, 0.5 * z - versine


def wrap(angle):
    """The angle reduced to [0, 2 pi), and the number of turns taken away."""
    turns = math.floor(angle / _TWO_PI)
    if turns != 0.0:
        angle -= turns * _TWO_PI
    if angle < 0.0:
        angle = 0.0
    elif angle >= _TWO_PI:
        angle = 0.0
        turns += 1.0
    return angle, turns


def shift(w, low, step):
    """w + low + step as a sum of two floats (Knuth's two-sum)."""
    total = w + step
    virtual = total - w
    rest = (w - (total - virtual)) + (step - virtual) + low
    out = total + rest
    return out, rest - (out - total)
