"""The numbers of an inclined cavity with two frictions: statics and losses by hand, derivatives by differences."""

import math

import numpy as np
import pytest

from orbits import Cavity
from orbits.machines.reference.law import cavity

VALUES = {
    "amplitude": 0.31, "restitution_left": 0.7, "restitution_right": 0.6, "friction_left": 0.3, "friction_right": 0.8,
    "gravity": 0.5, "mass_ratio": 0.2, "frequency": 1.3, "slope": 0.4, "distance_left": 1.2, "distance_right": 0.7,
}  # fmt: skip


def made(**changes):
    return Cavity(**{name: value for name, value in (VALUES | changes).items() if name != "amplitude"})


def vector(machine):
    return machine.vector({"amplitude": VALUES["amplitude"]})


def by_hand(v):
    """Accelerations -w'' while sliding to the left and to the right wall: gravity along the cavity, and friction against the motion."""
    weight = (1 + v["mass_ratio"]) * v["gravity"]
    b, normal = weight * math.sin(v["slope"]), weight * math.cos(v["slope"])
    return [
        v["amplitude"], v["frequency"], b + normal * v["friction_left"], b - normal * v["friction_right"], b,
        v["restitution_left"], v["restitution_right"], v["distance_left"], -v["distance_right"],
    ]  # fmt: skip


def numbers(law):
    pulls = law.pull_left, law.pull_right, law.lean
    return [
        law.amplitude,
        law.omega,
        *pulls,
        law.restitution_left,
        law.restitution_right,
        law.left,
        law.right,
    ]


def test_the_numbers():
    params = np.array([VALUES[name] for name in Cavity.parameter_names])
    assert numbers(cavity(params)) == pytest.approx(by_hand(VALUES), rel=1e-15)


@pytest.mark.parametrize("slope", [-0.4, 0.0, 0.1, 0.4])
@pytest.mark.parametrize("frictions", [(0.9, 0.7), (0.5, 0.9)])
def test_the_stuck_absorber_slips_where_gravity_helps(slope, frictions):
    """Shaking C Omega^2 and gravity's share along the cavity, against friction on either side."""
    machine = made(slope=slope, friction_left=frictions[0], friction_right=frictions[1])
    params = vector(machine)
    weight, shaking = 1.2 * 0.5, 0.31 * 1.3**2
    to_left = weight * (frictions[0] * math.cos(slope) + math.sin(slope)) - shaking
    to_right = weight * (frictions[1] * math.cos(slope) - math.sin(slope)) - shaking
    assert machine.rest.reserve(params, np.zeros(1)) == pytest.approx(min(to_left, to_right))


def test_friction_takes_its_force_times_the_way_on_either_side():
    machine = made()
    steps = np.array([[0.7, -0.2, 0.0, -0.3]])
    force = 0.5 * math.cos(0.4)
    expected = force * (0.3 * 0.7 + 0.8 * (0.2 + 0.3))
    assert machine.friction_loss(steps, vector(machine)[None]) == pytest.approx([expected])


@pytest.mark.parametrize(("slope", "word", "r"), [(0.4, "R", 0.6), (-0.4, "L", 0.7)])
def test_a_ball_bounces_off_the_lower_wall_with_that_wall_s_restitution(slope, word, r):
    """In one period gravity turns the velocity round: the wall gives back (1 + r) of the approach relative to it."""
    machine = made(slope=slope, friction_left=0.0, friction_right=0.0)
    orbit = machine.orbit(word, 1, amplitude=2.5)
    assert orbit.residual < 1e-11
    before, after = orbit.events.rate_pre[0], orbit.events.rate_post[0]
    assert after == pytest.approx(-r * before)
    b, period = 1.2 * 0.5 * math.sin(slope), 2.0 * math.pi / 1.3
    assert after - before == pytest.approx(b * period)  # v' is the same at both ends of the flight
