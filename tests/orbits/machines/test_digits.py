"""Arithmetic that keeps its digits, against forty digits."""

import mpmath as mp
import pytest

from orbits.machines.reference.stepper import shift, wrap


@pytest.mark.parametrize("angle", [0.3, -0.3, 6.0, 7.0, 700.0, -700.0, -1e-18])
def test_wrapped_angles_are_the_same_angle(angle):
    reduced, turns = wrap(angle)
    assert 0.0 <= reduced < 6.283185307179586
    assert abs(mp.mpf(reduced) + 2 * mp.pi * int(turns) - mp.mpf(angle)) < 1e-12


def test_a_sum_of_two_floats_keeps_what_one_would_lose():
    w, low = 1.0, 0.0
    with mp.workdps(40):
        exact = mp.mpf(1)
        for step in (1e-17, 3e-9, -1e-20, 0.7, -1.1e-12, 2e-17, -0.6):
            w, low = shift(w, low, step)
            exact += mp.mpf(step)
            assert abs(mp.mpf(w) + mp.mpf(low) - exact) < 1e-31
