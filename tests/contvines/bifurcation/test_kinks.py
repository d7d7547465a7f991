"""Corners that the metric hides, and pairs that pass the axis where only branch points are looked for; all in closed form."""

from __future__ import annotations

import numpy as np
import pytest

import contvines as cv


def pitchfork(u, p):
    """x (2 p + 3 x^2 + 3) = 0, hidden behind two unknowns that are hundreds of times as large."""
    x, y, z = 3.0 * u[0] - u[2] * 2.0 - u[1], u[1] - u[2], u[2] - 3.0 * (u[1] - u[2])
    return np.array([x * (2.0 * p + 3.0 * x * x + 3.0), y + p * p + x * x + 8.0, z - 3.0 * p * x - 100.0 * y])


def unknowns(x, p):
    y = -p * p - x * x - 8.0
    z = 3.0 * p * x + 100.0 * y
    third = z + 3.0 * y
    second = y + third
    return np.array([(x + 2.0 * third + second) / 3.0, second, third])


def test_a_step_round_a_hidden_corner_is_taken_back():
    p0 = -1.75
    start = unknowns(np.sqrt(-(2.0 * p0 + 3.0) / 3.0), p0)
    assert np.abs(pitchfork(start, p0)).max() < 1e-10
    graph = cv.diagram(cv.AlgebraicProblem(pitchfork, start, p0), within=(-2.0, 2.0), depth=4)
    points = [point for point in graph.special.values() if point.kind != "end"]
    assert [point.kind for point in points] == ["branch-point"]
    assert points[0].value == pytest.approx(-1.5, abs=1e-9)
    assert not graph.unresolved
    ends = {
        (round(float(p), 9), round(float(3.0 * u[0] - 2.0 * u[2] - u[1]), 5))
        for branch in graph
        for p, u in ((branch.values[0], branch.points[0]), (branch.values[-1], branch.points[-1]))
    }
    side = round(float(np.sqrt(1.0 / 3.0)), 5)
    assert ends == {(-2.0, side), (-2.0, -side), (-2.0, 0.0), (2.0, 0.0)}


@pytest.mark.parametrize("frequency", [1.0, 0.05])
def test_a_pair_on_the_axis_is_no_branch_point(frequency):
    def normal_form(u, p):
        x, y = u
        return np.array(
            [p * x - frequency * y - x * (x * x + y * y), frequency * x + p * y - y * (x * x + y * y)]
        )

    graph = cv.diagram(cv.AlgebraicProblem(normal_form, [0.0, 0.0], -1.0), within=(-2.0, 2.0))
    assert [point.kind for point in graph.special.values()] == ["end", "end"]
    assert not graph.unresolved
