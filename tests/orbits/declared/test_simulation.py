"""The stepper: chatter, missed stops, starts; and orbits against an independent integrator."""

import numpy as np
import pytest

from orbits.flows.page.stepper import Stepper
from orbits.simulation import replay
from orbits.symbols import sin
from tests.orbits.declared.oscillators import FLOOR, LEFT, RIGHT, oscillator
from tools.pages.independent import deviation
from tools.pages.pages import PAGES, page


def test_a_dropped_ball_comes_to_rest_when_its_chatter_ends():
    """On a table at rest impacts end at t0 + 2 v0 e/(g (1 - e)), with t0 = sqrt(2 h/g), v0 = g t0; the ball then lies on the table."""
    machine = page("bouncing_ball")
    g, e, h = 0.1, 0.8, 1.0
    t0 = np.sqrt(2 * h / g)
    run = machine.simulate({"y": h}, time=100.0, amplitude=0.0)
    assert run.chatters == 1 and run.letters[-1] == "(B"
    assert run.clocks[-1] == pytest.approx(t0 + 2 * t0 * e / (1 - e), abs=1e-4)
    assert np.abs(run.states[-1]).max() < 1e-9
    assert run.ended == "the requested time was reached; impacts piled up and a wall held the body once"


def test_no_short_hop_is_lost():
    """One lasts 2 v/a, as long as the acceleration a hardly changes; where its end was lost the body passed the wall."""
    machine = oscillator(
        lambda s, phase, p, contact: 0.2 + 0.06 * -s.v - p.shaking * sin(phase),
        RIGHT,
        parameters={"shaking": 0.5, "frequency": 1.0, "restitution": 0.7, "gap": 0.5},
    )
    stepper = Stepper(machine, machine.vector())
    generator = np.random.default_rng(0)
    for speed, phase in zip(10.0 ** generator.uniform(-5.2, -4.3, 400), generator.uniform(3.4, 5.2, 400)):
        stepper.start(np.array([0.5, 2.0 * speed]), phase)
        assert stepper.advance(phase + 1.0) is not None
        begin, speed = stepper.base + stepper.clock, -stepper.state[1]
        assert stepper.advance(phase + 1.0) is not None
        lasts = 2.0 * speed / (0.2 - 0.5 * np.sin(begin))
        assert stepper.base + stepper.clock - begin == pytest.approx(lasts, rel=2e-3)


def test_a_resting_ball_is_thrown_off_when_the_table_falls_away_faster():
    """It is released where A W^2 cos(phase) = g, and lands later on the table."""
    machine = page("bouncing_ball")
    run = machine.simulate({"y": 0.15}, periods=60, amplitude=0.12)
    releases = [i for i, letter in enumerate(run.letters) if letter == "B)"]
    assert releases and run.chatters >= len(releases)
    for i in releases:
        assert np.cos(run.clocks[i + 1]) * 0.12 == pytest.approx(0.1, abs=1e-9)


def rattler():
    return oscillator(
        lambda s, phase, p, contact: p.forcing * sin(phase) + contact.floor,
        RIGHT,
        LEFT,
        FLOOR,
        parameters={"forcing": 1.0, "frequency": 1.7, "friction": 0.3, "restitution": 0.7, "gap": 1.0},
        mirror={"L": "R"},
    )


@pytest.mark.parametrize(("forcing", "frequency"), [(3.0, 0.7), (5.0, 1.1), (9.0, 2.3)])
def test_no_stop_is_missed(forcing, frequency):
    """Between two stops the mass stays there, through thousands of impacts, turns and sticks."""
    run = rattler().simulate({"x": 0.3, "v": 0.1}, events=2500, forcing=forcing, frequency=frequency)
    assert run.impacts > 500
    inside = run.sample(np.linspace(run.clocks[0], run.clocks[-1], 8001))
    assert max(np.abs(run.states[:, 0]).max(), np.abs(inside[:, 0]).max()) < 1.0 + 1e-9


CASES = {
    "bouncing_ball": ({"y": 0.1, "v": 0.33, "phase": -0.8}, {"amplitude": 0.05}),
    "belt_slider": ({"x": 1.0, "v": 0.5}, {}),
    "two_absorbers": ({"s1": 0.3, "s2": 0.3}, {"forcing": 0.03, "frequency": 1.01}),
    "impact_oscillator": (None, {"frequency": 2.5}),
    "elastic_stop": (None, {"frequency": 0.8}),
    "den_hartog": (None, {"frequency": 0.25}),
    "impact_duffing": (None, {"frequency": 0.7}),
    "absorber": (None, {"amplitude": 0.86}),
}


@pytest.mark.parametrize("name", sorted(path.stem for path in PAGES.glob("*.py") if path.stem != "draw"))
def test_motions_of_all_pages_against_an_independent_integrator(name):
    machine, (start, values) = page(name), CASES.get(name, (None, {}))
    found = machine.attractor(start, **values)
    orbit = found.orbit
    assert found.kind == "periodic" and orbit.real and orbit.stable and orbit.residual < 1e-10
    assert deviation(orbit, machine.equations.formulas_of_motion) < 1e-8
    assert orbit.replay() < 1e-9 and (not machine.forced or replay(orbit).error < 1e-8)
    path = orbit.sample(40000)
    for state in machine.states:
        if f"max_{state}" in orbit.measures():
            assert orbit.measure(f"max_{state}") == pytest.approx(path[state].max(), abs=1e-5)
            assert orbit.measure(f"min_{state}") == pytest.approx(path[state].min(), abs=1e-5)
    if machine.forced:
        strobe = 2.0 * np.pi * np.ceil(path["phase"][0] / (2.0 * np.pi))
        there = path[machine.states[0]][np.argmin(np.abs(path["phase"] - strobe))]
        near = 1e-3 * np.ptp(path[machine.states[0]]) + 1e-9
        assert orbit.measure(f"strobe_{machine.states[0]}") == pytest.approx(there, abs=near)
