"""Arithmetic that keeps its digits: small differences, reduced phases, positions beside a wall."""

from __future__ import annotations

import math

_TWO_PI = 2.0 * math.pi


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
