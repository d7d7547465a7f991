"""An inclined cavity with two frictions: statics and losses by hand."""

import math

import numpy as np
import pytest

from orbits import Cavity

MACHINE = Cavity(
    restitution_left=0.7, restitution_right=0.6, friction_left=0.3, friction_right=0.8, gravity=0.5,
    mass_ratio=0.2, frequency=1.3, slope=0.4, distance_left=1.2, distance_right=0.7,
)  # fmt: skip
AT = {"amplitude": 0.31}


@pytest.mark.parametrize("slope", [-0.4, 0.0, 0.1, 0.4])
@pytest.mark.parametrize("frictions", [(0.9, 0.7), (0.5, 0.9)])
def test_the_stuck_absorber_slips_where_gravity_helps(slope, frictions):
    """Shaking C Omega^2 and gravity's share along the cavity, against friction on either side."""
    machine = MACHINE.changed(slope=slope, friction_left=frictions[0], friction_right=frictions[1])
    weight, shaking = 1.2 * 0.5, 0.31 * 1.3**2
    to_left = weight * (frictions[0] * math.cos(slope) + math.sin(slope)) - shaking
    to_right = weight * (frictions[1] * math.cos(slope) - math.sin(slope)) - shaking
    assert machine.rest.reserve(machine.vector(AT), np.zeros(1)) == pytest.approx(min(to_left, to_right))


def test_friction_takes_its_force_times_the_way_on_either_side():
    steps = np.array([[0.7, -0.2, 0.0, -0.3]])
    expected = 0.5 * math.cos(0.4) * (0.3 * 0.7 + 0.8 * (0.2 + 0.3))
    assert MACHINE.friction_loss(steps, MACHINE.vector(AT)[None]) == pytest.approx([expected])
