"""Derivatives of simulated motions of declared machines, against central differences of the simulation and a closed form."""

import numpy as np
import pytest

pytest.importorskip("heyoka")

from orbits import DryFriction, Machine, Switch, Wall
from orbits.flows import simulator_of
from orbits.simulation.runs import Section
from orbits.symbols import cos, sin, sqrt
from orbits.words import Word


def section(machine: Machine, parameter: str, **values: float) -> Section:
    """A section at phase zero, once per forcing period, that differentiates by a parameter."""
    word = Word((), (tuple(0 for _ in machine.contacts),), machine.alphabet)
    simulator, unit = simulator_of(machine, machine.vector(values)), np.ones(machine.size + 1)
    return Section(simulator, word, 1, unit, machine.parameter_names.index(parameter))


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
