"""Forced motions without events: Duffing's oscillator, its wall out of reach, against another integrator and closed forms."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import contvines as cv
from orbits.symbols import cos
from tests.orbits.declared.oscillators import RIGHT, oscillator

pytestmark = pytest.mark.slow

DAMPING, FREQUENCY = 0.15, 1.2
PERIOD = 2.0 * np.pi / FREQUENCY


MACHINE = oscillator(
    lambda s, phase, p, contact: p.forcing * cos(phase) - 2 * DAMPING * s.v + s.x - s.x**3,
    RIGHT,
    parameters={"forcing": 0.2, "frequency": FREQUENCY, "gap": 10.0, "restitution": 0.8},
)


def period_of(forcing, start=(0.0, 0.0)):
    """Forcing periods after which the motion from a start returns, and its state then, by Runge-Kutta."""

    def rates(t, y):
        force = forcing * np.cos(FREQUENCY * t) - 2 * DAMPING * y[1]
        return y[1], force + y[0] - y[0] ** 3

    clock = PERIOD * np.arange(500, 517)
    y = solve_ivp(rates, (0.0, clock[-1]), start, "DOP853", clock, rtol=1e-11, atol=1e-12).y
    apart = np.abs(y[:, 1:] - y[:, :1]).max(axis=0)
    return 1 + int(np.argmax(apart < 1e-6)), y[:, 0]


@pytest.mark.parametrize("forcing", [0.2, 0.28, 0.35])
def test_it_settles_on_the_cycle_that_another_integrator_settles_on(forcing):
    """Beside it there is an unstable one of a single forcing period; volumes shrink by exp(-2 d T) in each."""
    periods, state = period_of(forcing)
    attractor = MACHINE.attractor(forcing=forcing)
    orbit = attractor.orbit
    assert attractor.kind == "periodic" and attractor.word.text == "" and orbit.periods == periods
    assert orbit.stable and orbit.replay() < 1e-9
    assert np.prod(orbit.multipliers) == pytest.approx(np.exp(-2.0 * DAMPING * PERIOD * periods), rel=1e-8)
    visited = MACHINE.simulate(
        {"x": orbit.nodes[0, 1], "v": orbit.nodes[0, 2]}, periods=periods + 0.1, forcing=forcing
    ).sample(2.0 * np.pi * np.arange(periods))
    assert np.abs(visited - state).max(axis=1).min() < 1e-6


def test_what_does_not_return_is_no_rest():
    assert (
        MACHINE.attractor(forcing=0.3).kind == "aperiodic"
    )  # by other programs as well: a positive exponent


def test_the_doubled_motion_is_followed():
    """Beyond the doubling the motion that another integrator settles on is that of the branch which leaves there."""
    graph = cv.diagram(MACHINE.attractor(), over="forcing", within=(0.19, 0.283), depth=1)
    at, near = graph["PD1"].value, graph["PD1"].u[1:3]
    assert [s.target for s in graph.switches if s.point == "PD1"] == ["B2"]
    assert at > 0.2 and period_of(at - 0.004, near)[0] == 1
    branch = graph["B2"]
    k = int(np.argmin(np.abs(branch.values - 0.28)))
    periods, state = period_of(branch.values[k], near)
    orbit = branch.orbit(k)
    assert periods == orbit.periods == 2 and orbit.stable and orbit.replay() < 1e-9
    assert np.abs(branch.points[k].reshape(2, 3)[:, 1:] - state).max(axis=1).min() < 1e-6
