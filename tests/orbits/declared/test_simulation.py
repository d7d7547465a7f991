"""The stepper: chatter, missed stops, starts; and orbits against an independent integrator."""

import numpy as np
import pytest

from orbits import DryFriction, Machine, Wall
from orbits.flows.page.stepper import Stepper
from orbits.symbols import sin
from tools.pages.independent import deviation
from tools.pages.pages import page


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
    machine = Machine(
        name="idler",
        states=("x", "v"),
        parameters={"shaking": 0.5, "frequency": 1.0, "restitution": 0.7},
        phase_rate="frequency",
        motion=lambda state, phase, p, contact: (state.v, p.shaking * sin(phase) - 0.2 - 0.06 * state.v),
        contacts=[Wall("B", lambda state, phase, p: state.x + 0.5, {"v": 1.0}, "restitution")],
    )
    stepper = Stepper(machine, np.array([0.5, 1.0, 0.7]))
    generator = np.random.default_rng(0)
    for speed, phase in zip(10.0 ** generator.uniform(-5.2, -4.3, 400), generator.uniform(3.4, 5.2, 400)):
        stepper.start(np.array([-0.5, -2.0 * speed]), phase)
        assert stepper.advance(phase + 1.0) is not None
        begin, speed = stepper.base + stepper.clock, stepper.state[1]
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
    return Machine(
        name="rattler",
        states=("x", "v"),
        parameters={"forcing": 1.0, "frequency": 1.7, "friction": 0.3, "restitution": 0.7, "gap": 1.0},
        phase_rate="frequency",
        motion=lambda state, phase, p, contact: (state.v, p.forcing * sin(phase) + contact.floor),
        contacts=[
            Wall("R", lambda state, phase, p: p.gap - state.x, {"v": -1.0}, "restitution"),
            Wall("L", lambda state, phase, p: p.gap + state.x, {"v": 1.0}, "restitution"),
            DryFriction("floor", lambda state, phase, p: state.v, "friction"),
        ],
        mirror={"L": "R"},
    )


@pytest.mark.parametrize(("forcing", "frequency"), [(3.0, 0.7), (5.0, 1.1), (9.0, 2.3)])
def test_no_stop_is_missed(forcing, frequency):
    """Between two stops the mass stays there, through thousands of impacts, turns and sticks."""
    run = rattler().simulate({"x": 0.3, "v": 0.1}, events=2500, forcing=forcing, frequency=frequency)
    assert run.impacts > 500
    assert np.abs(run.states[:, 0]).max() < 1.0 + 1e-9
    inside = run.sample(np.linspace(run.clocks[0], run.clocks[-1], 8001))
    assert np.abs(inside[:, 0]).max() < 1.0 + 1e-9


def test_friction_takes_exactly_what_the_forcing_gives():
    """Energy over a simulated orbit: kinetic energy before and after, work of the forcing, loss in friction and impacts."""
    machine = rattler()
    orbit = machine.attractor(forcing=8.0, frequency=1.0, friction=0.5).orbit
    assert orbit is not None and orbit.real and orbit.replay() < 1e-10
    motion = orbit.sample(40_001)
    clock, v = motion["time"], motion["v"]
    power = 8.0 * np.sin(motion["phase"]) * v
    work = float(np.sum(0.5 * (power[1:] + power[:-1]) * np.diff(clock)))
    rubbed = 0.5 * float(np.sum(0.5 * (abs(v[1:]) + abs(v[:-1])) * np.diff(clock)))
    after = orbit.nodes[[i for i in range(len(orbit.word)) if orbit.word.letter(i).kind == 0], 2]
    lost = float(np.sum(0.5 * after**2 * (1 / 0.7**2 - 1)))
    assert work == pytest.approx(rubbed + lost, rel=1e-5)


CASES = {
    "impact_oscillator": {"frequency": 2.5},
    "elastic_stop": {"frequency": 0.8},
    "rubber_wall": {},
    "den_hartog": {"frequency": 0.25},
    "impact_duffing": {"frequency": 0.7},
    "absorber": {"amplitude": 0.86},
}


@pytest.mark.parametrize("name", CASES)
def test_orbits_against_an_independent_integrator(name):
    machine = page(name)
    orbit = machine.attractor(**CASES[name]).orbit
    assert orbit is not None and orbit.real and orbit.residual < 1e-10
    assert deviation(orbit, machine.equations.formulas_of_motion) < 1e-8
    assert orbit.replay() < 1e-9
