"""Design figures by hand: the linear oscillator with and without the absorber's mass, what friction holds, what impacts damp."""

import math

import numpy as np
import pytest

from orbits.design import Design
from orbits.theory.multiple_scales import SlowFlow, damping_ratio

DESIGN = Design(
    half_width=0.02, natural_frequency=7.0, restitution=0.6, friction=0.3, mass_ratio=0.2, damping=0.9
)
RATE = 2.0 * math.pi * 7.0


@pytest.mark.parametrize("stuck", [False, True])
@pytest.mark.parametrize("frequency", [3.0, 6.5, 7.0, 9.0])
def test_the_linear_response_is_that_of_mass_spring_and_damper(frequency, stuck):
    """(k + i omega c) E = (k - (M + m) omega^2 + i omega c) q with the absorber stuck, without m otherwise; M = 1."""
    k, c, omega = RATE**2, 0.2 * 0.9 * RATE, 2.0 * math.pi * frequency
    path = k + 1j * omega * c
    expected = abs(0.001 * path / (path - (1.2 if stuck else 1.0) * omega**2))
    assert DESIGN.linear_response(frequency, 0.001, stuck=stuck) == pytest.approx(expected, rel=1e-12)


def test_friction_holds_up_to_its_acceleration():
    """q omega^2 = mu g."""
    for frequency in (3.0, 7.0):
        limit = 0.3 * 9.81 / (2.0 * math.pi * frequency) ** 2
        assert DESIGN.sticking_limit(frequency) == pytest.approx(limit)
        per_base = DESIGN.linear_response(frequency, 1.0, stuck=True)
        assert DESIGN.is_stuck(frequency, 0.999 * limit / per_base)
        assert not DESIGN.is_stuck(frequency, 1.001 * limit / per_base)


@pytest.mark.parametrize("restitution", [0.1, 0.6, 0.95])
def test_damping_by_impacts_is_what_the_slow_flow_loses_at_large_amplitude(restitution):
    flow = SlowFlow(restitution=restitution, friction=0.0, damping=0.0, mass_ratio=0.006)
    design = DESIGN.with_(restitution=restitution, mass_ratio=0.006)
    assert design.absorber_damping == pytest.approx(damping_ratio(flow), rel=1e-12)


def test_scales_and_numbers():
    assert DESIGN.gravity == pytest.approx(9.81 / (0.02 * RATE**2))
    assert DESIGN.level == pytest.approx(0.5 * math.pi * 1.2 * 0.3 * DESIGN.gravity)
    assert DESIGN.loss == pytest.approx(0.25)
    assert DESIGN.excitation(3.0) == pytest.approx(3.0 * 0.02 * 0.2)
    low, high = DESIGN.sliding_bounds_at(6.0)
    h = DESIGN.level * (7.0 / 6.0) ** 2
    assert (low, high) == pytest.approx(
        (0.02 / 1.2 * h * math.sqrt(1.0 + 4.0 / math.pi**2), 0.02 / 1.2 * math.hypot(1.0, h))
    )
    assert np.shape(DESIGN.with_(restitution=[0.5, 0.6]).upper_bound) == (2,)
