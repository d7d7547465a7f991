"""Points of users' kinds on a locus."""

import numpy as np
import pytest
from scipy.optimize import fsolve

import contvines as cv


def predators(u, p):
    """Bazykin's predator and prey; Kuznetsov's example 8.3."""
    x, y = u
    eaten = x * y / (1.0 + p.alpha * x)
    return [x - eaten - x**2 / 100.0, -y + eaten - p.delta * y**2]


def by_hand(v):
    """Equilibrium, zero determinant and zero trace, differentiated by hand."""
    x, y, a, d = v
    eaten, by_x, by_y = x * y / (1 + a * x), y / (1 + a * x) ** 2, x / (1 + a * x)
    j = np.array([[1 - by_x - x / 50, -by_y], [by_x, -1 + by_y - 2 * d * y]])
    return [x - eaten - x**2 / 100, -y + eaten - d * y**2, np.linalg.det(j), np.trace(j)]


def test_a_zero_trace_on_a_locus_of_folds_is_a_bogdanov_takens_point():
    problem = cv.AlgebraicProblem(predators, [20.0, 5.5], {"alpha": 0.4, "delta": 0.15}, spectrum="flow")
    graph = cv.diagram(problem, over="alpha", within=(0.3, 0.6))
    trace = cv.Kind("zero-trace", "ZT", test=lambda point: np.trace(point.jacobian))
    never = cv.Kind("never", "NEV", test=trace.test, verify=lambda point: point.parameters["delta"] < 0.1)
    found = cv.locus(graph["LP2"], over="delta", within=(0.01, 0.4), kinds=[*cv.KINDS, trace, never])
    alpha, delta = fsolve(by_hand, [10.0, 5.0, 0.45, 0.17], xtol=1e-13)[2:]
    assert found.points["ZT1"].value == pytest.approx((alpha, delta), rel=1e-10)
    assert found.points["BT1"].value == pytest.approx((alpha, delta), rel=1e-10)
    assert {"ZT1", "BT1"} == set(found.points)
