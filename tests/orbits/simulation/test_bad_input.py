"""Refusals: one sentence that names field and value."""

import pytest

from orbits.attractors import find_attractor, find_attractors, sweep
from orbits.machines.absorber.machine import Absorber
from orbits.simulation import SimulationError, simulate

MACHINE = Absorber(restitution=0.76, friction=0.5, gravity=0.211)


@pytest.mark.parametrize(
    ("start", "options", "words"),
    [
        ({"w": 1.2}, {"periods": 1}, "w = 1.2 lies outside"),
        ({"w_rate": float("nan")}, {"periods": 1}, "not finite"),
        ({"speed": 1.0}, {"periods": 1}, "'speed'"),
        ({"q1": 0.1}, {"periods": 1}, "'q1'"),
        ({}, {}, "how long"),
        ({}, {"periods": -1}, "periods = -1"),
        ({}, {"events": -3}, "events = -3"),
    ],
)
def test_simulate_refuses(start, options, words):
    with pytest.raises(SimulationError, match=words):
        simulate(MACHINE, start, amplitude=0.5, **options)


def test_the_others_refuse():
    with pytest.raises(SimulationError, match="max_period = 0"):
        find_attractor(MACHINE, max_period=0, amplitude=0.5)
    with pytest.raises(SimulationError, match="workers = 0"):
        find_attractors(MACHINE, [None], workers=0, amplitude=0.5)
    with pytest.raises(SimulationError, match="'forcing' is no parameter"):
        sweep(MACHINE, "forcing", [1.0])
    with pytest.raises(SimulationError, match="at least one"):
        sweep(MACHINE, "amplitude", [])
    with pytest.raises(ValueError, match="amplitude is missing"):
        simulate(MACHINE, periods=1)
    with pytest.raises(ValueError, match="leave the run"):
        simulate(MACHINE, periods=1, amplitude=0.5).sample([100.0])
