"""All real roots in an interval, double ones and those at its ends included."""

import numpy as np
import pytest

from orbits.theory.multiple_scales.polynomials import real_roots, root_bound


@pytest.mark.parametrize(
    ("roots", "inside"),
    [
        ([1.0, 1.0, 2.0], [1.0, 2.0]),
        ([0.5, 0.5], [0.5]),
        ([0.0, 1.5, 3.0], [0.0, 1.5, 3.0]),
        ([-1.0, 1.0, 4.0], [1.0]),
        ([0.25, 0.5, 1.0, 2.0], [0.25, 0.5, 1.0, 2.0]),
        ([5.0], []),
    ],
)
def test_roots_of_products(roots, inside):
    found = real_roots(np.poly(roots), 0.0, 3.0)
    assert found[np.isfinite(found)] == pytest.approx(inside, abs=1e-7)


def test_no_root_lies_beyond_the_bound():
    draw = np.random.default_rng(2)
    for degree in range(1, 6):
        c = draw.normal(size=(50, degree + 1))
        for row, bound in zip(c, root_bound(c)):
            assert np.abs(np.roots(row)).max() <= bound
    assert root_bound([0.0, 1.0, -2.0]) >= 2.0  # a leading coefficient that vanishes
