"""Design figures against formulas with units, integrated equations of motion and each other."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from orbits import Absorber
from orbits.attractors import find_attractor
from orbits.design import Design


@settings(max_examples=40, deadline=None)
@given(
    b=st.floats(0.005, 0.05), f0=st.floats(2, 20), r=st.floats(0.3, 0.99), mu=st.floats(0.0, 0.6)
)  # fmt: skip
def test_bounds_in_metres_are_the_published_formulas(b, f0, r, mu):
    """Youssef, Karoui, Leine: q1_min and q1_max in physical units (mass ratio left out there)."""
    machine = Design(cavity=b, natural_frequency=f0, restitution=r, friction=mu, mass_ratio=0.0)
    R, g, w2 = (1 - r) / (1 + r), 9.81, (2 * np.pi * f0) ** 2
    root = np.sqrt(np.pi**2 + 4 * R**2)
    assert machine.activation_threshold == pytest.approx(
        mu * np.pi**2 * g / (2 * w2 * root) + 2 * b * R / root, rel=1e-12
    )
    m = mu * g / (b * w2)
    upper = (
        2
        * np.pi
        * b
        / (np.pi**2 - 4)
        * np.hypot(R * m * np.pi / 2 - 2 / np.pi, R - m * (R**2 + 1 - np.pi**2 / 4))
    )
    assert machine.upper_bound == pytest.approx(upper, rel=1e-12)
    assert machine.operating_ratio == pytest.approx(upper / machine.activation_threshold, rel=1e-12)


def test_a_design_map_is_one_call():
    mu, b = np.linspace(0, 0.6, 7), np.linspace(0.01, 0.03, 5)
    whole = Design(friction=mu[None, :], cavity=b[:, None])
    for quantity in ("activation_threshold", "upper_bound", "operating_ratio"):
        grid = getattr(whole, quantity)
        assert grid.shape == (5, 7)
        assert grid[3, 2] == pytest.approx(getattr(Design(friction=mu[2], cavity=b[3]), quantity), rel=1e-14)
    assert np.all(np.diff(whole.operating_ratio, axis=1) < 0)  # friction narrows the working range
    assert whole.sticking_limit().shape == (7,) or whole.sticking_limit().shape == (1, 7)


def test_stuck_absorber_is_held_by_friction_just_so():
    machine = Design()
    f = 7.25
    limit = machine.sticking_limit(f)
    assert machine.friction * 9.81 == pytest.approx((2 * np.pi * f) ** 2 * limit, rel=1e-12)
    assert machine.is_stuck(f, 0.999 * limit / machine.linear_response(f, 1.0, stuck=True))
    assert not machine.is_stuck(f, 1.001 * limit / machine.linear_response(f, 1.0, stuck=True))


def test_stuck_is_below_stick_slip_is_below_sliding():
    machine = Design(friction=np.linspace(0.05, 1, 20))
    low, high = machine.sliding_bounds
    assert np.all(machine.sticking_limit() < low) and np.all(low < high)


@pytest.mark.parametrize("ratio", [0.963, 1.0, 1.04])
def test_sliding_bounds_by_simulation_at_other_frequencies(ratio):
    """Just inside the bounds the simulated absorber slides and turns; just below it sticks at each turn, just above it hits."""
    design = Design()
    low, high = design.sliding_bounds_at(ratio * design.natural_frequency)
    machine = Absorber(
        restitution=design.restitution,
        friction=design.friction,
        gravity=design.gravity,
        mass_ratio=0.006,
        frequency=ratio,
    )
    for displacement, letters in ((0.999 * low, "su"), (1.001 * low, "t")):
        seen = find_attractor(machine, amplitude=displacement * 1.006 / design.cavity)
        assert set(seen.letters) == set(letters)
    for displacement, stroke in ((0.9999 * high, "below"), (1.0001 * high, "above")):
        orbit = machine.orbit("tt", amplitude=displacement * 1.006 / design.cavity)
        widest = np.abs(orbit.sample(2000)["w"]).max()
        assert widest == pytest.approx(1.0, abs=1e-3)
        assert (widest < 1.0) == (stroke == "below")


def test_scales_follow_from_dimensionless_gravity():
    machine = Design.from_dimensionless(gravity=0.211, cavity=0.02)
    assert machine.gravity == pytest.approx(0.211, rel=1e-12)
    assert machine.natural_frequency == pytest.approx(7.666, rel=2e-3)
    assert Design.from_dimensionless(gravity=0.211, natural_frequency=7.666).cavity == pytest.approx(
        0.02, rel=3e-3
    )
    with pytest.raises(ValueError, match="exactly one"):
        Design.from_dimensionless(gravity=0.2)
