"""Tracing from a problem and from an orbit; counting in tables."""

from __future__ import annotations

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
