"""Folds that a step may pass over: two of them between neighbouring points, and one beside a border."""

import numpy as np
import pytest

import contvines as cv


@pytest.mark.parametrize("e", [2e-2, 1e-2, 5e-3, 2e-3, 1e-3])
@pytest.mark.parametrize("start", [-0.50, -0.493, -0.487])
def test_two_folds_in_one_step(e, start):
    """p = x^3 - 3 e^2 x turns at x = -e and x = e, where p = 2 e^3 and -2 e^3; the eigenvalue is 3 (e^2 - x^2)."""
    problem = cv.AlgebraicProblem(
        lambda x, p: p - x**3 + 3 * e**2 * x, [start], start**3 - 3 * e**2 * start, spectrum="flow"
    )
    graph = cv.diagram(problem, within=(-0.2, 0.2))
    folds = graph.of_kind("fold")
    assert [f.value for f in folds] == pytest.approx([2 * e**3, -2 * e**3], rel=1e-9)
    assert [f.u[0] for f in folds] == pytest.approx([-e, e], rel=1e-7)
    assert not graph.of_kind("branch-point") and len(graph) == 1
    between = graph["B1"].points[~graph["B1"].stable][:, 0]
    assert len(between) and np.all(np.abs(between) <= e * (1 + 1e-6))


def test_an_inflection_is_no_pair_of_folds():
    """p = x^3 + 3 e^2 x is monotonic, however small e."""
    for e in (1e-2, 1e-3, 1e-4):
        problem = cv.AlgebraicProblem(lambda x, p, e=e: p - x**3 - 3 * e**2 * x, [-0.5], -0.125 - 1.5 * e**2)
        assert not cv.diagram(problem, within=(-0.2, 0.2)).of_kind("fold")


@pytest.mark.parametrize(("b", "c"), [(0.002, 100.0), (0.006, 100.0), (0.02, 1000.0)])
def test_a_fold_just_behind_a_branch_point(b, c):
    """p = c u^2 - b u crosses u = 0 at p = 0 and turns at u = b / 2c, within a fiftieth of the first step."""
    problem = cv.AlgebraicProblem(lambda u, p: u * (p + b * u - c * u**2), [0.0], -0.5, scale=1.0)
    graph = cv.diagram(problem, within=(-0.5, 0.5), depth=1)
    (fold,) = graph.of_kind("fold")
    assert (fold.value, fold.u[0]) == pytest.approx((-(b**2) / (4.0 * c), b / (2.0 * c)), rel=1e-6)
