"""Motions without events of self-excited machines.

A mass on a belt whose friction falls with the sliding speed w, mu_d (1 + (mu_s/mu_d - 1) exp(-w/v_0)), at stiffness 1 (Papangelo, Ciavarella
and Hoffmann, Nonlinear Dynamics 90 (2017) 1667): its equilibrium loses stability where the slope of the friction is the damping, at
v = (ln 10)/2 with the numbers below; the stick-slip cycle ends where its stick vanishes, at v = 1.83660097 by shooting with DOP853 for the smooth
cycle that touches the belt's velocity.
"""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import root

import contvines as cv
from orbits import DryFriction, Machine
from orbits.symbols import exp


def belt():
    return Machine(
        name="belt",
        states=("x", "v"),
        parameters={"speed": 1.3, "damping": 0.05, "dynamic": 0.5, "ratio": 2.0, "decay": 0.5},
        motion=lambda s, phase, p, contact: (s.v, -s.x - 2 * p.damping * s.v + contact.belt),
        contacts=[
            DryFriction(
                "belt",
                lambda s, phase, p: s.v - p.speed,
                lambda s, phase, p: p.dynamic * (1 + (p.ratio - 1) * exp((s.v - p.speed) / p.decay)),
            )
        ],
    )


HOPF = np.log(10.0) / 2.0


def touching():
    """Belt speed at which a smooth cycle touches the velocity of the belt, by shooting: (period, x, speed) with v = speed, v' = 0 at t = 0 and T."""

    def rate(t, y, speed):
        return [y[1], -y[0] - 0.1 * y[1] + 0.5 * (1.0 + np.exp((y[1] - speed) / 0.5))]

    def gap(unknown):
        period, x, speed = unknown
        end = solve_ivp(
            rate, (0.0, period), [x, speed], args=(speed,), method="DOP853", rtol=1e-12, atol=1e-13
        )
        return [end.y[0, -1] - x, end.y[1, -1] - speed, rate(0.0, [x, speed], speed)[1]]

    return root(gap, [6.3, 0.8, 1.8], tol=1e-13).x[2]


@pytest.mark.parametrize("first", ["stick-slip", "rest"])
def test_a_friction_oscillator_from_stick_slip_to_the_hopf_point_and_back(first, tmp_path):
    machine, speed = belt(), touching()
    seed = (
        machine.attractor({"x": 2.5}).orbit
        if first == "stick-slip"
        else machine.smooth({"x": 0.5}, speed=2.0)
    )
    graph = cv.diagram(seed, over="speed", within=(0.9, 2.2))
    words = sorted(branch.description["word"] for branch in graph.branches.values())
    assert words == ["[-]", "equilibrium", "s-"]
    (hopf,) = graph.of_kind("hopf")
    assert hopf.value == pytest.approx(HOPF, abs=1e-11) and hopf.criticality == "subcritical"
    (border,) = (p for p in graph.special.values() if p.kind in ("stick", "velocity-graze"))
    assert border.value == pytest.approx(speed, abs=3e-9)
    assert speed == pytest.approx(1.83660097, abs=1e-8)  # the published figure
    smooth = next(b for b in graph.branches.values() if b.description["word"] == "[-]")
    assert not smooth.stable.any()
    assert smooth.orbit(len(smooth) // 2).replay() < 1e-9
    graph.save(tmp_path / "belt.vines")
    again = cv.load(tmp_path / "belt.vines")
    assert str(again) == str(graph)


def test_a_machine_without_contacts_that_excites_itself():
    machine = Machine(
        name="van_der_pol",
        states=("x", "v"),
        parameters={"mu": 1.0},
        motion=lambda s, phase, p, contact: (s.v, p.mu * (1 - s.x**2) * s.v - s.x),
    )
    found = machine.attractor({"x": 0.5})
    assert found.kind == "periodic" and found.text == ""
    # period of van der Pol's cycle at mu = 1, to its digits (Andersen and Geer, SIAM J. Appl. Math. 42 (1982) 678)
    assert found.orbit.period == pytest.approx(6.66328686, abs=1e-8)
    assert found.orbit.real and found.orbit.replay() < 1e-10
    graph = cv.diagram(found.orbit, over="mu", within=(0.5, 2.0))
    (branch,) = graph.branches.values()
    assert branch.measure("period")[0] == pytest.approx(branch.orbit(0).period)
