"""Null vectors of a linearisation, closed and with the closure turned round, and what is left afterwards."""

import numpy as np
import pytest

import contvines as cv
from contvines.loci.linear import Linearisation


def test_a_flip_is_found_with_the_closure_turned_and_the_linearisation_stays():
    """(x, y) -> (-x + x y, p / 2 + y / 2 + x^2) has the multipliers -1 and 1/2 at the origin, p = 0."""
    problem = cv.MapProblem(
        lambda x, p: np.array([-x[0] + x[0] * x[1], 0.5 * (p + x[1]) + x[0] ** 2]), [0.0, 0.0], 0.0, scale=1.0
    )
    line = Linearisation(problem)
    line.at(np.zeros(2), 0.0)
    plain = problem.kernels.matrix(line.data, line.work).copy()
    found = line.null_vectors(flipped=True)
    assert abs(found.test) < 1e-9
    assert np.abs(found.right) == pytest.approx([1.0, 0.0], abs=1e-9)
    assert np.abs(found.column) == pytest.approx([1.0, 0.0], abs=1e-9)
    np.testing.assert_allclose(problem.kernels.matrix(line.data, line.work), plain)
    assert plain == pytest.approx(np.array([[-2.0, 0.0], [0.0, -0.5]]), abs=1e-9)
    assert abs(line.null_vectors().test) > 0.1  # +1 is no multiplier
