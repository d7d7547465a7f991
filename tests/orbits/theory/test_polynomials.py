"""All real roots in an interval, double ones and those at its ends included."""

import numpy as np
import pytest

from orbits.theory.multiple_scales.polynomials import real_roots, root_bound


@pytest.mark.parametrize(
    "roots",
    [[1.0, 1.0, 2.0], [0.5, 0.5], [0.0, 1.5, 3.0], [-1.0, 1.0, 4.0], [0.25, 0.5, 1.0, 2.0], [5.0]],
)
def test_roots_of_products(roots):
    found = real_roots(np.poly(roots), 0.0, 3.0)
    inside = sorted({root for root in roots if 0.0 <= root <= 3.0})
    assert found[np.isfinite(found)] == pytest.approx(inside, abs=1e-7)
    assert root_bound(np.poly(roots)) >= np.abs(roots).max()
    assert root_bound([0.0, *np.poly(roots)]) >= np.abs(roots).max()  # a leading coefficient that vanishes
