"""Differences and noise, against known functions."""

import numpy as np
import pytest

from contvines.problems.differences import central


def test_the_difference_is_of_sixth_order():
    """Of sin at 1: the error falls by 2^6 with the step."""
    errors = []
    for h in (0.4, 0.2, 0.1):
        found = central(lambda t: np.array([np.sin(1.0 + t)]), h)
        errors.append(abs(found.value[0] - np.cos(1.0)))
    assert errors[0] / errors[1] == pytest.approx(64.0, rel=0.1)
    assert errors[1] / errors[2] == pytest.approx(64.0, rel=0.1)
