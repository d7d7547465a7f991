"""Points of users' kinds on a locus."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import fsolve

import contvines as cv
from orbits import Absorber


def predators(u, p):
    """Bazykin's predator and prey; Kuznetsov's example 8.3."""
    x, y = u
    eaten = x * y / (1.0 + p.alpha * x)
    return [x - eaten - x**2 / 100.0, -y + eaten - p.delta * y**2]


def by_hand(v):
    """Equilibrium, zero determinant and zero trace, differentiated by hand."""
    x, y, a, d = v
    eaten, by_x, by_y = x * y / (1 + a * x), y / (1 + a * x) ** 2, x / (1 + a * x)
    j = np.array([[1 - by_x - x / 50, -by_y], [by_x, -1 + by_y - 2 * d * y]])
    return [x - eaten - x**2 / 100, -y + eaten - d * y**2, np.linalg.det(j), np.trace(j)]


def test_a_zero_trace_on_a_locus_of_folds_is_a_bogdanov_takens_point():
    problem = cv.AlgebraicProblem(predators, [20.0, 5.5], {"alpha": 0.4, "delta": 0.15}, spectrum="flow")
    graph = cv.diagram(problem, over="alpha", within=(0.3, 0.6))
    trace = cv.Kind("zero-trace", "ZT", test=lambda point: np.trace(point.jacobian))
    never = cv.Kind("never", "NEV", test=trace.test, verify=lambda point: point.parameters["delta"] < 0.1)
    found = cv.locus(graph["LP2"], over="delta", within=(0.01, 0.4), kinds=[*cv.KINDS, trace, never])
    alpha, delta = fsolve(by_hand, [10.0, 5.0, 0.45, 0.17], xtol=1e-13)[2:]
    assert found.points["ZT1"].value == pytest.approx((alpha, delta), rel=1e-10)
    assert found.points["BT1"].value == pytest.approx((alpha, delta), rel=1e-10)
    assert {"ZT1", "BT1"} == set(found.points)


def test_a_limit_of_the_impact_speed_is_followed_as_the_closed_form_has_it():
    fast = cv.Kind(
        "fast", "FA", test=lambda point: point.measure("impact_speed") - 1.0, locus=lambda point: point.measure("impact_speed") - 1.0
    )  # fmt: skip
    machine = Absorber(restitution=0.76, friction=0.3, gravity=0.2, mass_ratio=0.006)
    seed = machine.symmetric_orbit(amplitude=0.6)
    graph = cv.diagram(seed, over="amplitude", within=(0.4, 0.6), depth=0, kinds=[*cv.KINDS, fast])
    found = cv.locus(graph["FA1"], over="friction", within=(0.1, 0.5))
    assert found.values[[0, -1], 1] == pytest.approx([0.1, 0.5])
    speeds = [
        machine.changed(friction=q).symmetric_orbit(amplitude=p).measure("impact_speed")
        for p, q in found.values
    ]
    assert speeds == pytest.approx(np.ones(len(speeds)), abs=1e-9)


def test_cycles_of_a_given_period_are_followed_on_their_mesh():
    def rates(x, p):
        return [x[1], p.mu * (1 - x[0] ** 2) * x[1] - p.stiffness * x[0]]

    slow = cv.Kind(
        "slow",
        "SLW",
        test=lambda point: point.measure("period") - 8.0,
        locus=lambda point: point.measure("period") - 8.0,
    )
    flow = cv.FlowProblem(rates, [0.0, 0.0], {"mu": 1.0, "stiffness": 1.0})
    graph = cv.diagram(flow.attractor([1.0, 0.0]), over="mu", within=(1.0, 4.0), kinds=[*cv.KINDS, slow])
    found = cv.locus(graph["SLW1"], over="stiffness", within=(0.8, 1.3))
    for mu, stiffness in found.values[[0, len(found) // 2, -1]]:
        assert period(rates, SimpleNamespace(mu=mu, stiffness=stiffness)) == pytest.approx(8.0, abs=1e-6)


def period(rates, parameters):
    """Of the cycle to which an integration settles."""

    def up(t, x):
        return x[0]

    up.direction = 1.0
    run = solve_ivp(
        lambda t, x: rates(x, parameters),
        (0.0, 100.0),
        [1.0, 0.0],
        "DOP853",
        events=up,
        rtol=1e-11,
        atol=1e-12,
    )
    return np.diff(run.t_events[0])[-1]
