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


def test_one_branch_and_both_ends():
    parabola = cv.AlgebraicProblem(lambda u, p: u**2 - p, [1.0], 1.0)
    graph = cv.diagram(parabola, within=(-2.0, 2.0))
    table = str(graph)
    assert table.startswith("1 branch in p within") and "EP1 .. EP2" in table
    assert all(end.endswith("p = 2") for end in graph["B1"].ended)
    line = cv.AlgebraicProblem(lambda u, p: u - p, [0.0], 0.0)
    ends = cv.diagram(line, within=(-2.0, 2.0))["B1"].ended
    assert [end.rpartition(" ")[2] for end in ends] == ["-2", "2"]


def test_what_has_run_away_is_seen_among_large_unknowns_too():
    """Distances from the start, not sizes, count, also where squares of the unknowns cancel; what is no number is away."""
    from contvines.continuation.reach import _away

    for base in (0.0, 1e3, 1e8):
        start = np.array([base, -base])
        points = start + np.array([[0.0, 0.0], [49.0, 49.0], [51.0, 51.0], [80.0, 0.0], [0.0, 60.0]])
        assert _away(points, start, 50.0, np.ones(2)).tolist() == [False, False, True, True, False]
        assert _away(2.0 * points, 2.0 * start, 50.0, np.full(2, 2.0)).tolist() == [
            False, False, True, True, False
        ]  # fmt: skip
    assert _away(np.array([[1e8, np.nan]]), np.array([1e8, 0.0]), 50.0, np.ones(2)).all()
