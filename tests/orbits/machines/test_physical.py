"""Machines in kilograms, millimetres and hertz: their numbers by hand, what varies with what, and every bad quantity's sentence."""

import pickle

import mpmath as mp
import numpy as np
import pytest

from orbits.flows import machine_of
from orbits.machines.base import ParameterError
from orbits.machines.physical import QuantityError, physical

FLAT = {
    "oscillator_mass": "3.8 kg",
    "natural_frequency": "8 Hz",
    "absorber_mass": "32 g",
    "half_width": "15 mm",
    "damping_ratio": 0.007,
    "restitution": 0.6,
    "friction": 0.1,
    "base_amplitude": "0.3 mm",
}


def hand(M, m, b, k, c, g, E, f):
    """The model section's definitions, in 30 digits."""
    M, m, b, k, c, g, E, f = (mp.mpf(value) for value in (M, m, b, k, c, g, E, f))
    omega = mp.sqrt(k / M)
    return {
        "mass_ratio": m / M,
        "damping": c / (m * omega),
        "gravity": g / (b * omega**2),
        "forcing": E * M / (b * m),
        "frequency": 2 * mp.pi * f / omega,
    }


def case_by_stiffness():
    given = {
        "oscillator_mass": "3.8 kg", "stiffness": "9.6 kN/m", "absorber_mass": "32 g", "half_width": "1.5 cm",
        "damping": "2.7 N s/m", "restitution": 0.6, "friction": 0.1, "base_amplitude": "300 um", "frequency": "480 rpm",
    }  # fmt: skip
    return given, hand("3.8", "0.032", "0.015", "9600", "2.7", "9.81", "0.0003", "8")


def case_by_ratios():
    k = mp.mpf(2) * (2 * mp.pi * 5) ** 2
    c = 2 * mp.mpf("0.01") * 2 * (2 * mp.pi * 5)
    given = {
        "oscillator_mass": "2 kg", "natural_frequency": "5 Hz", "mass_ratio": 0.02, "half_width": "20 mm", "damping_ratio": "1 %",
        "restitution": 0.8, "friction": 0.0, "gravity": "1.62 m/s^2", "base_amplitude": "1 mm", "frequency": "31 rad/s",
    }  # fmt: skip
    return given, hand("2", "0.04", "0.02", k, c, "1.62", "0.001", mp.mpf(31) / (2 * mp.pi))


def case_by_force():
    given = {
        "oscillator_mass": "120 lb", "stiffness": "40 N/mm", "absorber_mass": "0.5 kg", "half_width": "1 inch",
        "damping": "15 N s/m", "restitution": 0.7, "friction": 0.2, "force_amplitude": "12 N", "frequency": "4.2 Hz",
    }  # fmt: skip
    return given, hand(
        mp.mpf("54.4310844"), "0.5", "0.0254", "40000", "15", "9.81", mp.mpf(12) / 40000, "4.2"
    )


@pytest.mark.parametrize("case", [case_by_stiffness, case_by_ratios, case_by_force])
def test_numbers_by_hand(case):
    given, wanted = case()
    machine = physical("coupled", given)
    numbers = dict(zip(machine.parameter_names, machine.vector({})))
    for name, value in wanted.items():
        assert numbers[name] == pytest.approx(float(value), rel=1e-12), name
    assert numbers["excitation"] == (0.0 if "force_amplitude" in given else 1.0)


def test_quantities_are_kept_as_they_were_said():
    machine = physical("coupled", FLAT | {"half_width": "1.5 cm"})
    assert machine.quantities["half_width"] == 1.5
    assert machine.units["half_width"] == "cm"
    again = machine_of(machine.settings())
    assert np.array_equal(again.vector({}), machine.vector({}))
    assert np.array_equal(pickle.loads(pickle.dumps(machine)).vector({}), machine.vector({}))


QUANTITIES = [
    "half_width", "absorber_mass", "mass_ratio", "oscillator_mass", "natural_frequency", "stiffness", "damping_ratio", "damping",
    "restitution", "friction", "gravity", "base_amplitude", "base_acceleration", "force_amplitude", "frequency",
]  # fmt: skip


@pytest.mark.parametrize("name", QUANTITIES)
def test_path_of_every_quantity(name):
    """What varies moves the numbers as machines do that are described anew, and in the direction of their differences."""
    machine = physical("coupled", FLAT | {"frequency": "7.7 Hz"}).given_by(name)
    value, unit = machine.quantities[name], machine.units.get(name, "")
    factors, powers = machine.path(name, machine.vector({}))
    for share in (0.9, 1.0, 1.05):
        told = machine.with_(**{name: f"{share * value!r} {unit}" if unit else share * value})
        moved = np.where(powers != 0.0, factors * (share * value) ** powers, machine.vector({}))
        np.testing.assert_allclose(moved, told.vector({}), rtol=1e-13)
        np.testing.assert_allclose(machine.vector_at(name, share * value), moved, rtol=1e-15)
    law = machine.law
    np.testing.assert_allclose(
        law[0] * np.prod(machine.counts[:, None] ** law[1:], axis=0), machine.vector({}), rtol=1e-13
    )


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"half_width": "15 kg"}, "half_width = '15 kg': 'kg' is the unit of a mass, but half_width is a length; for example \"15 mm\""),

        ({"half_width": 15}, "half_width = 15 has no unit"),
        ({"half_width": "15 furlogs"}, "half_width = '15 furlogs': 'furlogs' is no unit of a length; for example \"15 mm\""),


        ({"natural_frequency": "8 hz"}, "'hz' is no unit of a frequency (did you mean 'Hz'?)"),

        ({"half_width": "3,5 mm"}, "half_width = '3,5 mm' is not a number with a unit"),
        ({"half_width": "-3 mm"}, "is out of range; give a value above 0"),



        ({"half_width": "20 m"}, "half_width = '20 m' is implausible for the clearance to either side: expected 0.01 to 2000 mm"),



        ({"friction": "0.1 mm"}, "friction is a plain number"),



        ({"clearance": "15 mm"}, "has no such quantity (did you mean 'half_width'?)"),
    ],
)  # fmt: skip
def test_bad_quantities_get_a_sentence(change, says):
    with pytest.raises(QuantityError) as caught:
        physical("coupled", FLAT | change)
    assert says in str(caught.value)


def test_missing_and_unusual():
    for name in ("half_width", "absorber_mass", "restitution", "base_amplitude"):
        with pytest.raises(QuantityError, match=f"{name} .*is missing|{name} is missing"):
            physical("coupled", {key: value for key, value in FLAT.items() if key != name})
    assert physical("coupled", FLAT | {"half_width": "20 m"}, unusual=True).quantities["half_width"] == 20.0
    with pytest.raises(ParameterError):
        physical("coupled", FLAT).orbit("LR", frequency="7.9 mm")
