"""Derivatives of simulated motions of declared machines, against central differences of the simulation and a closed form."""

import numpy as np
import pytest

pytest.importorskip("heyoka")

from orbits import DryFriction, Machine, Switch, Wall
from orbits.simulation.page_section import VariedSection, section_of
from orbits.symbols import cos, sin, sqrt
from orbits.words import Word


def section(machine: Machine, parameter: str, **values: float) -> VariedSection:
    """A section at phase zero, once per forcing period, that differentiates by a parameter."""
    word = Word((), (tuple(0 for _ in machine.contacts),), machine.alphabet)
    return section_of(machine, machine.vector(values), word, 1, machine.parameter_names.index(parameter))


def rubbing_rotor() -> Machine:
    """A shaft that rubs a ring: four states, one switch."""

    def motion(s, phase, p, contact):
        push = p.ring * (1 - 1 / sqrt(s.x**2 + s.y**2)) * (1 + contact.rub) / 2
        shake = p.unbalance * p.speed**2
        return (
            s.vx,
            shake * cos(phase) - 0.2 * s.vx - s.x - push * (s.x - 0.1 * s.y),
            s.vy,
            shake * sin(phase) - 0.2 * s.vy - s.y - push * (s.y + 0.1 * s.x) - 0.4,
        )

    return Machine(
        name="rotor",
        states=("x", "vx", "y", "vy"),
        parameters={"speed": 1.2, "ring": 30.0, "unbalance": 0.3},
        phase_rate="speed",
        motion=motion,
        contacts=[Switch("rub", lambda s, phase, p: sqrt(s.x**2 + s.y**2) - 1)],
    )


def rubbing_hammer() -> Machine:
    """A mass with dry friction between two walls, one of which moves."""
    return Machine(
        name="hammer",
        states=("x", "v"),
        parameters={"forcing": 3.0, "frequency": 1.1, "friction": 0.3, "restitution": 0.7},
        phase_rate="frequency",
        motion=lambda s, phase, p, c: (s.v, p.forcing * sin(phase) - 0.3 * s.x + c.rubs),
        contacts=[
            Wall("L", lambda s, phase, p: 1 + s.x, {"v": 1.0}, "restitution"),
            Wall("R", lambda s, phase, p: 1 + 0.2 * sin(phase) - s.x, {"v": -1.0}, "restitution"),
            DryFriction("rubs", lambda s, phase, p: s.v, "friction"),
        ],
    )


CASES = [
    (rubbing_rotor, "speed", {"x": 0.3, "vx": 0.5, "y": -1.05, "vy": 0.1}),
    (rubbing_rotor, "ring", {"x": 0.3, "vx": 0.5, "y": -1.05, "vy": 0.1}),
    (rubbing_hammer, "frequency", {"x": 0.2, "v": 0.8}),
    (rubbing_hammer, "friction", {"x": 0.2, "v": 0.8}),
    (rubbing_hammer, "restitution", {"x": -0.4, "v": -2.0}),
]


@pytest.mark.parametrize("page, parameter, start", CASES)
def test_derivatives_are_those_of_the_simulation(page, parameter, start):
    machine = page()
    x, value = np.array(list(start.values())), dict(machine.parameters)[parameter]
    image, by_state, by_value = section(machine, parameter).varied(x)
    assert image == pytest.approx(section(machine, parameter).step(x), abs=1e-13)
    h = 1e-5

    def difference(ahead, behind):
        return (ahead - behind) / (2 * h)

    for j, unit in enumerate(np.eye(machine.size)):
        here = section(machine, parameter)
        slope = difference(here.step(x + h * unit), here.step(x - h * unit))
        assert by_state[:, j] == pytest.approx(slope, rel=1e-6, abs=1e-6)
    ahead, behind = (section(machine, parameter, **{parameter: value + s * h}).step(x) for s in (1, -1))
    assert by_value == pytest.approx(difference(ahead, behind), rel=1e-6, abs=1e-6)


def test_an_impact_on_a_moving_wall_in_closed_form():
    # x = x0 + v t under no force meets the wall at 1 + a sin t; v after it is -e (v - c) + c with c = a cos t
    machine = Machine(
        name="tennis",
        states=("x", "v"),
        parameters={"rate": 1.0, "a": 0.1, "e": 0.8},
        phase_rate="rate",
        motion=lambda s, phase, p, contact: (s.v, 0 * s.x),
        contacts=[Wall("R", lambda s, phase, p: 1 + p.a * sin(phase) - s.x, {"v": -1.0}, "e")],
    )
    from scipy.optimize import brentq

    def flown(x0, v0, a):
        t = brentq(lambda t: x0 + v0 * t - 1 - a * np.sin(t), 0, 3, xtol=1e-15)
        c = a * np.cos(t)
        after = -0.8 * (v0 - c) + c
        return t, c, np.array([x0 + v0 * t + after * (2 * np.pi - t), after])

    t, c, image = flown(0.2, 0.9, 0.1)
    found, by_state, by_value = section(machine, "a").varied(np.array([0.2, 0.9]))
    assert found == pytest.approx(image, abs=1e-12)
    rate = 0.9 - c  # of x - wall at the impact
    times = np.array([-1 / rate, -t / rate, np.sin(t) / rate])  # dt by x0, v0, a
    turning = (
        1.8 * np.array([0.0, 0.0, np.cos(t)]) - 1.8 * 0.1 * np.sin(t) * times - 0.8 * np.array([0, 1, 0])
    )
    place = np.array([1.0, t, 0.0]) + 0.9 * times - image[1] * times + turning * (2 * np.pi - t)
    expected = np.array([place, turning])
    assert by_state == pytest.approx(expected[:, :2], abs=1e-11)
    assert by_value == pytest.approx(expected[:, 2], abs=1e-11)


def test_a_wall_that_holds_has_no_derivatives():
    machine = Machine(
        name="resting",
        states=("x", "v"),
        parameters={"rate": 1.0, "shake": 0.2, "e": 0.3},
        phase_rate="rate",
        motion=lambda s, phase, p, contact: (s.v, -1 + p.shake * sin(phase)),
        contacts=[Wall("B", lambda s, phase, p: s.x, {"v": 1.0}, "e")],
    )
    image, by_state, by_value = section(machine, "shake").varied(np.array([0.05, 0.0]))
    assert np.isfinite(image).all() and np.isnan(by_state).all() and np.isnan(by_value).all()
