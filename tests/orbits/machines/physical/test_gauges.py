"""Physical machines by hand: their numbers, what a unit of each measure is, and what follows when one quantity changes."""

import math

import pytest

from orbits.machines.physical import physical

SHAKEN = {
    "amplitude": "8 mm", "half_width": "15 mm", "frequency": "8 Hz", "natural_frequency": "7 Hz", "restitution": 0.7,
    "friction": 0.3, "gravity": "9.81 m/s^2", "oscillator_mass": "3.8 kg", "absorber_mass": "32 g",
}  # fmt: skip
DRIVEN = {
    "base_amplitude": "0.3 mm", "half_width": "15 mm", "frequency": "7.5 Hz", "natural_frequency": "7 Hz",
    "restitution": 0.7, "friction": 0.3, "gravity": "9.81 m/s^2", "oscillator_mass": "3.8 kg", "absorber_mass": "32 g",
    "damping_ratio": 0.007,
}  # fmt: skip
RATE = 2.0 * math.pi * 7.0
CASES = [("absorber", SHAKEN), ("coupled", DRIVEN)]


def test_the_numbers_of_a_shaken_cavity():
    machine = physical("absorber", SHAKEN)
    numbers = dict(zip(machine.parameter_names, machine.vector()))
    assert numbers["amplitude"] == pytest.approx(8.0 / 15.0) and numbers["frequency"] == pytest.approx(
        8.0 / 7.0
    )
    assert numbers["gravity"] == pytest.approx(9.81 / (0.015 * RATE**2))
    assert numbers["mass_ratio"] == pytest.approx(0.032 / 3.8)


def test_the_numbers_of_a_driven_oscillator():
    """Base amplitude E = G b eps, damping c = lambda m omega_0 with the damping ratio c / (2 M omega_0)."""
    machine = physical("coupled", DRIVEN)
    numbers = dict(zip(machine.parameter_names, machine.vector()))
    eps = 0.032 / 3.8
    assert numbers["mass_ratio"] == pytest.approx(eps)
    assert numbers["forcing"] == pytest.approx(0.3 / 15.0 / eps)
    assert numbers["damping"] == pytest.approx(2.0 * 0.007 / eps)
    assert numbers["frequency"] == pytest.approx(7.5 / 7.0)


@pytest.mark.parametrize(("name", "given"), CASES)
def test_what_one_unit_of_a_measure_is(name, given):
    """Lengths in b, times in 1/omega_0, energies in m b^2 omega_0^2; shown in mm, mm/s, mm^2, mJ and s."""
    machine = physical(name, given)
    params = machine.vector()
    expected = {
        "length": 15.0,
        "area": 15.0**2,
        "velocity": 15.0 * RATE,
        "energy": 1e3 * 0.032 * (0.015 * RATE) ** 2,
        "time": 1.0 / RATE,
        "angle": 1.0,
    }
    for kind, value in expected.items():
        assert machine.gauge(kind, params) == pytest.approx(value, rel=1e-12), kind


@pytest.mark.parametrize(("name", "given"), CASES)
def test_one_quantity_changes_and_the_others_stay(name, given):
    machine = physical(name, given)
    for quantity, value in machine.quantities.items():
        unit = machine.units.get(quantity, "")
        for share in (0.8, 0.9):
            text = f"{share * value!r} {unit}" if unit else share * value
            other = physical(name, {**given, quantity: text}, unusual=True)
            assert machine.vector_at(quantity, share * value) == pytest.approx(other.vector(), rel=1e-12), (
                quantity
            )
