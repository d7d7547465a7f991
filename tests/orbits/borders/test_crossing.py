"""What counts as an orbit beyond a border: every margin kept, and followed by the simulation."""

import numpy as np
import pytest

from orbits import Absorber
from orbits.borders.crossing import _followed

MACHINE = Absorber(restitution=0.76, friction=0.2, gravity=0.211, mass_ratio=0.006)
H = 0.5 * np.pi * 1.006 * 0.2 * 0.211


@pytest.mark.parametrize(
    ("room", "real"), [(1e-6, True), (1e-12, True), (-1e-8, False), (-1e-7, False), (-1e-4, False)]
)
def test_pure_sliding_a_little_beyond_the_walls_is_none(room, real):
    """It turns at w = -+ sqrt(C^2 - H^2); the simulation that hits a wall so slowly still stays within a millionth."""
    orbit = MACHINE.orbit("tt", 1, amplitude=float(np.hypot(1.0 - room, H)))
    problem = orbit.problem()
    assert _followed(problem, *orbit.seed(problem), orbit) is real
