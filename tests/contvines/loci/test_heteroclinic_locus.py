"""Loci of heteroclinic cycles, beside the connections of the two saddles solved by shooting (scipy)."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import contvines as cv


def rates(x, p):
    """The normal form of a Bogdanov-Takens point with a half turn; saddles at (sqrt(-m1), 0) and (-sqrt(-m1), 0)."""
    return [x[1], p.m1 * x[0] + p.m2 * x[1] + x[0] ** 3 - x[0] ** 2 * x[1]]


def connection(m1: float) -> float:
    """m2 at which the unstable manifold of the one saddle is the stable manifold of the other, by bisection of their gap at x = 0."""
    side = np.sqrt(-m1)

    def height(m2: float, forward: bool) -> float:
        slopes = np.roots([1.0, -(m2 - side**2), -(m1 + 3 * side**2)]).real  # eigenvalues of the saddle
        slope = slopes.max() if forward else slopes.min()
        turn = 1.0 if forward else -1.0
        start = -turn * side * np.array([1.0, 0.0]) + turn * 1e-7 * np.array([1.0, slope])

        def f(_, x):
            return turn * np.array([x[1], m1 * x[0] + m2 * x[1] + x[0] ** 3 - x[0] ** 2 * x[1]])

        def middle(_, x):
            return x[0]

        middle.terminal = True
        return float(solve_ivp(f, (0, 200), start, rtol=1e-11, atol=1e-13, events=middle).y_events[0][0, 1])

    return brentq(lambda m2: height(m2, True) - height(m2, False), -0.15 * m1, -0.3 * m1, xtol=1e-12)


def distance(m1: float, period: float) -> float:
    """How far cycles of a period are from the connection at most: they begin exp(-rate * time) away from a saddle, so far that they leave it in time."""
    m2, square = connection(m1), -m1
    rate = np.roots([1.0, -(m2 - square), -2.0 * square]).max()
    return 10.0 * np.exp(-rate * period / 2)


@pytest.fixture(scope="module")
def graph():
    flow = cv.FlowProblem(rates, [0.0, 0.0], {"m2": -0.05, "m1": -0.5}, mirror=lambda x: -x)
    return cv.diagram(flow, over="m2", within=(-0.1, 0.3), depth=2)


def test_a_heteroclinic_cycle_is_followed(graph):
    locus = cv.locus(graph["HC1"], over="m1", within=(-1.0, -0.3))
    assert locus.orbit(0).period > 30.0
    assert (
        locus.kind == "homoclinic" and locus.limit == "heteroclinic"
    )  # the kind is that of all ends of infinite period
    assert "heteroclinic" in repr(locus)
    assert locus.branch.range == (-1.0, -0.3)
    for m1 in (-1.0, -0.5, -0.3):
        assert locus.at(m1) == pytest.approx([connection(m1)], abs=distance(m1, locus.orbit(0).period))


def test_a_period_of_its_own_may_be_shorter(graph):
    locus = cv.locus(graph["HC1"], over="m1", within=(-1.0, -0.3), period=42.0)
    assert locus.orbit(0).period == pytest.approx(42.0)
    for m1 in (-1.0, -0.5, -0.3):
        assert locus.at(m1) == pytest.approx([connection(m1)], abs=distance(m1, 42.0))


def test_a_period_out_of_reach_is_named(graph):
    with pytest.raises(ValueError, match="period = 1000: "):
        cv.locus(graph["HC1"], over="m1", within=(-1.0, -0.3), period=1000.0)
