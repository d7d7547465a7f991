"""Conditions that pick one of a family of equivalent solutions."""

import numpy as np
import pytest

import contvines as cv


def rotating(u, p):
    """A circle of equilibria of radius sqrt(p) in (x, y), with z = p / 2: eigenvalues -2 p and -2, beside the zero of the rotation."""
    x, y, z = u
    square = x * x + y * y
    r = p - square
    return np.array([r * (x - 3.0 * y), r * (y + 3.0 * x), square - 2.0 * z + 0.5 * r])


@pytest.mark.parametrize("bent", [0.0, 0.4])
def test_conditions_away_from_the_start(bent):
    """y = x / 2, or a parabola beside it; the eigenvalues do not depend on which."""

    def pinned(u, p):
        return u[1] - 0.5 * u[0] - bent * u[0] ** 2 + bent * u[2]

    problem = cv.AlgebraicProblem(rotating, [0.8, 0.6, 0.5], 1.0, spectrum="flow", conditions=[pinned])
    branch = cv.diagram(problem, within=(0.2, 2.0), depth=0)["B1"]
    assert branch.range == (0.2, 2.0)
    x, y, z = branch.points.T[:3]
    p = branch.values
    assert x**2 + y**2 == pytest.approx(p, abs=1e-12) and z == pytest.approx(0.5 * p, abs=1e-12)
    assert y == pytest.approx(0.5 * x + bent * (x**2 - z), abs=1e-12)
    expected = np.sort(np.column_stack([-2.0 * p, np.full(len(p), -2.0)]), axis=1)
    assert np.sort(branch.multipliers.real, axis=1) == pytest.approx(expected, abs=1e-7)  # they meet at p = 1
