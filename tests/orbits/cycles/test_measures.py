"""What is measured of motions: velocities at impacts, called B in the source, from the nodes by hand; integrals and maxima of segments on a fine grid."""

import numpy as np
import pytest

from contvines.core.library import native
from orbits.machines.native_stepper import stepper
from orbits.machines.reference.machine import reference
from tests.machines import ABSORBER, COUPLED


def test_mean_velocities_at_impacts_are_those_of_all_impacts():
    """B = (B+ - B-)/2 away from the wall; the cavity moves at C Omega cos Psi, and B+ - cavity = -r (B- - cavity)."""
    machine = ABSORBER.changed(restitution=0.6, friction=0.3, frequency=1.3)
    orbit = machine.attractor({"w": 0.1, "w_rate": 0.3}, amplitude=0.8).orbit
    assert orbit.word.text == "LR" and not orbit.symmetric
    psi, after = orbit.nodes.T
    cavity = 0.8 * 1.3 * np.cos(psi)
    before = cavity - (after - cavity) / 0.6
    away = np.array([1.0, -1.0])
    each, speeds = 0.5 * away * (after - before), np.abs(before - cavity)
    assert abs(each[0] - each[1]) > 0.01
    expected = {"B": each[0], "B_mean": each.mean(), "B_post": after[0], "B_pre": -before[0]}
    expected |= {"impact_speed": speeds.max(), "impact_speed_min": speeds.min()}
    assert {name: orbit.measure(name) for name in expected} == pytest.approx(expected, abs=1e-12)


@pytest.mark.skipif(not native(), reason="the native core is not loaded")
def test_shapes_of_segments():
    """Largest displacements against a fine grid, integrals against the trapezoidal rule on it, and both cores against each other."""
    machine = COUPLED.changed(mass_ratio=0.2, damping=0.5, frequency=0.9)
    run = machine.simulate({"w_rate": 0.7, "v": 0.4}, events=12)
    states, lengths = run.states[:-1], run.lengths[:-1]
    found, wanted = np.empty((2, len(states), 4))
    for core, out in ((stepper, found), (reference, wanted)):
        core("coupled").shapes(states, run.params, lengths, out)
    np.testing.assert_allclose(found, wanted, atol=1e-12)
    for place, row in enumerate(found):
        ahead = np.linspace(0.0, lengths[place], 20001)
        w, _, v, _ = run.flown(np.full(len(ahead), place), ahead).T
        q1, psi = (v + 0.2 * w) / 1.2, states[place, 0] + ahead
        waves = np.array([v * np.sin(psi), v * np.cos(psi), q1 * np.sin(psi)])
        assert row == pytest.approx([np.abs(q1).max(), *np.trapezoid(waves, ahead)], abs=1e-7)
