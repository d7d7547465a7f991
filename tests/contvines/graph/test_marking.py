"""Borders of one value on one branch: two points where the solutions are two, each with its tangent."""

import numpy as np
import pytest

import contvines as cv


def test_a_circle_cut_in_two():
    """On the circle u^2 + p^2 = 1 at p = 0.3."""
    circle = cv.AlgebraicProblem(
        lambda u, p, sign: u**2 + p**2 - 1.0, [1.0], 0.0, switches={"s": lambda u, p: p - 0.3}, scale=1.0
    )
    graph = cv.diagram(circle, within=(-2.0, 2.0), depth=0)
    points = [p for p in graph.special.values() if p.kind == "switch"]
    assert sorted(p.u[0] for p in points) == pytest.approx(
        [-np.sqrt(0.91), np.sqrt(0.91)]
    )  # two, at one value
    for point in points:
        assert point.value == pytest.approx(0.3, abs=1e-10)
        u, t = point.u[0], point.tangent
        assert abs(t[0] * u + t[1] * 0.3) < 1e-6 * np.linalg.norm(t)
        assert 0.0 <= point.location_error < 1e-8
    assert len(graph.branches) == 2 and {s.point for s in graph.switches} == {p.label for p in points}
    assert {s.note for s in graph.switches} <= {"persistence", ""} and graph.switches[0].note == "persistence"
