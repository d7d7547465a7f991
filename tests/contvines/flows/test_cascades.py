"""Branches deep in a cascade of doublings end at cycles of half the period, however small the difference from these is in the branch's own measure."""

import numpy as np
import pytest

import contvines as cv
from tests.contvines.flows.shooting import doubled


def oscillator(x, p, t):
    """Duffing's and van der Pol's, forced."""
    return [x[1], 0.2 * (1.0 - x[0] ** 2) * x[1] - x[0] ** 3 + p.f * np.cos(t)]


@pytest.mark.slow
def test_a_branch_of_eight_periods_ends_at_the_doublings_of_that_of_four():
    flow = cv.FlowProblem(oscillator, [-1.0, 0.0], {"f": 7.1}, period=2.0 * np.pi)
    graph = cv.diagram(flow.attractor(), over="f", within=(6.9, 7.9), depth=0)
    points = sorted(graph.of_kind("period-doubling"), key=lambda point: point.value)
    assert len(points) == 4  # its own two lie between those at which it ends
    for point in points[::3]:
        expected = doubled(oscillator, point.orbit(0.0), 8.0 * np.pi, f=point.value)
        assert point.value == pytest.approx(expected, abs=1e-7)


def roessler(x, p):
    """Roessler's flow, a = b = 0.2."""
    return [-x[1] - x[2], x[0] + 0.2 * x[1], 0.2 + x[2] * (x[0] - p.c)]


@pytest.mark.slow
def test_a_cycle_of_eight_rounds_from_a_simulation_ends_at_the_doubling_of_that_of_four():
    flow = cv.FlowProblem(roessler, [1.0, 1.0, 0.0], {"c": 4.18})
    graph = cv.diagram(flow.attractor(), over="c", within=(2.0, 6.0), depth=0)
    assert not graph.of_kind("branch-point")
    end = min(graph.of_kind("period-doubling"), key=lambda point: point.value)
    expected = doubled(roessler, end.orbit(0.0), 0.5 * end.orbit.period, c=end.value)
    assert end.value == pytest.approx(expected, abs=1e-6)


def ueda(x, p, t):
    return [x[1], -(x[0] ** 3) - 0.1 * x[1] + p.f * np.cos(t)]


@pytest.mark.parametrize("mirrored", [True, False])
def test_a_forced_oscillator_loses_its_symmetry_where_shooting_has_it(mirrored):
    """-x at t + pi solves the equations as x does at t: the image half a period later has the multiplier -1, its square +1.

    Whether its symmetry is named or not, the symmetric motion goes on as an unstable one.
    """
    mirror = (lambda x: -x) if mirrored else None
    flow = cv.FlowProblem(ueda, [0.0, 0.0], {"f": 0.8}, period=2.0 * np.pi, mirror=mirror)
    graph = cv.diagram(flow.attractor(), over="f", within=(0.2, 12.0), depth=1)
    (point,) = graph.of_kind("symmetry-breaking" if mirrored else "branch-point")
    expected = doubled(ueda, point.orbit(0.0), np.pi, image=-1.0, f=point.value)
    assert point.value == pytest.approx(expected, abs=1e-8)
    assert graph.branches["B1"].stable_intervals()[-1][1] == pytest.approx(expected)
