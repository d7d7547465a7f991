"""How far ahead the loop sees."""

import itertools
import math

import numpy as np
import pytest

from contvines.continuation.corrector import Metric, extrapolate

ONES = np.ones(2)
FLAT = Metric(ONES, ONES, 1.0, 1.0)


def circle(angles):
    """Points of the unit circle as unknown and parameter, and their tangents."""
    z = np.column_stack([np.cos(angles), np.sin(angles)])
    t = np.column_stack([-np.sin(angles), np.cos(angles)])
    return np.ascontiguousarray(z[:, :1]), np.ascontiguousarray(z[:, 1]), t


def ahead(step):
    """Error of the prediction over a step on the unit circle, from two points as far apart."""
    points, values, tangents = circle(0.4 + step * np.arange(3.0))
    u = np.zeros(1)
    p = extrapolate(points, values, tangents, 2, step, FLAT, u)
    return math.hypot(u[0] - points[2, 0], p - values[2])


def test_the_prediction_is_of_fourth_order():
    """So it is in arc length; with chords for arcs it would be of third order."""
    errors = [ahead(step) for step in (0.2, 0.1, 0.05)]
    orders = [math.log2(a / b) for a, b in itertools.pairwise(errors)]
    assert orders == pytest.approx([4.0, 4.0], abs=0.15)
    assert errors[1] < 0.3 * 0.1**4
