"""Sections: a cycle that was solved for comes back to where it met the section, by simulation."""

import numpy as np
import pytest

from orbits import Absorber, Cavity
from tests.machines import ABSORBER


@pytest.mark.parametrize(
    ("machine", "amplitude"),
    [
        (ABSORBER, 0.55),
        (Absorber(restitution=0.76, friction=0.5, gravity=0.211, mass_ratio=0.006, frequency=1.4), 0.55),
        (
            Cavity(
                restitution_left=0.6,
                restitution_right=0.8,
                friction=0.1,
                gravity=0.2,
                slope=0.1,
                mass_ratio=0.006,
                frequency=0.7,
                distance_left=1.7,
                distance_right=2.1,
            ),
            1.4,
        ),
    ],
    ids=["units of one", "another frequency", "another cavity"],
)
def test_a_cycle_comes_back(machine, amplitude):
    orbit = machine.orbit("LR", amplitude=amplitude)
    problem = orbit.problem("amplitude")
    u, p = orbit.seed(problem)[:2]
    section = problem.section(p)
    places = section.rounds(u)
    assert len(places) == 1
    assert np.abs(section.step(places[0]) - places[0]).max() < 1e-10
    assert np.abs(section.through(u) - places[0]).max() < 1e-10


def test_before_and_after_an_impact_the_motion_is_one():
    machine = Cavity(
        restitution_left=0.6,
        restitution_right=0.8,
        friction=0.1,
        gravity=0.2,
        slope=0.1,
        mass_ratio=0.006,
        frequency=0.7,
    )
    orbit = machine.orbit("LR", amplitude=1.4)
    problem = orbit.problem("amplitude")
    section = problem.section(1.4)
    for wall, rate in ((1.0, 0.7), (1.0, -0.5), (-1.0, -1.1), (-1.0, 0.4)):
        here = np.array([wall, rate])
        other, away = section.struck(here, 1e-6)
        assert other[0] == wall and other[1] * rate < 0.0 and away[0] * wall < 0.0
        inside = np.array([[x[0] - 1e-9 * wall, x[1]] for x in (here, other)])  # no start on the wall itself
        assert np.abs(section.step(inside[0]) - section.step(inside[1])).max() < 1e-6
    assert section.struck(np.array([0.5, 1.0]), 1e-3) is None
