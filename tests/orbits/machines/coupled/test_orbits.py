"""Orbits of the coupled machine: closed forms, limits, margins, measures."""

import numpy as np
import pytest
from scipy.integrate import quad, romb

from orbits.machines.closed_forms.absorber import symmetric_square
from orbits.machines.closed_forms.coupled import response, stuck_frequencies, stuck_response
from orbits.machines.reference.machine import reference
from tests.machines import COUPLED
from tests.orbits.machines.coupled.motion import path


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


def test_small_mass_ratio_recovers_the_reduced_machine():
    """C^2 of v against the exact symmetric orbit of a cavity shaken harmonically, with the same velocity: order eps."""
    R = (1 - 0.76) / (1 + 0.76)
    gaps = []
    for eps in (4e-3, 2e-3, 1e-3, 5e-4):
        machine = COUPLED.changed(mass_ratio=eps, frequency=1.0 - 2.58 * eps)
        orbit = machine.symmetric_orbit()
        a, Omega = machine.friction_acceleration(orbit.params), orbit.params[1]
        # B+ = Omega (beta + H), the velocity after an impact
        beta = orbit.measure("B_post") / Omega - 0.5 * np.pi * a / Omega**2
        gaps.append(abs(orbit.measure("C2") - float(symmetric_square(beta, R, 0.5 * np.pi * a / Omega**2))))
    orders = np.log2(np.array(gaps[:-1]) / np.array(gaps[1:]))
    assert np.all(np.abs(orders - 1.0) < 0.05)


def test_stuck_response_is_the_textbook_oscillator():
    """Transmissibility of a damped oscillator on a moving base: zeta = c/(2 sqrt(k (M + m)))."""
    machine = COUPLED.changed(forcing=0.5, frequency=0.93, damping=3.0)
    mass = 1.006
    ratio = 0.93 * np.sqrt(mass)
    zeta = 0.5 * 3.0 * 0.006 / np.sqrt(mass)
    expected = (
        0.5 * 0.006 * np.sqrt((1 + (2 * zeta * ratio) ** 2) / ((1 - ratio**2) ** 2 + (2 * zeta * ratio) ** 2))
    )
    found = machine.stuck_response()
    assert found.amplitude == pytest.approx(expected, rel=1e-13)
    assert found.reserve == pytest.approx(mass * (0.5 * 0.211 - 0.93**2 * expected), rel=1e-12)
    X, _ = response(machine.changed(excitation="truncated", damping=0.0).vector())
    np.testing.assert_allclose(X, 0.5 * 0.006 / (1 - 0.93**2), rtol=1e-13)


@pytest.mark.parametrize("excitation", ["exact", "truncated"])
def test_stuck_response_slips_at_its_frequencies(excitation):
    params = COUPLED.changed(excitation=excitation).vector()
    for frequency in stuck_frequencies(params):
        params[1] = frequency
        found = stuck_response(params)
        assert abs(found.reserve) < 1e-9 * max(1.0, found.shaking)
    # the lower one lies below the resonance of the joined masses, the next above it
    low, high = stuck_frequencies(params)[:2]
    assert low < 1 / np.sqrt(1.006) < high


@pytest.mark.parametrize("word", ["LR", "tt", "susu", "LRtt", "LRtR"])
def test_measures_against_quadrature_and_the_balance_of_energy(word):
    frequency = {"LR": 0.985, "tt": 0.975, "susu": 0.95, "LRtt": 0.99, "LRtR": 1.0}[word]
    machine = COUPLED.changed(frequency=frequency, damping=1.0)
    orbit = machine.orbit(word)
    found = orbit.measures()
    lost = found["damping_loss"] + found["impact_loss"] + found["friction_loss"]
    assert found["input_work"] == pytest.approx(lost, rel=1e-10)
    assert found["force_work"] - found["input_work"] == pytest.approx(
        found["grounded_damping_loss"] - found["damping_loss"], rel=1e-9
    )
    doubled = orbit.repeat(2).measures("input_work", "input_work_mean", "damping_loss_mean")
    assert doubled["input_work"] == pytest.approx(2 * found["input_work"], rel=1e-9)
    assert doubled["input_work_mean"] == pytest.approx(found["input_work"], rel=1e-9)
    assert doubled["damping_loss_mean"] == pytest.approx(found["damping_loss"], rel=1e-9)
    points = orbit.sample(20000)
    assert found["max_abs_q1"] == pytest.approx(np.abs(points["cavity"]).max(), abs=1e-6)
    sine = np.trapezoid(points["v"] * np.sin(points["phase"]), points["phase"]) / np.pi
    cosine = np.trapezoid(points["v"] * np.cos(points["phase"]), points["phase"]) / np.pi
    assert found["C2"] == pytest.approx(sine**2 + cosine**2, abs=1e-6)
    assert found["amplitude"] ** 2 == pytest.approx(found["C2"], rel=1e-13)
    assert np.tan(found["v_phase"]) == pytest.approx(cosine / sine, abs=1e-5)


@pytest.mark.parametrize(
    ("word", "frequency", "damping"),
    [("LR", 0.985, 1.0), ("tt", 0.975, 1.0), ("susu", 0.95, 1.0), ("tt", 0.9, 30.0), ("LR", 1.02, 30.0)],
)
def test_the_first_harmonic_is_that_of_the_motion_by_matrix_exponentials(word, frequency, damping):
    """C sin(Psi + phase) of v = q1 + eps q2, integrated by Romberg's method; an orbit written twice over, as well."""
    machine = COUPLED.changed(frequency=frequency, damping=damping, forcing=2.47 if damping == 1.0 else 40.0)
    orbit = machine.orbit(word)
    parts = np.zeros(2)
    for i, duration in enumerate(orbit.durations / frequency):
        events, node = orbit.events, orbit.nodes[i]
        mode = orbit.word.modes[i]
        rate = events.rate_post[i] if mode else 0.0
        states, _, _ = path(
            orbit.params, mode, node[0], events.w[i], rate, events.v[i], events.v_rate[i], duration, 256
        )
        v = states[:, 0] + orbit.params[3] * states[:, 2]
        step = duration * frequency / 256
        parts += [romb(v * states[:, 4], step), romb(v * states[:, 5], step)]
    sine, cosine = parts / np.pi
    for found in (orbit.measures(), orbit.repeat(2).measures("amplitude", "v_phase")):
        assert found["amplitude"] == pytest.approx(np.hypot(sine, cosine), rel=1e-12)
        assert found["v_phase"] == pytest.approx(np.arctan2(cosine, sine), abs=1e-12)


@pytest.mark.parametrize("frequency", [0.3, 1.0, 3.0])
def test_integrals_over_a_whole_turn_are_exact(frequency):
    """Sixteen points of Gauss: of every flight that lasts a turn, of the forcing or of the oscillator, cut anywhere into two."""
    machine = COUPLED.changed(frequency=frequency)
    params = machine.vector({})
    state = np.array([[0.3, 0.1, 0.0, 0.0, 0.0, 0.0, 0.7, -0.4]])
    length = 2.0 * np.pi * max(1.0, frequency) * 0.999
    whole, first, second = (np.empty((1, 4)) for _ in range(3))
    reference("coupled").shapes(state, params, np.array([length]), whole)
    reference("coupled").shapes(state, params, np.array([0.37 * length]), first)
    states, _, _ = path(params, 0, 0.3, 0.1, 0.0, 0.7, -0.4, 0.37 * length / frequency, 1)
    q1, p1, q2, p2 = states[-1, :4]
    eps = params[3]
    later = np.array([[0.3 + 0.37 * length, q1 - q2, 0.0, 0.0, 0.0, 0.0, q1 + eps * q2, p1 + eps * p2]])
    reference("coupled").shapes(later, params, np.array([0.63 * length]), second)
    assert whole[0, 1:] == pytest.approx(first[0, 1:] + second[0, 1:], abs=1e-13)


def test_a_flight_s_margin_is_its_slowest_moment():
    """Against fine sampling of the flight, on orbits whose flights slow down inside."""
    for frequency in (0.987, 0.988, 1.0035, 1.004):
        orbit = COUPLED.symmetric_orbit(frequency=frequency)
        flights = [m.value for m in orbit.margins if m.kind == "flight"]
        points = orbit.sample(40000)
        for segment, mode in enumerate(orbit.word.modes):
            speed = mode * points["w_rate"][points["segment"] == segment]
            inner = speed[1:-1][(speed[1:-1] < speed[:-2]) & (speed[1:-1] < speed[2:])]
            if inner.size:
                assert min(abs(inner.min() - value) for value in flights) < 1e-6


def test_the_mirror_image_is_the_same_orbit():
    orbit = COUPLED.orbit("LRtR", frequency=1.0)
    image = orbit.mirror()
    assert image.residual < 1e-11
    np.testing.assert_allclose(
        np.sort(np.abs(image.multipliers)), np.sort(np.abs(orbit.multipliers)), rtol=1e-8
    )
    assert image.measure("max_abs_q1") == pytest.approx(orbit.measure("max_abs_q1"), rel=1e-12)


def test_friction_that_vanishes_leaves_the_frictionless_orbit():
    """friction -> 0 with words that have no turns: the same nodes from both descriptions."""
    nodes = [COUPLED.changed(friction=mu).symmetric_orbit(frequency=0.985).nodes for mu in (0.0, 1e-9)]
    np.testing.assert_allclose(nodes[0], nodes[1], atol=1e-7)
    assert COUPLED.changed(friction=0.0).symmetric_orbit(frequency=0.985).word.frictionless


def test_work_of_the_base_is_that_of_the_force():
    """Input of the sliding orbit: the integral of the force on q1 times q1', by adaptive quadrature."""
    orbit = COUPLED.sliding_orbit(frequency=0.975)
    points = orbit.sample(4000)
    rate = (points["v_rate"] + 0.006 * points["w_rate"]) / 1.006
    G, Omega, lam, eps = orbit.params[:4]

    def power(phase):
        force = G * (np.sin(phase) + eps * lam * Omega * np.cos(phase))
        return force * np.interp(phase, points["phase"], rate) / Omega

    start = points["phase"][0]
    whole = quad(power, start, start + 2 * np.pi, limit=400)[0]
    assert orbit.measure("force_work") == pytest.approx(whole, rel=1e-5)


@pytest.mark.parametrize("word", ["LR", "tt", "susu"])
@pytest.mark.parametrize("excitation", ["exact", "truncated"])
def test_the_damper_loses_by_the_motion_between_base_and_oscillator(word, excitation):
    """By quadrature of lambda (q1' - e')^2 over sampled motion, and of the base's force times its speed."""
    frequency = {"LR": 0.985, "tt": 0.975, "susu": 0.95}[word]
    orbit = COUPLED.changed(frequency=frequency, damping=1.3, excitation=excitation).orbit(word)
    G, Omega, lam, eps = orbit.params[:4]
    points = orbit.sample(40000)
    q1, rate = points["cavity"], (points["v_rate"] + eps * points["w_rate"]) / (1.0 + eps)
    e, e_rate = eps * G * np.sin(points["phase"]), eps * G * Omega * np.cos(points["phase"])
    found = orbit.measures("damping_loss", "input_work", "grounded_damping_loss")
    loss = lam * np.trapezoid((rate - e_rate) ** 2, points["tau"])
    ground = lam * np.trapezoid(rate**2, points["tau"])
    work = np.trapezoid(e_rate * (e - q1 + eps * lam * (e_rate - rate)), points["tau"]) / eps
    assert found["grounded_damping_loss"] == pytest.approx(ground, rel=1e-5)
    if excitation == "exact":
        assert found["damping_loss"] == pytest.approx(loss, rel=1e-5)
        assert found["input_work"] == pytest.approx(work, rel=1e-5)
    else:  # its equation is that of a machine on solid ground, driven by a force
        assert found["damping_loss"] == pytest.approx(ground, rel=1e-5)
