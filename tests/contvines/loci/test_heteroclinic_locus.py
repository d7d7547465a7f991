"""Loci of heteroclinic cycles, beside the connections of the two saddles solved by shooting (scipy)."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import contvines as cv


def rates(x, m1, m2):
    """The normal form of a Bogdanov-Takens point with a half turn; saddles at (sqrt(-m1), 0) and (-sqrt(-m1), 0)."""
    return np.array([x[1], m1 * x[0] + m2 * x[1] + x[0] ** 3 - x[0] ** 2 * x[1]])


def slopes(m1, m2):
    """Eigenvalues of the saddles."""
    return np.roots([1.0, -(m2 + m1), 2.0 * m1]).real


def connection(m1):
    """m2 at which the unstable manifold of the one saddle is the stable manifold of the other, by bisection of their gap at x = 0."""

    def middle(_, x):
        return x[0]

    middle.terminal = True

    def height(m2, turn):
        slope = turn * max(turn * slopes(m1, m2))
        start = turn * np.array([1e-7 - np.sqrt(-m1), 1e-7 * slope])
        run = solve_ivp(
            lambda _, x: turn * rates(x, m1, m2), (0, 200), start, rtol=1e-11, atol=1e-13, events=middle
        )
        return float(run.y_events[0][0, 1])

    return brentq(lambda m2: height(m2, 1.0) - height(m2, -1.0), -0.15 * m1, -0.3 * m1, xtol=1e-12)


@pytest.fixture(scope="module")
def graph():
    flow = cv.FlowProblem(
        lambda x, p: rates(x, p.m1, p.m2), [0.0, 0.0], {"m2": -0.05, "m1": -0.5}, mirror=lambda x: -x
    )
    return cv.diagram(flow, over="m2", within=(-0.1, 0.3), depth=2)


@pytest.mark.parametrize("period", [None, 42.0])
def test_a_heteroclinic_cycle_is_followed(graph, period):
    locus = cv.locus(graph["HC1"], over="m1", within=(-1.0, -0.3), period=period)
    seen = locus.orbit(0).period
    assert seen == pytest.approx(period) if period else seen > 30.0
    # the kind is that of all ends of infinite period
    assert locus.kind == "homoclinic" and locus.limit == "heteroclinic" and "heteroclinic" in repr(locus)
    assert locus.branch.range == (-1.0, -0.3)
    for m1 in (-1.0, -0.5, -0.3):
        m2 = connection(m1)
        # cycles begin exp(-rate * time) away from a saddle, so far that they leave it in time
        far = 10.0 * np.exp(-slopes(m1, m2).max() * seen / 2)
        assert locus.at(m1) == pytest.approx([m2], abs=far)


def test_a_period_out_of_reach_is_named(graph):
    with pytest.raises(ValueError, match="period = 1000: "):
        cv.locus(graph["HC1"], over="m1", within=(-1.0, -0.3), period=1000.0)
