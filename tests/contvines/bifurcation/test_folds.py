"""Folds that a step may pass over: two of them between neighbouring points, one beside a branch point, and one at the end of the interval."""

import numpy as np
import pytest

import contvines as cv


@pytest.mark.parametrize("e", [2e-2, 1e-2, 5e-3, 2e-3, 1e-3])
@pytest.mark.parametrize("start", [-0.50, -0.493, -0.487])
def test_two_folds_in_one_step(e, start):
    """p = x^3 - 3 e^2 x turns at x = -e and x = e, where p = 2 e^3 and -2 e^3; the eigenvalue is 3 (e^2 - x^2). With the other sign nothing turns."""

    def graph(sign):
        def F(x, p):
            return p - x**3 + sign * 3 * e**2 * x

        problem = cv.AlgebraicProblem(F, [start], -float(F(start, 0.0)), spectrum="flow")
        return cv.diagram(problem, within=(-0.2, 0.2))

    turning = graph(1.0)
    folds = turning.of_kind("fold")
    assert [f.value for f in folds] == pytest.approx([2 * e**3, -2 * e**3], rel=1e-9)
    assert [f.u[0] for f in folds] == pytest.approx([-e, e], rel=1e-7)
    assert not turning.of_kind("branch-point") and len(turning) == 1
    between = turning["B1"].points[~turning["B1"].stable][:, 0]
    assert len(between) and np.all(np.abs(between) <= e * (1 + 1e-6))
    assert not graph(-1.0).of_kind("fold")


@pytest.mark.parametrize(("b", "c"), [(0.002, 100.0), (0.006, 100.0), (0.02, 1000.0)])
def test_a_fold_just_behind_a_branch_point(b, c):
    """p = c u^2 - b u crosses u = 0 at p = 0 and turns at u = b / 2c, within a fiftieth of the first step."""
    problem = cv.AlgebraicProblem(lambda u, p: u * (p + b * u - c * u**2), [0.0], -0.5, scale=1.0)
    (fold,) = cv.diagram(problem, within=(-0.5, 0.5), depth=1).of_kind("fold")
    assert (fold.value, fold.u[0]) == pytest.approx((-(b**2) / (4.0 * c), b / (2.0 * c)), rel=1e-6)


@pytest.mark.parametrize("outside", [1e-3, 1e-5, 1e-7, 1e-9, 1e-11, 0.0])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_parabola_ends_where_it_leaves_the_interval(outside, side):
    """p = +-x^2 turns back at x = 0, which is not in the interval: of its two sides the one with the start is; if it is its end, the branch turns."""
    problem = cv.AlgebraicProblem(lambda u, p: p - side * u**2, [0.9], 0.81 * side)
    graph = cv.diagram(problem, within=tuple(sorted((side * outside, side))))
    (branch,) = graph
    if outside:
        assert [point.kind for point in graph.special.values()] == ["end", "end"]
        assert sorted(abs(branch.values[[0, -1]])) == pytest.approx([outside, 1.0], rel=1e-12)
        assert branch.points.min() == pytest.approx(np.sqrt(outside), rel=1e-6)
        assert {ending.reason.value for ending in branch.endings} == {"left-interval"}
    else:
        (fold,) = graph.of_kind("fold")
        assert abs(fold.value) < 1e-15 and branch.points.min() == pytest.approx(-1.0)
