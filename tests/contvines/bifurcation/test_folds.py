"""Folds that a step may pass over: two of them between neighbouring points, one beside a branch point, and one at the end of the interval."""

import numpy as np
import pytest

import contvines as cv
from contvines.bifurcation.kinds import BORDERS
from tests.contvines.lines import Line


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


# ------------------------------------------------------------------ a pair or a multiplier that passes the circle beside a fold
def map_of(excess, bend, middle):
    """x turns at p = 1; beside it a spiral whose multipliers have the modulus 1 + excess - y/(1 + y), y = bend (x - middle)^2."""

    def f(x, p):
        y = bend * (x[0] - middle) ** 2
        modulus = 1.0 + excess - y / (1.0 + y)
        c, s = modulus * np.cos(1.1), modulus * np.sin(1.1)
        return [x[0] + 0.3 * (1.0 - p - x[0] ** 2), c * x[1] - s * x[2], s * x[1] + c * x[2]]

    return cv.MapProblem(f, [0.6, 0.0, 0.0], 0.64)


@pytest.mark.parametrize("max_step", [0.1, 0.003])
@pytest.mark.parametrize("middle", [0.0, 0.001, -0.02])
@pytest.mark.parametrize("excess", [1e-4, 1e-3])
def test_both_are_found_and_the_fold(max_step, middle, excess):
    """The modulus is 1 at y = excess/(1 - excess), either side of x = middle; the branch turns at x = 0, and is unstable below that."""
    bend = 40.0
    graph = cv.diagram(map_of(excess, bend, middle), within=(0.5, 1.5), settings={"max_step": max_step})
    assert not any(point.kind in BORDERS for point in graph.special.values())
    (fold,) = graph.of_kind("fold")
    assert fold.value == pytest.approx(1.0, abs=1e-10)
    x = middle + np.sqrt(excess / (1.0 - excess) / bend) * np.array([-1.0, 1.0])
    found = sorted(point.u[0] for point in graph.of_kind("neimark-sacker"))
    assert found == pytest.approx(list(x), abs=1e-7)


@pytest.mark.parametrize("max_step", [0.1, 0.03])
@pytest.mark.parametrize("pole", [1e-5, 4e-3])
@pytest.mark.parametrize("k", [0.3, 0.9, 1.1])
def test_a_multiplier_that_comes_back_from_infinity_beside_a_fold(max_step, pole, k):
    """As where an event of a virtual orbit grazes: on p = u^2, which turns at u = 0, it is -1 at u = 2 pole/(2 - k), and inside the circle before the fold and behind that."""
    problem = Line(
        multipliers=lambda u, p: [1.0 + k * u / (pole - u)],
        curve=lambda u, p: (p - u * u, -2.0 * u, 1.0),
        start=(-0.6, 0.36),
    )
    graph = cv.diagram(problem, within=(-0.2, 0.4), settings={"max_step": max_step}, depth=0)
    (fold,), (flip,) = graph.of_kind("fold"), graph.of_kind("period-doubling")
    assert abs(fold.value) < 1e-14
    assert flip.u[0] == pytest.approx(2.0 * pole / (2.0 - k), rel=1e-8)
