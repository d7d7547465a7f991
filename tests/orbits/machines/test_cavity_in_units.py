"""A cavity with unlike walls in millimetres, hertz and degrees: the numbers by hand, both sides at once, refusals."""

import math

import pytest

import contvines as cv
from orbits import Cavity
from orbits.machines.physical import physical

SAID = {
    "half_width": "15 mm", "natural_frequency": "8 Hz", "frequency": "7.2 Hz", "restitution_left": 0.7, "restitution_right": 0.75,
    "friction": 0.1, "slope": "-3 deg", "amplitude": "9 mm", "gravity": "9.81 m/s^2",
}  # fmt: skip


def test_the_numbers_by_hand():
    """g/(b omega_0^2), Omega = f/f_0, C = A/b, the slope in radians."""
    machine = physical("cavity", SAID)
    numbers = dict(zip(machine.parameter_names, machine.vector()))
    rate = 2.0 * math.pi * 8.0
    wanted = {
        "gravity": 9.81 / (0.015 * rate**2), "frequency": 0.9, "amplitude": 0.6, "slope": -math.pi / 60.0, "friction_left": 0.1,
        "friction_right": 0.1, "restitution_left": 0.7, "restitution_right": 0.75, "distance_left": 1.0, "distance_right": 1.0,
    }  # fmt: skip
    for name, value in wanted.items():
        assert numbers[name] == pytest.approx(value, rel=1e-12), name


@pytest.mark.parametrize("name", ["cavity", "coupled"])
def test_a_slope_that_varies_is_counted_in_its_unit(name):
    """Angles in degrees are limited by the vertical, 90 degrees."""
    driven = {
        "oscillator_mass": "3 kg",
        "absorber_mass": "0.05 kg",
        "base_amplitude": "1 mm",
        "restitution": 0.7,
    }
    own = driven | {
        k: v for k, v in SAID.items() if k in ("half_width", "natural_frequency", "friction", "slope")
    }
    machine = physical(name, SAID if name == "cavity" else own)
    for value in (-3.0, 4.0, 90.0):
        machine.check_value("slope", value)
    with pytest.raises(
        ValueError, match=r"slope = 90.5 deg is out of range; give a number from -90 to 90 deg"
    ):
        machine.check_value("slope", 90.5)
    with pytest.raises(ValueError, match=r"half_width = '-1.0 mm' is out of range"):
        machine.check_value("half_width", -1.0)


def test_a_diagram_over_the_slope_in_degrees_is_the_one_in_radians():
    machine = physical("cavity", SAID | {"frequency": "8 Hz"})
    graph = cv.diagram(machine.orbit("LR"), over="slope", within=(-5.0, 5.0), depth=0)
    plain = Cavity(
        restitution_left=0.7, restitution_right=0.75, friction=0.1, gravity=9.81 / (0.015 * (16.0 * math.pi) ** 2)
    )  # fmt: skip
    ends = tuple(math.radians(end) for end in (-5.0, 5.0))
    known = cv.diagram(
        plain.orbit("LR", amplitude=0.6, slope=-math.pi / 60.0), over="slope", within=ends, depth=0
    )
    found = [(p.kind, math.radians(p.value)) for p in graph.special.values()]
    assert found and [kind for kind, _ in found] == [p.kind for p in known.special.values()]
    assert [v for _, v in found] == pytest.approx([p.value for p in known.special.values()], abs=1e-10)


def test_a_diagram_in_millimetres_is_the_dimensionless_one():
    machine = physical("cavity", SAID | {"frequency": "8 Hz"})
    graph = cv.diagram(machine.orbit("LR"), over="amplitude", within=(5.0, 12.0), depth=1)
    plain = Cavity(
        restitution_left=0.7, restitution_right=0.75, friction=0.1, slope=-math.pi / 60.0, gravity=9.81 / (0.015 * (16.0 * math.pi) ** 2)
    )  # fmt: skip
    known = cv.diagram(plain.orbit("LR", amplitude=0.6), over="amplitude", within=(5.0 / 15.0, 0.8), depth=1)
    found = [(p.kind, p.value / 15.0) for p in graph.special.values()]
    assert [kind for kind, _ in found] == [p.kind for p in known.special.values()]
    assert [v for _, v in found] == pytest.approx([p.value for p in known.special.values()], abs=1e-10)
