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
