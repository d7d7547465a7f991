"""Stated errors of branch points cover what rounding of the matrices does to their places, and not very much more; what has no place is not told."""

from dataclasses import replace

import numpy as np
import pytest

import contvines as cv
from contvines.bifurcation.segment_search import SegmentSearch


@pytest.mark.parametrize("growth", [5.0, 10.0, 20.0, 30.0])
def test_a_branch_point_beside_an_eigenvalue_that_has_grown(growth):
    """x (x - p + 0.3) = 0 and exp(growth p) (y - 1) = 0, mixed: at p = 0.3 eigenvalues, relative to those at p = -0.7, are 0 and exp(growth)."""
    mixed, rows = np.array([[3.0, 7.0], [2.0, 5.0]]), np.array([[2.0, -3.0], [-7.0, 11.0]])

    def F(u, p):
        x, y = mixed @ u
        return rows @ np.array([x * (x - p + 0.3), np.exp(growth * p) * (y - 1.0)])

    start = np.linalg.solve(mixed, [0.0, 1.0])
    graph = cv.diagram(cv.AlgebraicProblem(F, start, -0.7), within=(-0.8, 0.8), depth=0)
    (point,) = graph.of_kind("branch-point")
    assert abs(point.value - 0.3) <= point.location_error < 1e-8


@pytest.mark.parametrize("start", [-1.7, -0.6, 0.3, 0.9, 1.2, 1.5, 1.9])
def test_errors_of_branch_points_where_all_entries_cancel_are_bounds(start):
    """x (x + 1) (3 p + 2 x - 3), multiplied out: at the crossings, p = 1 and 5/3, both derivatives are sums that cancel, so that their size does not tell their rounding."""
    problem = cv.AlgebraicProblem(
        lambda x, p: 3 * p * x**2 + 3 * p * x + 2 * x**3 - x**2 - 3 * x, [1.5 * (1.0 - start)], start
    )
    points = cv.diagram(problem, within=(-2.0, 2.0), depth=0).of_kind("branch-point")
    assert len(points) == 2
    for point, true in zip(sorted(points, key=lambda point: point.value), (1.0, 5.0 / 3.0), strict=True):
        assert abs(point.value - true) <= point.location_error < 1e-9


@pytest.mark.parametrize(("error", "told"), [(1e-3, 1), (1.0, 1), (2.1, 0), (np.inf, 0)])
def test_a_point_whose_error_is_longer_than_the_interval_is_not_told(error, told, monkeypatch):
    """x (x - p) = 0 has a branch point at p = 0, which is said to be somewhere within the interval, or anywhere."""
    search = SegmentSearch.search

    def vaguely(self, *args, **options):
        found = search(self, *args, **options)
        return [replace(e, error=error) if e.kind == "branch-point" else e for e in found]

    monkeypatch.setattr(SegmentSearch, "search", vaguely)
    monkeypatch.setattr("contvines.bifurcation.consistency.is_inexact", lambda segment, event: False)
    graph = cv.diagram(
        cv.AlgebraicProblem(lambda u, p: u * (u - p), [0.0], -0.7), within=(-1.0, 1.0), depth=0
    )
    assert len(graph.of_kind("branch-point")) == told
