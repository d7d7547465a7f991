"""An inclined cavity with unlike walls and frictions: simulation against a plain integration with event detection, statics and losses by hand."""

import math
from dataclasses import replace

import numpy as np
import pytest

from orbits import Cavity
from orbits.machines.reference.machine import reference
from orbits.simulation import simulate
from tests.orbits.simulation.plain_integration import events_of

MACHINE = Cavity(
    restitution_left=0.9, restitution_right=0.5, friction_left=0.1, friction_right=0.9, gravity=0.5,
    mass_ratio=0.2, frequency=1.3, slope=0.15, distance_left=1.2, distance_right=0.7,
)  # fmt: skip
WEIGHT = 1.2 * 0.5
STARTS = [(0.5, (0.4, 0.3, 0.9)), (0.8, (2.0, -0.2, -1.0)), (1.5, (4.0, 0.1, 1.5)), (0.35, (1.0, 0.0, 0.8))]


def test_events_are_those_of_a_plain_integration_and_energies_balance():
    pull, normal = WEIGHT * math.sin(0.15), WEIGHT * math.cos(0.15)
    sides = {1: 0.1 * normal, -1: 0.9 * normal}, {1: 1.2, -1: -0.7}, {1: 0.9, -1: 0.5}
    seen = set()
    for amplitude, start in STARTS:
        letters, *told = zip(*events_of(amplitude, 1.3, pull, *sides, start, 9))
        run = simulate(MACHINE, dict(zip(("phase", "w", "w_rate"), start)), events=9, amplitude=amplitude)
        assert run.letters == "".join(letters)
        assert np.array([run.phases, *run.rows[:, [2, 4]].T]) == pytest.approx(np.array(told), abs=1e-10)
        for stepper in (run.machine, reference("cavity")):
            assert abs(replace(run, machine=stepper).balance().error) < 1e-11
        seen |= set(run.letters)
    assert seen == set("LRtsu")


@pytest.mark.parametrize("slope", [-0.4, 0.0, 0.1, 0.4])
@pytest.mark.parametrize("frictions", [(0.9, 0.7), (0.5, 0.9)])
def test_the_stuck_absorber_slips_where_gravity_helps(slope, frictions):
    """Shaking C Omega^2 and gravity's share along the cavity, against friction on either side."""
    machine = MACHINE.changed(slope=slope, friction_left=frictions[0], friction_right=frictions[1])
    to_left, to_right = (
        WEIGHT * (friction * math.cos(slope) + side * math.sin(slope))
        for friction, side in zip(frictions, (1, -1))
    )
    found = machine.rest.reserve(machine.vector({"amplitude": 0.31}), np.zeros(1))
    assert found == pytest.approx(min(to_left, to_right) - 0.31 * 1.3**2)


def test_friction_takes_its_force_times_the_way_on_either_side():
    steps = np.array([[0.7, -0.2, 0.0, -0.3]])
    expected = 0.5 * math.cos(0.15) * (0.1 * 0.7 + 0.9 * (0.2 + 0.3))
    assert MACHINE.friction_loss(steps, MACHINE.vector({"amplitude": 0.31})[None]) == pytest.approx(
        [expected]
    )
