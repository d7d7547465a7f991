"""Orbits of the coupled machine: closed forms, limits, margins, measures."""

import numpy as np
import pytest

from orbits.machines.coupled_orbits import stuck_frequencies, stuck_response
from tests.machines import COUPLED


@pytest.mark.parametrize("frequency", [0.975, 0.985, 1.003, 1.02])
@pytest.mark.parametrize("fast", [True, False])
def test_closed_symmetric_orbits_solve_the_maps(frequency, fast):
    """The closed form was derived from the half-wave symmetry, the maps from the flow: they must meet."""
    orbit = COUPLED.symmetric_orbit(fast=fast, frequency=frequency)
    assert orbit.residual < 1e-14
    assert orbit.symmetric
    if orbit.real:
        assert orbit.replay() < 1e-12


@pytest.mark.parametrize("frequency", [0.97, 0.985, 1.02])
def test_closed_sliding_orbits_solve_the_maps(frequency):
    orbit = COUPLED.sliding_orbit(frequency=frequency)
    assert orbit.residual < 1e-14
    assert orbit.word.text == "tt"
    assert orbit.real and orbit.stable
    assert len(orbit.multipliers) == 3  # the fourth is the shift of the absorber, exactly +1


@pytest.mark.parametrize("excitation", ["exact", "truncated"])
def test_stuck_response_slips_at_its_frequencies(excitation):
    params = COUPLED.changed(excitation=excitation).vector()
    for frequency in stuck_frequencies(params):
        params[1] = frequency
        found = stuck_response(params)
        assert abs(found.reserve) < 1e-9 * max(1.0, found.shaking)
    assert COUPLED.changed(forcing=0.5, frequency=0.9, excitation=excitation).stuck_response().real
    # the lower one lies below the resonance of the joined masses, the next above it
    low, high = stuck_frequencies(params)[:2]
    assert low < 1 / np.sqrt(1.006) < high


@pytest.mark.parametrize(
    ("word", "frequency"), [("LR", 0.985), ("tt", 0.975), ("susu", 0.95), ("LRtt", 0.99), ("LRtR", 1.0)]
)
def test_measures_against_quadrature_and_the_balance_of_energy(word, frequency):
    orbit = COUPLED.orbit(word, frequency=frequency)
    found = orbit.measures()
    lost = found["damping_loss"] + found["impact_loss"] + found["friction_loss"]
    assert found["input_work"] == pytest.approx(lost, rel=1e-10)
    grounded = found["grounded_damping_loss"] - found["damping_loss"]
    assert found["force_work"] - found["input_work"] == pytest.approx(grounded, rel=1e-9)
    doubled = orbit.repeat(2).measures("input_work", "input_work_mean", "damping_loss_mean")
    expected = {name: found[name.removesuffix("_mean")] for name in doubled}
    expected["input_work"] *= 2
    assert doubled == pytest.approx(expected, rel=1e-9)
    points = orbit.sample(20000)
    assert found["max_abs_q1"] == pytest.approx(np.abs(points["cavity"]).max(), abs=1e-6)
    sine, cosine = (
        np.trapezoid(points["v"] * wave(points["phase"]), points["phase"]) / np.pi
        for wave in (np.sin, np.cos)
    )
    assert found["C2"] == pytest.approx(sine**2 + cosine**2, abs=1e-6)
    assert found["amplitude"] ** 2 == pytest.approx(found["C2"], rel=1e-13)
    assert np.tan(found["v_phase"]) == pytest.approx(cosine / sine, abs=1e-5)
    image = orbit.mirror()  # the same orbit
    assert image.residual < 1e-11
    assert np.sort(np.abs(image.multipliers)) == pytest.approx(np.sort(np.abs(orbit.multipliers)), rel=1e-8)
    assert image.measure("max_abs_q1") == pytest.approx(found["max_abs_q1"], rel=1e-12)


def test_friction_that_vanishes_leaves_the_frictionless_orbit():
    """friction -> 0 with words that have no turns: the same nodes from both descriptions."""
    nodes = [COUPLED.changed(friction=mu).symmetric_orbit(frequency=0.985).nodes for mu in (0.0, 1e-9)]
    np.testing.assert_allclose(nodes[0], nodes[1], atol=1e-7)
    assert COUPLED.changed(friction=0.0).symmetric_orbit(frequency=0.985).word.frictionless
