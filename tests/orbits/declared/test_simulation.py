"""The stepper: chatter, missed stops, starts; and orbits against an independent integrator."""

import numpy as np
import pytest

from orbits import Switch
from orbits.flows.page.stepper import Stepper
from orbits.simulation import replay
from orbits.symbols import cos, sin
from tests.orbits.declared.oscillators import FLOOR, LEFT, RIGHT, oscillator
from tools.pages.independent import deviation
from tools.pages.pages import PAGES, page


def test_a_dropped_ball_comes_to_rest_when_its_chatter_ends():
    """On a table at rest impacts end at t0 (1 + e)/(1 - e), with t0 = sqrt(2/g); the ball then lies on the table."""
    machine = page("bouncing_ball")
    g, e = 0.1, 0.8
    t0 = np.sqrt(2 / g)
    run = machine.simulate({"y": 1.0}, time=100.0, amplitude=0.0)
    assert run.letters[-1] == "(B"
    assert run.clocks[-1] == pytest.approx(t0 * (1 + e) / (1 - e), abs=1e-4)
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
        assert stepper.advance(phase + 1.0)
        begin, speed = stepper.clock, -stepper.state[1]
        assert stepper.advance(phase + 1.0)
        lasts = 2.0 * speed / (0.2 - 0.5 * np.sin(begin))
        assert stepper.clock - begin == pytest.approx(lasts, rel=2e-3)


def test_a_resting_ball_is_thrown_off_when_the_table_falls_away_faster():
    """It is released where A W^2 cos(phase) = g, and lands later on the table."""
    machine = page("bouncing_ball")
    run = machine.simulate({"y": 0.15}, periods=60, amplitude=0.12)
    releases = [i for i, letter in enumerate(run.letters) if letter == "B)"]
    assert releases and run.chatters >= len(releases)
    for i in releases:
        assert np.cos(run.clocks[i + 1]) * 0.12 == pytest.approx(0.1, abs=1e-9)


def test_a_body_leaves_its_wall_when_the_force_turns_round_at_once():
    """New parameters turn it at 1.5 and a switch at 3 pi/2; the body then moves by t^2/2."""
    machine = oscillator(
        lambda s, phase, p, contact: p.force * contact.pushing,
        RIGHT,
        Switch("pushing", lambda s, phase, p: cos(phase)),
        parameters={"force": 1.0, "frequency": 1.0, "restitution": 0.5, "gap": 0.1},
    )
    stepper = Stepper(machine, machine.vector())
    stepper.start(np.zeros(2), 0.0)
    for until, force, time in ((1.5, 1.0, 0.0), (1.55, -1.0, 0.05), (1.5 * np.pi + 0.1, -1.0, 0.1)):
        stepper.renew(machine.vector({"force": force}))
        while stepper.advance(until):
            pass
        assert stepper.state[0] == pytest.approx(0.1 - time**2 / 2, abs=1e-9)


@pytest.mark.parametrize(("forcing", "frequency"), [(3.0, 0.7), (5.0, 1.1), (9.0, 2.3)])
def test_no_stop_is_missed(forcing, frequency):
    """Between two stops the mass stays there, through thousands of impacts, turns and sticks."""
    rattler = oscillator(
        lambda s, phase, p, contact: forcing * sin(phase) + contact.floor, RIGHT, LEFT, FLOOR,
        parameters={"frequency": frequency, "friction": 0.3, "restitution": 0.7, "gap": 1.0},
    )  # fmt: skip
    run = rattler.simulate({"x": 0.3, "v": 0.1}, events=2500)
    assert run.impacts > 500
    inside = run.sample(np.linspace(0.0, run.clocks[-1], 8001))
    assert max(np.abs(run.states[:, 0]).max(), np.abs(inside[:, 0]).max()) < 1.0 + 1e-9


CASES = {
    "bouncing_ball": {"start": {"y": 0.1, "v": 0.33, "phase": -0.8}, "amplitude": 0.05},
    "belt_slider": {"start": {"x": 1.0, "v": 0.5}},
    "two_absorbers": {"start": {"s1": 0.3, "s2": 0.3}, "forcing": 0.03, "frequency": 1.01},
    "impact_oscillator": {"frequency": 2.5},
    "elastic_stop": {"frequency": 0.8},
    "den_hartog": {"frequency": 0.25},
    "impact_duffing": {"frequency": 0.7},
    "absorber": {"amplitude": 0.86},
}


@pytest.mark.parametrize("name", sorted(path.stem for path in PAGES.glob("*.py") if path.stem != "draw"))
def test_motions_of_all_pages_against_an_independent_integrator(name):
    machine = page(name)
    found = machine.attractor(**CASES.get(name, {}))
    orbit = found.orbit
    assert found.kind == "periodic" and orbit.real and orbit.stable and orbit.residual < 1e-10
    assert deviation(orbit, machine.equations.formulas_of_motion) < 1e-8
    assert orbit.replay() < 1e-9 and (not machine.forced or replay(orbit).error < 1e-8)
    path = orbit.sample(40000)
    for measure, value in orbit.measures().items():
        kind, _, state = measure.partition("_")
        if kind in ("max", "min") and state in machine.states:
            assert value == pytest.approx(getattr(path[state], kind)(), abs=1e-5)
        if kind == "strobe":
            strobe = 2.0 * np.pi * np.ceil(path["phase"][0] / (2.0 * np.pi))
            assert value == pytest.approx(np.interp(strobe, path["phase"], path[state]), abs=1e-5)
