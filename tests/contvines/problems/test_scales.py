"""Sizes of many unknowns."""

import numpy as np
import pytest

from contvines.problems.scales import in_fields


def test_fields_of_unlike_sizes_keep_their_sizes():
    small, large = np.linspace(1.0, 9.0, 15), np.linspace(1e4, 9e4, 15)
    mixed = np.ravel(np.column_stack([small, large]))
    found = in_fields(mixed)
    assert found[::2] == pytest.approx(np.full(15, np.sqrt((small**2).mean())))
    assert found[1::2] == pytest.approx(np.full(15, np.sqrt((large**2).mean())))
