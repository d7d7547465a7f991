"""The motion from a state on in closed form, against its equations of motion in forty digits."""

import mpmath as mp
import pytest

from orbits.machines.reference.oscillation import Oscillation

OMEGA, ALPHA, BETA = 1.07, 0.03, 0.98
START = (0.21, -0.34, 0.55, 0.17)  # harmonic h and its rate, oscillation z and its rate


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
    found = Oscillation(OMEGA, ALPHA, BETA, *START, 0.0, 0.0).at(tau)
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
