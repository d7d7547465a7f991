"""Loads at the walls against the momentum balance of the simulated motion, and in SI units against the formulas by hand."""

import numpy as np
import pytest

from orbits import Absorber, Coupled

R, EPS = 0.76, 0.006


@pytest.fixture(scope="module")
def orbit():
    return Absorber(restitution=R, friction=0.5, gravity=0.211, mass_ratio=EPS).symmetric_orbit(amplitude=0.6)


def test_impulses_change_the_absorbers_momentum(orbit):
    """B counts velocities times (1 + eps): the impulse on the absorber is the change of its absolute velocity."""
    events = orbit.events
    change = np.abs(events.B_post - events.B_pre) / (1.0 + EPS)
    relative = np.abs(events.rate_post - events.rate_pre) / (1.0 + EPS)
    np.testing.assert_allclose(relative, (1.0 + R) * np.abs(events.rate_pre) / (1.0 + EPS), rtol=1e-12)
    np.testing.assert_allclose(change, relative, rtol=1e-9)
    found = orbit.measures("impulse", "impulse_left", "impulse_right", "mean_force", "impact_rate")
    np.testing.assert_allclose(found["impulse"], relative.max(), rtol=1e-12)
    np.testing.assert_allclose(found["impulse_left"], found["impulse_right"], rtol=1e-9)  # it is symmetric
    np.testing.assert_allclose(found["impact_rate"], 2 / (2 * np.pi), rtol=1e-12)
    np.testing.assert_allclose(found["mean_force"], relative.sum() / (2 * np.pi), rtol=1e-12)


def test_energies_add_up(orbit):
    found = orbit.measures("impact_energy", "impact_loss", "friction_loss", "work_rate")
    np.testing.assert_allclose(found["impact_loss"], 2 * (1 - R**2) * found["impact_energy"], rtol=1e-9)
    total = found["impact_loss"] + found["friction_loss"]
    np.testing.assert_allclose(found["work_rate"], total / (2 * np.pi), rtol=1e-12)


def test_in_si_units():
    """All loads from the fastest impact's speed in m/s, the masses in kg and the frequency in Hz."""
    from orbits.machines.building import build

    machine = build(
        {
            "name": "coupled", "units": "si", "oscillator_mass": "3.2 kg", "absorber_mass": "32 g", "half_width": "15 mm",
            "natural_frequency": "8 Hz", "damping_ratio": 0.01, "restitution": 0.65, "friction": 0.1, "base_amplitude": "1 mm",
        }
    )  # fmt: skip
    orbit = machine.symmetric_orbit(frequency="8 Hz")
    found, units = orbit.measures(), machine.units
    speed = found["impact_speed"] * {"mm/s": 1e-3, "m/s": 1.0}[units["impact_speed"]]
    mass = 0.032 * 3.2 / 3.232
    assert units["impulse"] == "N s" and units["mean_force"] == "N" and units["impact_rate"] == "Hz"
    np.testing.assert_allclose(found["impact_rate"], 16.0, rtol=1e-12)
    np.testing.assert_allclose(found["impulse"], mass * 1.65 * speed, rtol=1e-9)
    np.testing.assert_allclose(found["mean_force"], 16.0 * mass * 1.65 * speed, rtol=1e-9)
    energy = found["impact_energy"] * {"mJ": 1e-3, "J": 1.0}[units["impact_energy"]]
    np.testing.assert_allclose(energy, 0.5 * mass * speed**2, rtol=1e-9)


def test_at_rest_there_are_none():
    still = Coupled(damping=0.5, mass_ratio=0.01, restitution=0.6, friction=0.4, gravity=5.0).orbit(
        "", forcing=0.01
    )
    assert not any(
        still.measures(
            "impact_rate", "impulse", "impulse_left", "impact_energy", "mean_force", "work_rate"
        ).values()
    )
