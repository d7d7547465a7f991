"""Newton's corrections one by one: when they are taken, when they are enough, when there is no hope."""

import itertools
import math

import numpy as np
import pytest

import contvines as cv
from contvines.continuation.corrector import Metric, extrapolate
from contvines.continuation.engine import Engine
from contvines.continuation.settings import Settings

ONES = np.ones(2)
FLAT = Metric(ONES, ONES, 1.0, 1.0)


def test_a_solution_that_newton_misses_is_none_and_costs_little():
    calls = []

    def F(u, p):
        calls.append(float(np.real(u[0])))
        return np.arctan(u) - p

    problem = cv.AlgebraicProblem(F, [0.0], 0.0, scale=1.0)
    engine = Engine(problem, (-1.0, 1.0), Settings())
    calls.clear()
    assert engine.at_value(np.array([3.0]), 0.0) is None
    assert len(calls) < 60
    assert engine.at_value(np.array([1.0]), 0.0).u[0] == pytest.approx(0.0, abs=1e-12)


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
