"""A branch that leaves the interval between two steps ends where it does, however little it is outside."""

import numpy as np
import pytest

import contvines as cv


@pytest.mark.parametrize("outside", [1e-3, 1e-5, 1e-7, 1e-9, 1e-11])
@pytest.mark.parametrize("upwards", [True, False])
def test_a_parabola_ends_where_it_leaves_the_interval(outside, upwards):
    """p = +-x^2 turns back at x = 0, which is not in the interval: of its two sides the one with the start is."""
    side = 1.0 if upwards else -1.0
    problem = cv.AlgebraicProblem(lambda u, p: np.array([p - side * u[0] ** 2]), [0.9], 0.81 * side)
    graph = cv.diagram(problem, within=tuple(sorted((side * outside, side))))
    assert [point.kind for point in graph.special.values()] == ["end", "end"]
    (branch,) = graph
    assert sorted(abs(branch.values[[0, -1]])) == pytest.approx([outside, 1.0], rel=1e-12)
    assert branch.points.min() == pytest.approx(np.sqrt(outside), rel=1e-6)
    assert {ending.reason.value for ending in branch.endings} == {"left-interval"}


def test_a_parabola_that_turns_at_the_end_of_the_interval_turns():
    """Its fold is the last value of the interval."""
    problem = cv.AlgebraicProblem(lambda u, p: np.array([p - u[0] ** 2]), [0.9], 0.81)
    graph = cv.diagram(problem, within=(0.0, 1.0))
    (fold,) = graph.of_kind("fold")
    assert abs(fold.value) < 1e-15
    assert graph["B1"].points.min() == pytest.approx(-1.0)
