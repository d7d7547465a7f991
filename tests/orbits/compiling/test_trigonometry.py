"""Vectorised sines and cosines against many digits."""

import mpmath
import numpy as np
import pytest

from orbits.compiling.trigonometry import PI_A, PI_B, PI_C, sines_cosines


def test_three_pieces_make_pi():
    with mpmath.workdps(50):
        assert abs(mpmath.mpf(PI_A) + mpmath.mpf(PI_B) + mpmath.mpf(PI_C) - mpmath.pi) < 1e-32
    for piece, bits in (
        (PI_A, 27),
        (PI_B, 56),
    ):  # short enough for exact products with whole numbers up to 2^24
        assert (piece * 2.0**bits).is_integer() and piece * 2.0**bits < 2.0**29


@pytest.mark.parametrize("span", [1e-8, 4.0, 1e4, 5e7])
def test_against_many_digits(span):
    phases = np.random.default_rng(int(span)).uniform(-span, span, 2 * 401)
    phases[0] = 0.0
    sines, cosines = np.zeros(402), np.zeros(402)
    sines_cosines(phases, 2, 401, sines, cosines)
    with mpmath.workdps(40):
        for x, s, c in zip(phases[::2].tolist(), sines.tolist(), cosines.tolist()):
            assert abs(mpmath.sin(x) - s) < 4.5e-16 and abs(mpmath.cos(x) - c) < 4.5e-16
    assert sines[0] == 0.0 and cosines[0] == 1.0
