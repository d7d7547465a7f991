"""Arithmetic that keeps its digits, against forty digits."""

import mpmath as mp

from orbits.machines.reference.stepper import shift


def test_a_sum_of_two_floats_keeps_what_one_would_lose():
    w, low = 1.0, 0.0
    with mp.workdps(40):
        exact = mp.mpf(1)
        for step in (1e-17, 3e-9, -1e-20, 0.7, -1.1e-12, 2e-17, -0.6):
            w, low = shift(w, low, step)
            exact += mp.mpf(step)
            assert abs(mp.mpf(w) + mp.mpf(low) - exact) < 1e-31
