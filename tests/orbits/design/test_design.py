"""Design figures against formulas with units, simulated motions, the linear oscillator by hand, and each other."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from orbits import Absorber
from orbits.attractors import find_attractor
from orbits.design import Design
from orbits.theory.multiple_scales import SlowFlow, damping_ratio

DESIGN = Design(
    half_width=0.02, natural_frequency=7.0, restitution=0.6, friction=0.3, mass_ratio=0.2, damping=0.9
)
RATE = 2.0 * math.pi * 7.0


@settings(max_examples=40, deadline=None)
@given(
    b=st.floats(0.005, 0.05), f0=st.floats(2, 20), r=st.floats(0.3, 0.99), mu=st.floats(0.0, 0.6)
)  # fmt: skip
def test_bounds_in_metres_are_the_published_formulas(b, f0, r, mu):
    """Youssef, Karoui, Leine: q1_min and q1_max in physical units (mass ratio left out there)."""
    machine = Design(cavity=b, natural_frequency=f0, restitution=r, friction=mu, mass_ratio=0.0)
    R, m = (1 - r) / (1 + r), mu * 9.81 / (b * (2 * np.pi * f0) ** 2)
    lower = b * (m * np.pi**2 / 2 + 2 * R) / np.sqrt(np.pi**2 + 4 * R**2)
    sides = R * m * np.pi / 2 - 2 / np.pi, R - m * (R**2 + 1 - np.pi**2 / 4)
    upper = 2 * np.pi * b / (np.pi**2 - 4) * np.hypot(*sides)
    found = machine.activation_threshold, machine.upper_bound, machine.operating_ratio
    assert found == pytest.approx((lower, upper, upper / lower), rel=1e-12)


def test_a_design_map_is_one_call():
    mu, b = np.linspace(0, 0.6, 7), np.linspace(0.01, 0.03, 5)
    whole = Design(friction=mu[None, :], cavity=b[:, None])
    for quantity in ("activation_threshold", "upper_bound", "operating_ratio"):
        grid = getattr(whole, quantity)
        assert grid.shape == (5, 7)
        assert grid[3, 2] == pytest.approx(getattr(Design(friction=mu[2], cavity=b[3]), quantity), rel=1e-14)
    assert np.all(np.diff(whole.operating_ratio, axis=1) < 0)  # friction narrows the working range


def test_friction_holds_up_to_its_acceleration():
    """q omega^2 = mu g; stuck is below stick-slip is below sliding."""
    for frequency in (3.0, 7.0):
        limit = 0.3 * 9.81 / (2.0 * math.pi * frequency) ** 2
        assert DESIGN.sticking_limit(frequency) == pytest.approx(limit, rel=1e-12)
        per_base = DESIGN.linear_response(frequency, 1.0, stuck=True)
        assert DESIGN.is_stuck(frequency, 0.999 * limit / per_base)
        assert not DESIGN.is_stuck(frequency, 1.001 * limit / per_base)
    machine = Design(friction=np.linspace(0.05, 1, 20))
    low, high = machine.sliding_bounds
    assert np.all(machine.sticking_limit() < low) and np.all(low < high)


@pytest.mark.parametrize("ratio", [0.963, 1.0, 1.04])
def test_sliding_bounds_by_simulation_at_other_frequencies(ratio):
    """Just above the lower bound the simulated absorber slides and turns, just below it sticks at each turn; at the upper one it turns at the walls."""
    design = Design()
    low, high = design.sliding_bounds_at(ratio * design.natural_frequency)
    machine = Absorber(
        restitution=design.restitution, friction=design.friction, gravity=design.gravity, mass_ratio=0.006,
        frequency=ratio,
    )  # fmt: skip
    for displacement, letters in ((0.999 * low, "su"), (1.001 * low, "t")):
        seen = find_attractor(machine, amplitude=displacement * 1.006 / design.cavity)
        assert set(seen.letters) == set(letters)
    highest = machine.orbit("tt", amplitude=high * 1.006 / design.cavity)
    assert np.abs(highest.nodes[:, 1]) == pytest.approx(1.0, abs=1e-12)


@pytest.mark.parametrize("stuck", [False, True])
@pytest.mark.parametrize("frequency", [3.0, 6.5, 7.0, 9.0])
def test_the_linear_response_is_that_of_mass_spring_and_damper(frequency, stuck):
    """(k + i omega c) E = (k - (M + m) omega^2 + i omega c) q with the absorber stuck, without m otherwise; M = 1."""
    omega = 2.0 * math.pi * frequency
    path = RATE**2 + 1j * omega * 0.2 * 0.9 * RATE
    expected = abs(0.001 * path / (path - (1.2 if stuck else 1.0) * omega**2))
    assert DESIGN.linear_response(frequency, 0.001, stuck=stuck) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("restitution", [0.1, 0.6, 0.95])
def test_damping_by_impacts_is_what_the_slow_flow_loses_at_large_amplitude(restitution):
    flow = SlowFlow(restitution=restitution, friction=0.0, damping=0.0, mass_ratio=0.006)
    design = DESIGN.with_(restitution=restitution, mass_ratio=0.006)
    assert design.absorber_damping == pytest.approx(damping_ratio(flow), rel=1e-12)


def test_scales_follow_from_dimensionless_gravity():
    assert DESIGN.gravity == pytest.approx(9.81 / (0.02 * RATE**2), rel=1e-12)
    assert DESIGN.level == pytest.approx(0.5 * math.pi * 1.2 * 0.3 * DESIGN.gravity)
    assert (DESIGN.loss, DESIGN.excitation(3.0)) == pytest.approx((0.25, 3.0 * 0.02 * 0.2))
    machine = Design.from_dimensionless(gravity=0.211, cavity=0.02)
    assert machine.gravity == pytest.approx(0.211, rel=1e-12)
    assert machine.natural_frequency == pytest.approx(7.666, rel=2e-3)
    back = Design.from_dimensionless(gravity=0.211, natural_frequency=machine.natural_frequency)
    assert back.cavity == pytest.approx(0.02, rel=1e-12)
    with pytest.raises(ValueError, match="exactly one"):
        Design.from_dimensionless(gravity=0.2)
