"""Loads at the walls, in SI units and per absorber's mass, against the formulas by hand."""

import numpy as np
import pytest

from orbits import Absorber, Coupled, Machine
from orbits.flows import machine_of
from orbits.machines.measures import LOADS
from tests.machines import ABSORBER, STRONG
from tests.orbits.machines.coupled.bodies import nodes_of_bodies
from tools.pages.pages import page

R, EPS = STRONG["restitution"], STRONG["mass_ratio"]


@pytest.fixture(scope="module")
def orbit():
    return ABSORBER.symmetric_orbit(amplitude=0.6)


def test_in_si_units():
    """All loads from the fastest impact's speed in m/s, the masses in kg and the frequency in Hz."""
    machine = machine_of(
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
    np.testing.assert_allclose(found["impulse_left"], found["impulse_right"], rtol=1e-9)  # it is symmetric
    np.testing.assert_allclose(found["mean_force"], 16.0 * mass * 1.65 * speed, rtol=1e-9)
    energy = found["impact_energy"] * {"mJ": 1e-3, "J": 1.0}[units["impact_energy"]]
    np.testing.assert_allclose(energy, 0.5 * mass * speed**2, rtol=1e-9)


def test_half_sine_has_the_impulse(orbit):
    """The integral of F sin(pi t / T) from 0 to T is the impulse, the change of the absorber's absolute velocity."""
    machine = Absorber(**STRONG, contact_time=0.05)
    found = machine.symmetric_orbit(amplitude=0.6).measures("impulse", "peak_force", "impact_speed")
    times = np.linspace(0.0, 0.05, 20_001)
    area = np.trapezoid(found["peak_force"] * np.sin(np.pi * times / 0.05), times)
    np.testing.assert_allclose(area, found["impulse"], rtol=1e-8)
    change = (1.0 + R) * found["impact_speed"] / (1.0 + EPS)
    np.testing.assert_allclose(found["impulse"], change, rtol=1e-9)
    assert "0.05" in machine.notation["peak_force"]
    with pytest.raises(KeyError, match="contact_time"):
        orbit.measure("peak_force")


def test_a_page_with_its_energy_has_the_loads_of_the_machine():
    """The coupled machine as a declared one, the oscillator's mass 1: energies and impulses are mass_ratio times those per absorber's mass."""
    values = {**STRONG, "forcing": 2.47, "frequency": 1.01, "damping": 1.0}
    declared = page("coupled")
    machine = Machine(
        name="coupled_page", states=declared.states, parameters=declared.parameters | {"contact_time": 0.05},
        motion=declared.equations.formulas_of_motion, contacts=declared.contacts, phase_rate="frequency", mirror={"L": "R"},
        energy=lambda x, phase, p: 0.5 * (x.v1**2 + p.mass_ratio * x.v2**2 + x.q1**2),
    )  # fmt: skip
    known = Coupled(**values, contact_time=0.05).symmetric_orbit()
    orbit = machine.orbit(known.word.text, 1, nodes_of_bodies(known), **values)
    alike = {name: name for name in (*LOADS, "friction_loss", "work_rate") if not name.startswith("impulse_")}
    for name, same in (alike | {"impulse_L": "impulse_left", "impulse_R": "impulse_right"}).items():
        scale = 1.0 if name == "impact_rate" else EPS
        np.testing.assert_allclose(orbit.measure(name), scale * known.measure(same), rtol=1e-8, err_msg=name)
