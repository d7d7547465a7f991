"""Loci of heteroclinic cycles of two saddles, in closed form.

With H = y^2 / 2 + a x^2 / 2 - x^4 / 4, x' = y and y' = -H_x - (H - E + m - a^2) y, E = a^2 / 4 the height of the saddles at x = +-sqrt(a), the
cycle is H = E - (m - a^2), so that it connects the saddles at m = a^2, where their eigenvalues are +-sqrt(2 a).
"""

import numpy as np
import pytest

import contvines as cv


def rates(x, p):
    H = x[1] ** 2 / 2 + p.a * x[0] ** 2 / 2 - x[0] ** 4 / 4
    return [x[1], x[0] ** 3 - p.a * x[0] - (H - 1.25 * p.a**2 + p.m) * x[1]]


@pytest.fixture(scope="module")
def graph():
    flow = cv.FlowProblem(
        rates, [0.0, 0.0], {"m": 0.35, "a": 0.5}, mirror=lambda x: -x, settings={"homoclinic": 1e-5}
    )
    return cv.diagram(flow, over="m", within=(0.2, 0.4), depth=2)


@pytest.mark.parametrize("period", [None, 42.0])
def test_a_heteroclinic_cycle_is_followed(graph, period):
    locus = cv.locus(graph["HC1"], over="a", within=(0.3, 0.7), period=period)
    seen = locus.orbit(0).period
    assert seen == pytest.approx(period) if period else seen > 20.0
    # the kind is that of all ends of infinite period
    assert locus.kind == "homoclinic" and locus.limit == "heteroclinic" and "heteroclinic" in repr(locus)
    assert locus.branch.range == (0.3, 0.7)
    # cycles begin exp(-rate * time) away from a saddle, so far that they leave it in time
    m, a = locus.values.T
    assert (np.abs(m - a**2) < 10.0 * np.exp(-np.sqrt(2 * a) * seen / 2)).all()


def test_a_period_out_of_reach_is_named(graph):
    with pytest.raises(ValueError, match="period = 1000: "):
        cv.locus(graph["HC1"], over="a", within=(0.3, 0.7), period=1000.0)
