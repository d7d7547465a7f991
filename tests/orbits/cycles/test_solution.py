"""What makes an orbit real: every margin, up to rounding."""

import numpy as np
import pytest

from orbits import Absorber, Cavity

MACHINE = Absorber(restitution=0.76, friction=0.2, gravity=0.211, mass_ratio=0.006)
H = 0.5 * np.pi * 1.006 * 0.2 * 0.211


@pytest.mark.parametrize(
    ("room", "real"), [(1e-3, True), (0.0, True), (-1e-8, False), (-1e-6, False), (-1e-3, False)]
)
def test_pure_sliding_is_real_up_to_the_walls(room, real):
    """It turns at w = -+ sqrt(C^2 - H^2)."""
    orbit = MACHINE.orbit("tt", 1, amplitude=float(np.hypot(1.0 - room, H)))
    assert orbit.real is real
    wall = [margin.value for margin in orbit.margins if margin.kind == "wall"]
    assert wall == pytest.approx([room] * len(wall), abs=1e-12) and wall


def test_unlike_walls_leave_unlike_room():
    machine = Cavity(
        restitution=0.76, friction=0.2, gravity=0.211, mass_ratio=0.006, distance_left=1.4, distance_right=0.6
    )
    orbit = machine.orbit("tt", 1, guess=MACHINE.orbit("tt", 1, amplitude=0.5).nodes, amplitude=0.5)
    reach = np.sqrt(0.25 - H**2)
    found = sorted(margin.value for margin in orbit.margins if margin.kind == "wall")
    assert found == pytest.approx([0.6 - reach, min(1.4 - reach, 0.6 + reach)], abs=1e-12)
