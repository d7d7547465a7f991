"""Degenerate borders: branches that touch a border and do not cross it."""

import mpmath as mp
import numpy as np
import pytest

import contvines as cv
from contvines.loci.codimension_two import find

pytestmark = pytest.mark.slow


def test_a_touched_border_in_many_digits():
    # u + 0.3 u^3 = p^2 + p^3 / 2 - q with a wall at h = u + sin(p) / 5 + u q / 10
    problem = cv.AlgebraicProblem(
        lambda u, p, sign: np.array([u[0] + 0.3 * u[0] ** 3 - p.p**2 - 0.5 * p.p**3 + p.q]),
        [0.8],
        {"p": 0.9, "q": 0.2},
        parameter="p",
        switches={"wall": lambda u, p: u[0] + 0.2 * np.sin(p.p) + 0.1 * u[0] * p.q},
    )
    graph = cv.diagram(problem, over="p", within=(-1.2, 1.2))
    chart = cv.chart(graph, over="q", within=(-0.6, 0.5), regions=False)
    (point,) = chart.points.values()
    assert (point.label, point.kind, point.on) == ("DB1", "degenerate-border", ["SW1"])
    with mp.workdps(40):

        def system(u, p, q):
            rate = (2 * p + 3 * p**2 / 2) / (1 + 9 * u**2 / 10)  # du/dp along the branch
            height = u + mp.sin(p) / 5 + u * q / 10
            return [u + 3 * u**3 / 10 - p**2 - p**3 / 2 + q, height, rate * (1 + q / 10) + mp.cos(p) / 5]

        u, p, q = mp.findroot(system, [mp.mpf(float(v)) for v in (*point.u, *point.value)])
        assert point.value == pytest.approx((float(p), float(q)), abs=1e-11)

        def height(p, q):
            u0 = mp.findroot(lambda x: x + 3 * x**3 / 10 - p**2 - p**3 / 2 + q, u, tol=1e-60)
            return u0 + mp.sin(p) / 5 + u0 * q / 10

        bend, slope = mp.diff(lambda x: height(x, q), p, 2) / 2, mp.diff(lambda y: height(p, y), q)
        assert point.coefficients == pytest.approx({"a": float(bend), "b": float(slope)}, rel=1e-8)
    # two borders on one side, none on the other, where the coefficients put them
    a, b = point.coefficients["a"], point.coefficients["b"]
    for step in (1e-4, -1e-4):
        found = chart["SW1"].at(point.value[1] + step)
        if -b * step / a < 0.0:
            assert len(found) == 0
        else:
            assert found - point.value[0] == pytest.approx(
                [-np.sqrt(-b * step / a), np.sqrt(-b * step / a)], rel=0.02
            )


def test_a_map_whose_fixed_point_touches_a_switch():
    # x' = x / 2 + (q - (p - 1)^2) / 2 + y^2, y' = y / 3: fixed point (q - (p - 1)^2, 0), switch at x = p / 5
    problem = cv.MapProblem(
        lambda x, p, sign: np.array([x[0] / 2 + (p.q - (p.p - 1) ** 2) / 2 + x[1] ** 2, x[1] / 3]),
        [0.4, 0.0],
        {"p": 0.9, "q": 0.5},
        parameter="p",
        switches={"s": lambda x, p: x[0] - p.p / 5},
    )
    graph = cv.diagram(problem, over="p", within=(-0.5, 2.5))
    locus = cv.locus(graph.of_kind("switch")[0], over="q", within=(-0.2, 1.0))
    (point,) = [p for _, p in find(locus) if p.kind == "degenerate-border"]
    # q - (p - 1)^2 - p / 5 = 0 with 2 (p - 1) = -1 / 5
    assert point.value == pytest.approx((0.9, 0.19), abs=1e-12)
    assert point.coefficients == pytest.approx({"a": -1.0, "b": 1.0}, rel=1e-9)
    assert [turn.value for turn in locus.turns] == [pytest.approx((0.9, 0.19), abs=1e-6)]
