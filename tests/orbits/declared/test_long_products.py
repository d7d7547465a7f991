"""Multipliers of long chains of flights, whose product is too uneven to be trusted."""

import mpmath
import numpy as np
import pytest

from orbits.flows.page.cycle_equations import _periodic


@pytest.mark.parametrize("size", [1, 3, 5])
def test_against_eigenvalues_of_the_product_in_eighty_digits(size):
    chain = 10.0 * np.random.default_rng(size).normal(size=(24, size, size))
    with mpmath.workdps(80):
        product = mpmath.eye(size)
        for factor in chain:
            product = mpmath.matrix(factor.tolist()) * product
        exact = mpmath.eig(product, left=False, right=False) if size > 1 else [product[0, 0]]
        expected = [complex(value) for value in exact]
    found = _periodic(chain, size)
    assert len(found) == size
    for value in expected:
        assert np.abs(found - value).min() < 1e-12 * abs(value)
