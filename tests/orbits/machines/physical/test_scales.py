"""SI data and dimensionless numbers."""

import math

import pytest

from orbits import Absorber, Coupled
from orbits.machines.parameters import ParameterError
from orbits.models.scales import Scales

RIG = {
    "oscillator_mass": 3.0,
    "absorber_mass": 0.018,
    "half_width": 0.02,
    "natural_frequency": 7.666,
    "damping": 0.78,
}


def test_the_published_machine():
    """f0 = 7.666 Hz and b = 0.02 m belong to g~ = 0.211 and, with m = 0.006 M, to eps = 0.006."""
    scales = Scales(**RIG, friction=0.5, restitution=0.76, base_amplitude=2.47 * 0.02 * 0.006)
    machine = scales.machine(hertz=0.985 * 7.666)
    assert isinstance(machine, Coupled) and not isinstance(machine, Absorber)
    assert machine.gravity == pytest.approx(0.211, abs=5e-4)
    assert machine.mass_ratio == pytest.approx(0.006, rel=1e-12)
    assert machine.forcing == pytest.approx(2.47, rel=1e-12)
    assert machine.frequency == pytest.approx(0.985, rel=1e-12)
    omega = 2 * math.pi * 7.666
    assert machine.damping == pytest.approx(0.78 / (0.018 * omega), rel=1e-12)
    assert scales.stiffness == pytest.approx(3.0 * omega**2, rel=1e-12)
    assert scales.detuning(0.985 * 7.666) == pytest.approx(-2.5, rel=1e-9)


def test_back_to_si():
    scales = Scales(**RIG, friction=0.5, restitution=0.76, base_amplitude=3e-4)
    again = Scales.of(scales.machine(), oscillator_mass=3.0, half_width=0.02)
    assert again.natural_frequency == pytest.approx(7.666, rel=1e-12)
    assert again.damping == pytest.approx(0.78, rel=1e-12)
    assert again.base_amplitude == pytest.approx(3e-4, rel=1e-12)
    assert Scales.of(
        scales.machine(), oscillator_mass=3.0, natural_frequency=7.666
    ).half_width == pytest.approx(0.02)
    assert scales.hertz(scales.frequency(7.5)) == pytest.approx(7.5)
    assert scales.metres(0.5) == pytest.approx(0.01)
    assert scales.metres_per_second(1.0) * scales.seconds(1.0) == pytest.approx(0.02)
    # one half of m v^2 with v = b omega_0
    assert scales.joules(0.5) == pytest.approx(0.5 * 0.018 * scales.metres_per_second(1.0) ** 2)


def test_frequency_through_zero_and_resonance_without_damping():
    scales = Scales(**{**RIG, "damping": 0.0}, base_amplitude=1e-4)
    with pytest.raises(ParameterError, match=r"frequency = 0 Hz is out of range; give a number above 0"):
        scales.frequency(0.0)
    with pytest.raises(ParameterError, match=r"resonance .* damping = 0"):
        scales.machine(hertz=scales.natural_frequency)
    with pytest.raises(ParameterError, match=r"frequency = 0 is out of range"):
        Coupled(restitution=0.7, friction=0.1, gravity=0.1, mass_ratio=0.01, frequency=0.0)
    undamped = Coupled(restitution=0.7, friction=0.1, gravity=0.1, mass_ratio=0.01, damping=0.0, forcing=1.0)
    with pytest.raises(ParameterError, match="give a damping above 0 or another frequency"):
        undamped.vector({"frequency": 1.0})
    assert undamped.vector({"frequency": 1.0, "forcing": 0.0})[0] == 0.0  # free motion is bounded


def test_a_missing_forcing_is_named():
    machine = Coupled(restitution=0.7, friction=0.1, gravity=0.1, mass_ratio=0.01)
    with pytest.raises(ParameterError, match="forcing is missing"):
        machine.vector()
    assert machine.vector({"forcing": 2.0})[0] == 2.0
    assert machine.changed(excitation=0.0).excitation == "truncated"
