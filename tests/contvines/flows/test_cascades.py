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


def roessler(x, p):
    """Roessler's flow, a = b = 0.2."""
    return [-x[1] - x[2], x[0] + 0.2 * x[1], 0.2 + x[2] * (x[0] - p.c)]


def rounds_of_roessler(y, c, time):
    """State and derivatives by the first one, by DOP853 with the variational equations."""

    def rates(t, z):
        a = np.array([[0.0, -1.0, -1.0], [1.0, 0.2, 0.0], [z[2], 0.0, z[0] - c]])
        own = [-z[1] - z[2], z[0] + 0.2 * z[1], 0.2 + z[2] * (z[0] - c)]
        return np.concatenate([own, (a @ z[3:].reshape(3, 3)).ravel()])

    start = np.concatenate([y, np.eye(3).ravel()])
    run = solve_ivp(rates, (0.0, time), start, method="DOP853", rtol=1e-12, atol=1e-13)
    return run.y[:3, -1], run.y[3:, -1].reshape(3, 3)


@pytest.mark.slow
def test_a_cycle_of_eight_rounds_from_a_simulation_ends_at_the_doubling_of_that_of_four():
    flow = cv.FlowProblem(roessler, [1.0, 1.0, 0.0], {"c": 4.18})
    graph = cv.diagram(flow.attractor([1.0, 1.0, 0.0], c=4.18), over="c", within=(2.0, 6.0), depth=0)
    assert not graph.of_kind("branch-point")
    end = min(graph.of_kind("period-doubling"), key=lambda point: point.value)

    def missed(v):
        y, m = rounds_of_roessler([0.0, *v[:2]], v[2], v[3])
        return [*(y - [0.0, *v[:2]]), np.linalg.det(m + np.eye(3))]

    times = np.linspace(0.0, end.orbit.period, 4001)
    heights = end.orbit(times)[:, 0]
    k = int(np.flatnonzero((heights[:-1] < 0.0) & (heights[1:] >= 0.0))[0])
    found = fsolve(missed, [*end.orbit(times[k])[1:], end.value, 0.5 * end.orbit.period], xtol=1e-12)
    assert end.value == pytest.approx(found[2], abs=1e-6)


def half_of_ueda(x, f):
    """Mirror image of the state half a period later, with its derivatives by the first one; -x at t + pi solves the equations as x does at t."""

    def rates(t, y):
        a = np.array([[0.0, 1.0], [-3.0 * y[0] ** 2, -0.1]])
        own = [y[1], -(y[0] ** 3) - 0.1 * y[1] + f * np.cos(t)]
        return np.concatenate([own, (a @ y[2:].reshape(2, 2)).ravel()])

    run = solve_ivp(
        rates, (0.0, np.pi), np.concatenate([x, np.eye(2).ravel()]), method="DOP853", rtol=1e-12, atol=1e-13
    )
    return -run.y[:2, -1], -run.y[2:, -1].reshape(2, 2)


@pytest.mark.parametrize("mirrored", [True, False])
def test_a_forced_oscillator_loses_its_symmetry_where_shooting_has_it(mirrored):
    """Ueda's oscillator: whether its symmetry is named or not, the symmetric motion goes on as an unstable one."""

    def missed(v):
        y, m = half_of_ueda(v[:2], v[2])
        return [*(y - v[:2]), np.linalg.det(m + np.eye(2))]  # the square has +1

    def rates(x, p, t):
        return [x[1], -(x[0] ** 3) - 0.1 * x[1] + p.f * np.cos(t)]

    def mirror(x):
        return -x

    flow = cv.FlowProblem(
        rates, [0.0, 0.0], {"f": 0.8}, period=2.0 * np.pi, mirror=mirror if mirrored else None
    )
    graph = cv.diagram(flow.attractor([0.0, 0.0], f=0.8), over="f", within=(0.2, 12.0), depth=1)
    (point,) = graph.of_kind("symmetry-breaking" if mirrored else "branch-point")
    start = point.orbit(0.0)
    found = fsolve(missed, [*start, point.value], xtol=1e-12)[2]
    assert point.value == pytest.approx(found, abs=1e-8)
    assert graph.branches["B1"].stable_intervals()[-1][1] == pytest.approx(found)
