"""The oscillator's motion in closed form, against its equation of motion in forty digits."""

import mpmath as mp
import pytest

from orbits.machines.coupled import flow

OMEGA, ALPHA, BETA = 1.07, 0.03, 0.98


def plain(name):
    return getattr(flow, name)


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
