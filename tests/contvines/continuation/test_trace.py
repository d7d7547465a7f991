"""Tracing from a problem and from an orbit; counting in tables."""

from __future__ import annotations

from itertools import islice

import numpy as np

import contvines as cv
from tests.machines import ABSORBER


def test_trace_from_an_orbit():
    orbit = ABSORBER.symmetric_orbit(amplitude=0.6)
    points = list(cv.trace(orbit, within=(0.5, 0.7), over="amplitude"))
    assert points[-1].value == 0.7 and points[-1].status.startswith("reaches the end of the interval")
    assert points[0].value == 0.6 and all(point.stable for point in points)
    problem = orbit.problem("amplitude")
    u, p = orbit.seed(problem)
    again = list(cv.trace(problem, (0.5, 0.7), u, p))
    np.testing.assert_array_equal([a.u for a in again], [b.u for b in points])


def test_trace_of_a_problem_keeps_its_start():
    circle = cv.AlgebraicProblem(lambda u, p: u**2 + p**2 - 1, [1.0], 0.0)
    values = [point.value for point in islice(cv.trace(circle, (-2.0, 2.0)), 5)]
    assert values[0] == 0.0 and np.all(np.diff(values) > 0.0)
