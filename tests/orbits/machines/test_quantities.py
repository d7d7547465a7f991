"""Machines in kilograms, millimetres, hertz and degrees: their numbers by hand, what varies with what, units of measures, and sentences."""

import math
import pickle
import re

import numpy as np
import pytest

import contvines as cv
from orbits import Absorber, Cavity, Coupled
from orbits.flows import machine_of
from orbits.machines.base import ParameterError
from orbits.machines.physical import QuantityError, physical
from orbits.machines.reference.machine import reference
from orbits.models.scales import Scales

RATE = 16.0 * math.pi  # 8 Hz
BODIES = {"oscillator_mass": "3.8 kg", "absorber_mass": "32 g"}
COMMON = {"half_width": "15 mm", "natural_frequency": "8 Hz", "friction": 0.1}
GIVEN = {
    "absorber": BODIES | COMMON | {"restitution": 0.7, "amplitude": "8 mm", "frequency": "9 Hz"},
    "cavity": COMMON | {
        "restitution_left": 0.7, "restitution_right": 0.75, "slope": "-3 deg", "amplitude": "9 mm",
        "frequency": "7.2 Hz", "gravity": "9.81 m/s^2",
    },
    "coupled": BODIES | COMMON | {
        "damping_ratio": 0.007, "restitution": 0.6, "base_amplitude": "0.3 mm", "frequency": "7.7 Hz",
    },
}  # fmt: skip


def driven(M, m, b, k, c, g, E, f):
    """The model section's definitions."""
    omega = math.sqrt(k / M)
    return {
        "mass_ratio": m / M,
        "damping": c / (m * omega),
        "gravity": g / (b * omega**2),
        "forcing": E * M / (b * m),
        "frequency": 2 * math.pi * f / omega,
    }


LARGE = 2.0 * (2 * math.pi * 5) ** 2
BY_HAND = [
    ("absorber", {}, {"amplitude": 8.0 / 15.0, "frequency": 9.0 / 8.0, "gravity": 9.81 / (0.015 * RATE**2), "mass_ratio": 0.032 / 3.8}),
    ("cavity", {}, {
        "gravity": 9.81 / (0.015 * RATE**2), "frequency": 0.9, "amplitude": 0.6, "slope": -math.pi / 60.0, "friction_left": 0.1,
        "friction_right": 0.1, "restitution_left": 0.7, "restitution_right": 0.75, "distance_left": 1.0, "distance_right": 1.0,
    }),
    ("coupled", {
        "stiffness": "9.6 kN/m", "half_width": "1.5 cm", "damping": "2.7 N s/m", "base_amplitude": "300 um", "frequency": "480 rpm",
    }, driven(3.8, 0.032, 0.015, 9600.0, 2.7, 9.81, 0.0003, 8.0) | {"excitation": 1.0}),
    ("coupled", {
        "oscillator_mass": "2 kg", "natural_frequency": "5 Hz", "mass_ratio": 0.02, "half_width": "20 mm", "damping_ratio": "1 %",
        "gravity": "1.62 m/s^2", "base_amplitude": "1 mm", "frequency": "31 rad/s",
    }, driven(2.0, 0.04, 0.02, LARGE, 2 * 0.01 * 2 * 2 * math.pi * 5, 1.62, 0.001, 31.0 / (2 * math.pi))),
    ("coupled", {
        "oscillator_mass": "120 lb", "stiffness": "40 N/mm", "absorber_mass": "0.5 kg", "half_width": "1 inch",
        "damping": "15 N s/m", "force_amplitude": "12 N", "frequency": "4.2 Hz",
    }, driven(54.4310844, 0.5, 0.0254, 40000.0, 15.0, 9.81, 12.0 / 40000.0, 4.2) | {"excitation": 0.0}),
]  # fmt: skip
INSTEAD = {"stiffness": "natural_frequency", "damping": "damping_ratio", "mass_ratio": "absorber_mass", "force_amplitude": "base_amplitude"}  # fmt: skip


@pytest.mark.parametrize(("name", "changes", "wanted"), BY_HAND)
def test_numbers_by_hand(name, changes, wanted):
    replaced = {INSTEAD.get(quantity) for quantity in changes}
    machine = physical(
        name, {key: value for key, value in GIVEN[name].items() if key not in replaced} | changes
    )
    params = machine.vector()
    numbers = dict(zip(machine.parameter_names, params))
    assert {key: numbers[key] for key in wanted} == pytest.approx(wanted, rel=1e-12)
    # what stands behind a machine's own numbers is nothing to its equations
    assert reference(name).law(params) == reference(name).law(params[: len(machine.base.parameter_names)])


def test_the_published_machine():
    """f0 = 7.666 Hz and b = 0.02 m belong to g~ = 0.211 and, with m = 0.006 M, to eps = 0.006."""
    rig = {
        "oscillator_mass": 3.0,
        "absorber_mass": 0.018,
        "half_width": 0.02,
        "natural_frequency": 7.666,
        "damping": 0.78,
    }
    scales = Scales(**rig, friction=0.5, restitution=0.76, base_amplitude=2.47 * 0.02 * 0.006)
    machine = scales.machine(hertz=0.985 * 7.666)
    assert isinstance(machine, Coupled) and not isinstance(machine, Absorber)
    omega = 2 * math.pi * 7.666
    found = [machine.mass_ratio, machine.forcing, machine.frequency, machine.damping, scales.stiffness]
    assert found == pytest.approx([0.006, 2.47, 0.985, 0.78 / (0.018 * omega), 3.0 * omega**2], rel=1e-12)
    assert machine.gravity == pytest.approx(0.211, abs=5e-4)
    assert scales.detuning(0.985 * 7.666) == pytest.approx(-2.5, rel=1e-9)


def test_quantities_are_kept_as_they_were_said():
    machine = physical("coupled", GIVEN["coupled"] | {"half_width": "1.5 cm"})
    assert (machine.quantities["half_width"], machine.units["half_width"]) == (1.5, "cm")
    for again in (machine_of(machine.settings()), pickle.loads(pickle.dumps(machine))):
        assert np.array_equal(again.vector(), machine.vector())


OTHERS = ["mass_ratio", "stiffness", "damping", "gravity", "base_acceleration", "force_amplitude"]
QUANTITIES = [(name, quantity) for name, given in GIVEN.items() for quantity in given]


@pytest.mark.parametrize(("name", "quantity"), [*QUANTITIES, *(("coupled", other) for other in OTHERS)])
def test_path_of_every_quantity(name, quantity):
    """What varies moves the numbers as machines do that are described anew."""
    machine = physical(name, GIVEN[name])
    machine = machine.given_by(quantity) if name == "coupled" else machine
    value, unit = machine.quantities[quantity], machine.units.get(quantity, "")
    factors, powers = machine.path(quantity, machine.vector())
    for share in (0.8, 0.9, 1.0, 1.05):
        told = machine.with_(**{quantity: f"{share * value!r} {unit}" if unit else share * value})
        moved = np.where(powers != 0.0, factors * (share * value) ** powers, machine.vector())
        np.testing.assert_allclose(moved, told.vector(), rtol=1e-13)
        np.testing.assert_allclose(machine.vector_at(quantity, share * value), moved, rtol=1e-15)


@pytest.mark.parametrize("name", ["absorber", "coupled"])
def test_what_one_unit_of_a_measure_is(name):
    """Lengths in b, times in 1/omega_0, energies in m b^2 omega_0^2; shown in mm, mm/s, mm^2, mJ and s."""
    machine = physical(name, GIVEN[name])
    energy = 1e3 * 0.032 * (0.015 * RATE) ** 2
    units = {
        "length": 15.0,
        "area": 225.0,
        "velocity": 15.0 * RATE,
        "energy": energy,
        "time": 1.0 / RATE,
        "angle": 1.0,
    }
    for kind, value in units.items():
        assert machine.gauge(kind, machine.vector()) == pytest.approx(value, rel=1e-12), kind


@pytest.mark.parametrize(
    ("over", "within", "unit"),
    [("slope", (-5.0, 5.0), math.pi / 180.0), ("amplitude", (5.0, 12.0), 1 / 15.0)],
)
def test_diagrams_in_degrees_and_millimetres_are_those_of_the_numbers(over, within, unit):
    machine = physical("cavity", GIVEN["cavity"] | {"frequency": "8 Hz"})
    plain = Cavity(
        restitution_left=0.7, restitution_right=0.75, friction=0.1, gravity=9.81 / (0.015 * RATE**2)
    )
    known = cv.diagram(
        plain.orbit("LR", amplitude=0.6, slope=-math.pi / 60.0), over=over, within=tuple(unit * end for end in within), depth=1
    )  # fmt: skip
    graph = cv.diagram(machine.orbit("LR"), over=over, within=within, depth=1)
    assert [p.kind for p in graph.special.values()] == [p.kind for p in known.special.values()]
    values = [unit * p.value for p in graph.special.values()]
    assert values and values == pytest.approx([p.value for p in known.special.values()], abs=1e-10)


REFUSED = {
    "half_width = '15 kg': 'kg' is the unit of a mass, but half_width is a length; for example \"15 mm\"": {"half_width": "15 kg"},
    "half_width = 15 has no unit": {"half_width": 15},
    "half_width = '15 furlogs': 'furlogs' is no unit of a length; for example \"15 mm\"": {"half_width": "15 furlogs"},
    "'hz' is no unit of a frequency (did you mean 'Hz'?)": {"natural_frequency": "8 hz"},
    "half_width = '3,5 mm' is not a number with a unit": {"half_width": "3,5 mm"},
    "is out of range; give a value above 0": {"half_width": "-3 mm"},
    "half_width = '20 m' is implausible for the clearance to either side: expected 0.01 to 2000 mm": {"half_width": "20 m"},
    "friction is a plain number": {"friction": "0.1 mm"},
    "has no such quantity (did you mean 'half_width'?)": {"clearance": "15 mm"},
}  # fmt: skip


@pytest.mark.parametrize("says", REFUSED)
def test_bad_quantities_get_a_sentence(says):
    with pytest.raises(QuantityError, match=re.escape(says)):
        physical("coupled", GIVEN["coupled"] | REFUSED[says])


def test_missing_and_unusual():
    given = GIVEN["coupled"]
    for name in ("half_width", "absorber_mass", "restitution", "base_amplitude"):
        with pytest.raises(QuantityError, match=f"{name} .*is missing|{name} is missing"):
            physical("coupled", {key: value for key, value in given.items() if key != name})
    assert physical("coupled", given | {"half_width": "20 m"}, unusual=True).quantities["half_width"] == 20.0
    with pytest.raises(ParameterError):
        physical("coupled", given).orbit("LR", frequency="7.9 mm")


@pytest.mark.parametrize("name", ["cavity", "coupled"])
def test_a_slope_that_varies_is_counted_in_its_unit(name):
    """Angles in degrees are limited by the vertical, 90 degrees."""
    machine = physical(name, GIVEN[name] | {"slope": "-3 deg"})
    for value in (-3.0, 4.0, 90.0):
        machine.check_value("slope", value)
    with pytest.raises(
        ValueError, match=r"slope = 90.5 deg is out of range; give a number from -90 to 90 deg"
    ):
        machine.check_value("slope", 90.5)
    with pytest.raises(ValueError, match=r"half_width = '-1.0 mm' is out of range"):
        machine.check_value("half_width", -1.0)
