"""The oscillator's motion in closed form, against its equation of motion in forty digits."""

import mpmath as mp
import pytest

from orbits.machines.coupled import flow

OMEGA, ALPHA, BETA = 1.07, 0.03, 0.98
START = (0.21, -0.34, 0.55, 0.17)  # harmonic h and its rate, oscillation z and its rate


def plain(name):
    function = getattr(flow, name)
    return getattr(function, "py_func", function)


def exact(order, tau):
    """Derivatives of h and z with respect to tau: h'' = -Omega^2 h, z'' = -2 alpha z' - (alpha^2 + beta^2) z."""
    h0, h1, z0, z1 = (mp.mpf(x) for x in START)
    W, a, b = mp.mpf(OMEGA), mp.mpf(ALPHA), mp.mpf(BETA)
    h = mp.matrix([[0, 1], [-W * W, 0]])
    z = mp.matrix([[0, 1], [-a * a - b * b, -2 * a]])
    at = mp.expm(h * tau) * mp.matrix([h0, h1]), mp.expm(z * tau) * mp.matrix([z0, z1])
    return [((m**order) * x)[0] for m, x in zip((h, z), at)]


@pytest.mark.parametrize("tau", [1e-7, 1e-4, 0.004, 0.0299, 0.0301, 0.4, 3.0])
def test_small_differences_keep_their_digits(tau):
    """Close to the start of a leg from Taylor series, further on from the closed form: the same motion."""
    found = plain("ahead")(tau, *START, OMEGA, ALPHA, BETA)
    with mp.workdps(40):
        t = mp.mpf(tau)
        way = sum(exact(0, t)) - sum(exact(0, 0))
        rate = sum(exact(1, t)) - sum(exact(1, 0))
        wanted = [way, rate, *exact(2, t), *exact(3, t)]
        near = [1e-14, 1e-14, 1e-13, 1e-13, 1e-10, 1e-10]  # a series of order 8 has fewer terms left for them
        for value, w, relative in zip(found, wanted, near):
            assert abs(value - w) < (relative * abs(w) if tau < 0.03 else 1e-14)


@pytest.mark.parametrize("tau", [0.01, 0.7, 5.0])
def test_the_transition_matrix_is_the_exponential(tau):
    with mp.workdps(30):
        a, b = mp.mpf(ALPHA), mp.mpf(BETA)
        matrix = mp.expm(mp.matrix([[0, 1], [-a * a - b * b, -2 * a]]) * mp.mpf(tau))
    assert plain("transition")(ALPHA, BETA, tau)[:4] == pytest.approx([float(x) for x in matrix], rel=1e-14)


@pytest.mark.parametrize("excitation", [0.0, 0.4, 1.0])
def test_the_response_solves_the_forced_oscillator(excitation):
    """K X - c Y = f and c X + K Y = chi f c for q = X sin Psi + Y cos Psi, drag c, and f (sin + chi c cos) on the right."""
    force, drag, stiffness = 0.31, 0.12, -0.45
    X, Y = plain("harmonic")(force, excitation, drag, stiffness)
    assert stiffness * X - drag * Y == pytest.approx(force, rel=1e-14)
    assert drag * X + stiffness * Y == pytest.approx(excitation * drag * force, abs=1e-15)


def test_a_wave_and_its_derivatives():
    numbers = {"Omega": OMEGA, "alpha": ALPHA, "beta": BETA}
    P, Q, A, B, phase = 0.3, -0.2, 0.5, 0.1, 0.8

    def value(t):
        psi = phase + mp.mpf(OMEGA) * t
        free = A * mp.cos(mp.mpf(BETA) * t) + B * mp.sin(mp.mpf(BETA) * t)
        return 1.5 + P * mp.sin(psi) + Q * mp.cos(psi) + mp.exp(-mp.mpf(ALPHA) * t) * free

    found = plain("wave")(1.5, P, Q, A, B, OMEGA, ALPHA, BETA, phase, 1.3)
    with mp.workdps(30):
        assert found == pytest.approx(
            [float(value(mp.mpf(1.3))), float(mp.diff(value, mp.mpf(1.3)))], rel=1e-13
        )
        once = plain("derivative")(OMEGA, ALPHA, BETA, P, Q, A, B)
        again = plain("wave")(0.0, *once, *numbers.values(), phase, 1.3)
        assert again[0] == pytest.approx(float(mp.diff(value, mp.mpf(1.3))), rel=1e-13)
        assert again[1] == pytest.approx(float(mp.diff(value, mp.mpf(1.3), 2)), rel=1e-13)


@pytest.mark.parametrize(("y", "rate"), [(0.3, 0.2), (0.3, -0.2), (1e-9, -1e-3), (0.5, 0.0)])
def test_the_certain_time_is_the_first_zero_of_the_worst_parabola(y, rate):
    """y + y' h - bound h^2/2 = 0 at h > 0."""
    h = plain("certain")(y, rate, 0.7)
    assert h > 0.0 and y + rate * h - 0.35 * h * h == pytest.approx(0.0, abs=1e-15)


def test_damped_and_overdamped():
    alpha, beta = plain("rates")(1.3, 0.4)
    assert 1.3 * (alpha**2 + beta**2) == pytest.approx(1.0) and 2.0 * 1.3 * alpha == pytest.approx(0.4)
    assert plain("rates")(1.0, 2.1)[1] != plain("rates")(1.0, 2.1)[1]  # not a number


def test_the_start_of_an_oscillation():
    A, B = plain("oscillation")(ALPHA, BETA, 0.3, -0.2)
    assert A == 0.3 and pytest.approx(-0.2) == BETA * B - ALPHA * A


@pytest.mark.parametrize("mode", [-1.0, 0.0, 1.0])
def test_a_leg_starts_at_its_state_with_the_acceleration_of_newton(mode):
    """(1 + eps [stuck]) q1'' = -q1 - eps lambda q1' + eps G (sin Psi + chi eps lambda Omega cos Psi) - eps s mu g."""
    G, Omega, lam, eps, mu, g, chi = 2.1, 0.97, 0.8, 0.15, 0.4, 0.3, 0.6
    params = [G, Omega, lam, eps, 0.7, mu, g, chi]
    psi, w, rate, v, v_rate = 0.9, 0.25, 0.4 * mode, 0.3, -0.2
    h0, h1, z0, z1, alpha, beta, q2_rate, pull = plain("leg")(
        [psi, w, rate, mode, 0.0, 0.0, v, v_rate], params
    )
    q1, q1_rate = (v + eps * w) / (1 + eps), (v_rate + eps * rate) / (1 + eps)
    offset = -eps * mode * mu * g
    assert h0 + z0 + offset == pytest.approx(q1, abs=1e-15) and h1 + z1 == pytest.approx(q1_rate, abs=1e-15)
    assert q2_rate == pytest.approx((v_rate - rate) / (1 + eps)) and pull == pytest.approx(mode * mu * g)
    acceleration = -(Omega**2) * h0 - 2 * alpha * z1 - (alpha**2 + beta**2) * z0
    base = mp.sin(psi) + chi * eps * lam * Omega * mp.cos(psi)
    right = -q1 - eps * lam * q1_rate + eps * G * base - eps * mode * mu * g
    assert acceleration * (1.0 if mode else 1.0 + eps) == pytest.approx(float(right), abs=1e-14)
