"""Borders of switches in closed form: on which side no motion is, and where branches touch one and do not cross it."""

import numpy as np
import pytest

import contvines as cv
from contvines.loci.codimension_two import find


@pytest.mark.parametrize(("slope", "piece", "turned"), [(1.0, 1.0, 1.0), (-1.0, -1.0, 1.0), (1.0, 1.0, -1.0)])
def test_the_side_on_which_the_margin_is_negative(slope, piece, turned):
    """u = s (p - m q), with the piece of one sign of u: it is left across the line p = m q, to where s (p - m q) has the other sign."""
    problem = cv.AlgebraicProblem(
        lambda u, p, sign: [u[0] - turned * (p.p - slope * p.q) - 0.0 * sign["u"]],
        [0.5 * piece],
        {"p": 0.5 * piece * turned, "q": 0.0},
        switches={"u": lambda u, p: u[0]},
    )
    graph = cv.diagram(problem, over="p", within=(-1.0, 1.0), depth=0)
    chart = cv.chart(graph, over="q", within=(-0.8, 0.8), regions=False)
    (locus,) = chart.loci.values()
    p, q = locus.values.T
    np.testing.assert_allclose(p, slope * q, atol=1e-9)
    dp, dq = p[-1] - p[0], q[-1] - q[0]
    # a little to that side of the line, as one goes along it in the plane (q, p)
    across = locus.beyond * np.array([-dp, dq])
    assert piece * turned * (across[1] - slope * across[0]) < 0.0


@pytest.mark.slow
def test_a_map_whose_fixed_point_touches_a_switch():
    # x' = x / 2 + (q - (p - 1)^2) / 2 + y^2, y' = y / 3: fixed point (q - (p - 1)^2, 0), switch at x = p / 5
    problem = cv.MapProblem(
        lambda x, p, sign: [x[0] / 2 + (p.q - (p.p - 1) ** 2) / 2 + x[1] ** 2, x[1] / 3],
        [0.4, 0.0],
        {"p": 0.9, "q": 0.5},
        switches={"s": lambda x, p: x[0] - p.p / 5},
    )
    graph = cv.diagram(problem, over="p", within=(-0.5, 2.5))
    locus = cv.locus(graph.of_kind("switch")[0], over="q", within=(-0.2, 1.0))
    (point,) = [p for _, p in find(locus) if p.kind == "degenerate-border"]
    # q - (p - 1)^2 - p / 5 = 0 with 2 (p - 1) = -1 / 5
    assert point.value == pytest.approx((0.9, 0.19), abs=1e-12)
    assert point.coefficients == pytest.approx({"a": -1.0, "b": 1.0}, rel=1e-9)
    assert [turn.value for turn in locus.turns] == [pytest.approx((0.9, 0.19), abs=1e-6)]
