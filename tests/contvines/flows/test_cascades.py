"""Branches deep in a cascade of doublings end at cycles of half the period, however small the difference from these is in the branch's own measure."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import fsolve

import contvines as cv

MU = 0.2


def oscillator(x, p, t):
    """Duffing's and van der Pol's, forced."""
    return [x[1], MU * (1.0 - x[0] ** 2) * x[1] - x[0] ** 3 + p.f * np.cos(t)]


def after(x, f, periods):
    """State and its derivatives by the first one after some periods, by DOP853 with the variational equations."""

    def rates(t, y):
        a = [[0.0, 1.0], [-2.0 * MU * y[0] * y[1] - 3.0 * y[0] ** 2, MU * (1.0 - y[0] ** 2)]]
        forced = [y[1], MU * (1.0 - y[0] ** 2) * y[1] - y[0] ** 3 + f * np.cos(t)]
        return np.concatenate([forced, (np.array(a) @ y[2:].reshape(2, 2)).ravel()])

    start = np.concatenate([x, np.eye(2).ravel()])
    run = solve_ivp(rates, (0.0, 2.0 * np.pi * periods), start, method="DOP853", rtol=1e-12, atol=1e-13)
    return run.y[:2, -1], run.y[2:, -1].reshape(2, 2)


def doubling(x, f, periods):
    """Where the cycle of so many periods has a multiplier -1, by shooting."""

    def missed(v):
        y, m = after(v[:2], v[2], periods)
        return [*(y - v[:2]), np.linalg.det(m + np.eye(2))]

    return fsolve(missed, [*x, f], xtol=1e-12)[2]


@pytest.mark.slow
def test_a_branch_of_eight_periods_ends_at_the_doublings_of_that_of_four():
    flow = cv.FlowProblem(oscillator, [-1.0, 0.0], {"f": 7.1}, period=2.0 * np.pi)
    graph = cv.diagram(flow.attractor([-1.0, 0.0], f=7.1), over="f", within=(6.9, 7.9), depth=0)
    points = sorted(graph.of_kind("period-doubling"), key=lambda point: point.value)
    assert len(points) == 4  # its own two lie between those at which it ends
    for point in points[::3]:
        assert point.value == pytest.approx(doubling(point.orbit(0.0), point.value, 4), abs=1e-7)
