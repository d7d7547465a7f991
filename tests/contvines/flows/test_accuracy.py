"""Periods and multipliers of cycles against simulation and closed forms: orders of convergence, and stated errors that hold."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import contvines as cv
from tests.contvines.flows.shooting import cycle, unit_circle, van_der_pol
from tools.flow_demos.listed import DEMOS

pytestmark = pytest.mark.slow


def brusselator(x, p):
    return [1.0 - (p.b + 1.0) * x[0] + x[0] ** 2 * x[1], p.b * x[0] - x[0] ** 2 * x[1]]


@pytest.fixture(scope="module")
def expected():
    period, matrix = cycle(brusselator, [1.0, 1.74178], 6.57728, b=2.5)
    return period, np.linalg.det(matrix)


@pytest.mark.parametrize(("degree", "error"), [(2, 1e-3), (4, 1e-5), (6, 1e-6)])
def test_periods_and_multipliers_are_as_exact_as_they_say(degree, error, expected):
    period, multiplier = expected
    orbit = cv.FlowProblem(brusselator, [1.0, 2.0], {"b": 2.5}, degree=degree, error=error).attractor()
    assert abs(orbit.period - period) < orbit.period_error + 1e-12
    assert orbit.period_error < 10.0 * abs(orbit.period - period) + 1e-10
    assert abs(orbit.multipliers[0] - multiplier) < orbit.multiplier_errors[0] + 1e-12


@pytest.mark.parametrize("degree", [3, 5])
@pytest.mark.parametrize(("name", "kind"), [("langford", "neimark-sacker"), ("hopf", "fold")])
def test_special_points_are_as_exact_as_they_say(degree, name, kind):
    """COCO's demos, with closed forms of both points."""
    demo = next(demo for demo in DEMOS if demo.name == name)
    flow = cv.FlowProblem(demo.rates, demo.u, demo.p, degree=degree, error=1e-4)
    graph = cv.diagram(flow.attractor() if demo.settles else flow, within=demo.within, depth=1 - demo.settles)
    (point,) = graph.of_kind(kind)
    assert abs(point.value - dict(demo.exact)[kind]) <= point.location_error


def test_a_canard_explosion_is_one_stable_branch():
    """Van der Pol with a constant force and epsilon = 0.01: Zvonkin and Shubin 1984 have the canard at
    a = 1 - e/8 - 3 e^2/32 - 173 e^3/1024 + O(e^4); Krupa and Szmolyan 2001 show that all its cycles are stable."""
    e = 0.01
    flow = cv.FlowProblem(
        lambda x, p: [(x[1] - x[0] ** 3 / 3 + x[0]) / e, p.a - x[0]], [1.2, 1.2**3 / 3 - 1.2], {"a": 1.2}
    )
    graph = cv.diagram(flow, over="a", within=(0.0, 1.2))
    assert graph["HB1"].criticality == "supercritical"
    branch = graph["B2"]
    assert branch.values[-1] == 0.0
    assert [p.kind for p in graph.special.values() if p.branch == "B2"] == ["end"]
    assert branch.stable[1:].all()
    high = branch.measure("max x0")
    canards = (high > 1.4) & (high < 1.95)
    expected = 1.0 - e / 8 - 3 * e**2 / 32 - 173 * e**3 / 1024
    assert canards.sum() > 10 and len(branch) < 400
    assert np.allclose(branch.values[canards], expected, atol=1e-8)
    # headless canards turn at the fold, those with a head on the other side of it
    assert branch.measure("min x0")[canards].max() > -0.5 > branch.measure("min x0").min()
    assert branch.orbit(len(branch) - 1).replay() < 1e-4


def test_a_planar_multiplier_is_that_of_liouville():
    """Van der Pol at mu = 30: log of the multiplier against the trace, integrated along a simulation with scipy's Radau."""
    mu = 30.0
    orbit = cv.FlowProblem(van_der_pol, [2.0, 0.0], {"mu": mu}).attractor()

    def rate(t, y):
        return [y[1], mu * (1 - y[0] ** 2) * y[1] - y[0], mu * (1 - y[0] ** 2)]

    start = [*orbit.states[0], 0.0]
    end = solve_ivp(rate, (0.0, orbit.period), start, method="Radau", rtol=1e-9, atol=1e-10).y[:, -1]
    assert np.log(orbit.multipliers[0].real) == pytest.approx(max(end[2], -707.0), rel=1e-4)
    assert orbit.volume_error < 1e-9 or end[2] < -707.0


def saddle(x, p):
    """r' = r (1 - r^2), turning once in 2 pi, and y = R(t) z with z' = diag(a, -b) z: multipliers 1, exp(-4 pi), exp(2 pi a), exp(-2 pi b)."""
    (c, s), (y, z) = x[:2], x[2:]
    inward, mean, half = 1.0 - c * c - s * s, 0.5 * (p.a - p.b), 0.5 * (p.a + p.b)
    double, twice = c * c - s * s, 2.0 * c * s
    return [
        inward * c - s,
        inward * s + c,
        mean * y + half * (double * y + twice * z) - z,
        mean * z + half * (twice * y - double * z) + y,
    ]


@pytest.mark.parametrize(("a", "b"), [(3.9, 1.0), (11.0, 11.0)])
def test_simulated_multipliers_beside_strong_saddles(a, b):
    """A growth of 4e10 (a = 3.9), and one of 1e30 beside 1e-30, of which a product of matrices has nothing left."""
    orbit = cv.FlowProblem(saddle, [1.0, 0.0, 0.0, 0.0], {"a": a, "b": b}).cycle(*unit_circle(4))
    expected = np.exp(2.0 * np.pi * np.array([a, 0.0, -min(2.0, b), -max(2.0, b)]))
    assert orbit.simulated_multipliers() == pytest.approx(expected, rel=1e-7, abs=0.0)
