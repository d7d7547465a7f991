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


def test_a_missing_forcing_is_named():
    machine = Coupled(restitution=0.7, friction=0.1, gravity=0.1, mass_ratio=0.01)
    with pytest.raises(ParameterError, match="forcing is missing"):
        machine.vector()
    assert machine.vector({"forcing": 2.0})[0] == 2.0
    assert machine.changed(excitation=0.0).excitation == "truncated"
