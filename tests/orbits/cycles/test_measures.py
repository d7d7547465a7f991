"""Velocities at impacts, from the nodes by hand: what the source calls B, of one impact and of all."""

import numpy as np
import pytest

from orbits import Absorber
from orbits.attractors import find_attractor

RESTITUTION, FREQUENCY, AMPLITUDE = 0.6, 1.3, 0.8


def test_mean_velocities_at_impacts_are_those_of_all_impacts():
    """B = (B+ - B-)/2 away from the wall; the cavity moves at C Omega cos Psi, and B+ - cavity = -r (B- - cavity)."""
    machine = Absorber(
        restitution=RESTITUTION, friction=0.3, gravity=0.211, mass_ratio=0.006, frequency=FREQUENCY
    )
    orbit = find_attractor(machine, {"w": 0.1, "w_rate": 0.3}, amplitude=AMPLITUDE).orbit
    assert orbit.word.text == "LR" and not orbit.symmetric
    psi, after = orbit.nodes.T
    cavity = AMPLITUDE * FREQUENCY * np.cos(psi)
    before = cavity - (after - cavity) / RESTITUTION
    away = np.where(np.array(orbit.word.events) == "L", 1.0, -1.0)
    each = 0.5 * away * (after - before)
    assert abs(each[0] - each[1]) > 0.01
    assert orbit.measure("B") == pytest.approx(each[0], abs=1e-12)
    assert orbit.measure("B_mean") == pytest.approx(each.mean(), abs=1e-12)
    assert orbit.measure("B_post") == pytest.approx(away[0] * after[0], abs=1e-12)
    assert orbit.measure("B_pre") == pytest.approx(-away[0] * before[0], abs=1e-12)
    assert orbit.measure("impact_speed") == pytest.approx(np.abs(before - cavity).max(), abs=1e-12)
    assert orbit.measure("impact_speed_min") == pytest.approx(np.abs(before - cavity).min(), abs=1e-12)
