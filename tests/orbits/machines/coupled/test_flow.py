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
