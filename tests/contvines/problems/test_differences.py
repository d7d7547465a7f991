"""Differences and noise, against known functions."""

import numpy as np
import pytest

from contvines.problems.differences import bend, central, noise_of


def test_the_difference_is_of_sixth_order():
    """Of sin at 1: the error falls by 2^6 with the step."""
    errors = []
    for h in (0.4, 0.2, 0.1):
        found = central(lambda t: np.array([np.sin(1.0 + t)]), h)
        errors.append(abs(found.value[0] - np.cos(1.0)))
    assert errors[0] / errors[1] == pytest.approx(64.0, rel=0.1)
    assert errors[1] / errors[2] == pytest.approx(64.0, rel=0.1)


@pytest.mark.parametrize("size", [1e-6, 1e-9])
def test_noise_is_its_standard_deviation(size):
    draw = np.random.default_rng(3)
    found = [
        noise_of(lambda t: np.array([np.sin(t)]) + size * draw.standard_normal(1), 1e-6)[0] for _ in range(20)
    ]
    assert np.median(found) == pytest.approx(size, rel=0.5)


@pytest.mark.parametrize("rows", [100, 1000])
def test_a_bend_of_many_rows_takes_as_many_evaluations_as_one_of_few(rows):
    """Row r bends over r lengths of 3: sin(t/3 r). The first one, which is the shortest, tells; the others need not be asked."""
    calls, lengths = 0, 3.0 * np.arange(1, rows + 1)

    def f(t):
        nonlocal calls
        calls += 1
        return np.sin(t / lengths)

    found = bend(f, 1.0)
    assert 1.0 < found < 9.0
    assert calls < 300
