"""The motion from a state on in closed form, against its equations of motion in forty digits."""

import mpmath as mp
import numpy as np
import pytest

from orbits.machines.reference.law import coupled
from orbits.machines.reference.oscillation import Oscillation, oscillation

OMEGA, ALPHA, BETA = 1.07, 0.03, 0.98
START = (0.21, -0.34, 0.55, 0.17)  # harmonic h and its rate, oscillation z and its rate
PARAMS = np.array([2.1, 0.97, 0.8, 0.15, 0.7, 0.4, 0.3, 0.6, 0.2])


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
    found = Oscillation(OMEGA, ALPHA, BETA, *START).at(tau)
    with mp.workdps(40):
        t = mp.mpf(tau)
        way = sum(exact(0, t)) - sum(exact(0, 0))
        rate = sum(exact(1, t)) - sum(exact(1, 0))
        wanted = [way, rate, rate / t, *exact(2, t), *exact(3, t)]
        near = [
            1e-14,
            1e-14,
            1e-14,
            1e-13,
            1e-13,
            1e-10,
            1e-10,
        ]  # a series of order 8 has fewer terms left for them
        for value, w, relative in zip(found, wanted, near):
            assert abs(value - w) < (relative * abs(w) if tau < 0.03 else 1e-14)


@pytest.mark.parametrize("mode", [-1.0, 0.0, 1.0])
def test_a_leg_starts_at_its_state_with_the_acceleration_of_newton(mode):
    """(1 + eps [stuck]) q1'' = -q1 - eps lambda q1' + eps G (sin Psi + chi eps lambda Omega cos Psi) - eps q2''; q2'' = s mu g cos(slope) + g sin(slope) [sliding]."""
    G, Omega, lam, eps, _, mu, g, chi, slope = PARAMS
    pull = mode * mu * g * np.cos(slope) + g * np.sin(slope) if mode else 0.0
    psi, w, rate, v, v_rate = 0.9, 0.25, 0.4 * mode, 0.3, -0.2
    q = oscillation(np.array([psi, w, rate, mode, 0.0, 0.0, v, v_rate]), coupled(PARAMS))
    q1, q1_rate = (v + eps * w) / (1 + eps), (v_rate + eps * rate) / (1 + eps)
    offset = -eps * pull
    assert q.h0 + q.z0 + offset == pytest.approx(q1, abs=1e-15)
    assert q.h1 + q.z1 == pytest.approx(q1_rate, abs=1e-15)
    assert q.q2_rate == pytest.approx((v_rate - rate) / (1 + eps)) and q.q2_pull == pytest.approx(pull)
    acceleration = -(Omega**2) * q.h0 - 2 * q.alpha * q.z1 - q.kappa * q.z0
    base = mp.sin(psi) + chi * eps * lam * Omega * mp.cos(psi)
    right = -q1 - eps * lam * q1_rate + eps * G * base - eps * pull
    assert acceleration * (1.0 if mode else 1.0 + eps) == pytest.approx(float(right), abs=1e-14)
