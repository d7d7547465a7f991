"""The simulation of an inclined cavity with unlike walls and frictions, against a plain integration with event detection."""

import math
from dataclasses import replace

import pytest

from orbits import Cavity
from orbits.machines.reference.machine import reference
from orbits.simulation import simulate
from tests.orbits.simulation.plain_integration import events_of

STARTS = [(0.5, (0.4, 0.3, 0.9)), (0.8, (2.0, -0.2, -1.0)), (1.5, (4.0, 0.1, 1.5)), (0.35, (1.0, 0.0, 0.8))]


def test_events_are_those_of_a_plain_integration():
    machine = Cavity(
        restitution_left=0.9, restitution_right=0.5, friction_left=0.1, friction_right=0.9, gravity=0.5,
        mass_ratio=0.2, frequency=1.3, slope=0.15, distance_left=1.2, distance_right=0.7,
    )  # fmt: skip
    weight = 1.2 * 0.5
    pull, normal = weight * math.sin(0.15), weight * math.cos(0.15)
    sides = {1: 0.1 * normal, -1: 0.9 * normal}, {1: 1.2, -1: -0.7}, {1: 0.9, -1: 0.5}
    seen = set()
    for amplitude, start in STARTS:
        told = events_of(amplitude, 1.3, pull, *sides, start, 9)
        run = simulate(machine, dict(zip(("phase", "w", "w_rate"), start)), events=9, amplitude=amplitude)
        assert run.letters == "".join(event[0] for event in told)
        assert run.phases == pytest.approx([event[1] for event in told], abs=1e-9)
        for stepper in (run.machine, reference("cavity")):
            assert abs(replace(run, machine=stepper).balance().error) < 1e-11
        seen |= set(run.letters)
    assert seen == set("LRtsu")
