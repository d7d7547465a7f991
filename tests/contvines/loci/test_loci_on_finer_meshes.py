"""Loci whose cycles ask for more intervals on the way go on on the finer mesh."""

from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import contvines as cv
from contvines.branches.special_point import SpecialPoint
from contvines.loci.adaptive import AdaptiveLocus

pytestmark = pytest.mark.slow


def lorenz(x, p):
    return [p.s * (x[1] - x[0]), p.r * x[0] - x[1] - x[0] * x[2], x[0] * x[1] - 8 / 3 * x[2]]


def multipliers(r, s, orbit):
    """By DOP853, of variations that go once round."""

    def rates(t, y):
        x, variations = y[:3], y[3:].reshape(3, 3)
        slopes = np.array([[-s, s, 0.0], [r - x[2], -1.0, -x[0]], [x[1], x[0], -8 / 3]])
        return np.append(lorenz(x, SimpleNamespace(r=r, s=s)), slopes @ variations)

    begin = np.append(orbit.states[0], np.eye(3))
    found = solve_ivp(rates, (0.0, orbit.period), begin, method="DOP853", rtol=1e-12, atol=1e-12)
    return np.linalg.eigvals(found.y[3:, -1].reshape(3, 3))


def test_period_doublings_go_on_where_the_mesh_becomes_too_coarse():
    """Nothing is followed twice, and at both ends a variation comes back as its opposite."""
    flow = cv.FlowProblem(
        lorenz, [1.0, 1.0, 1.0], {"r": 250.0, "s": 10.0}, mirror=lambda x: [-x[0], -x[1], x[2]]
    )
    graph = cv.diagram(flow.attractor([1.0, 1.0, 1.0], r=250.0), over="r", within=(225.0, 260.0), depth=0)
    (doubling,) = graph.of_kind("period-doubling")
    assert isinstance(doubling, SpecialPoint)
    numbers: list[int] = []
    locus = cv.locus(
        doubling, over="s", within=(5.0, 30.0), progress=lambda label, points, value: numbers.append(points)
    )
    assert sum(after < before for before, after in pairwise(numbers)) <= 1  # one side, then the other
    assert isinstance(locus.problem, AdaptiveLocus)
    assert locus.problem.mesh.intervals > len(doubling.u) // 13  # unknowns for each interval at the start
    assert [locus.values[0, 1], locus.values[-1, 1]] == [5.0, 30.0]
    for end in (0, -1):
        r, s = locus.values[end]
        found = multipliers(r, s, locus.orbit(end))
        assert np.abs(found + 1.0).min() < 1e-5
