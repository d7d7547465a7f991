"""Conditions that pick one of a family of equivalent solutions."""

import numpy as np
import pytest
from scipy.linalg import eig

import contvines as cv


def rotating(u, p):
    """A circle of equilibria of radius sqrt(p) in (x, y), with z drawn along."""
    x, y, z = u
    r = p - x * x - y * y
    return np.array([r * x, r * y, x * y - 2.0 * z + 0.5 * r])


def pinned(u, p):
    return u[1] - 0.4 * u[0] ** 2 + 0.3 * u[2]


def test_conditions_away_from_the_start():
    """The larger system with its multiplier along the gradient at the start; eigenvalues of the differential-algebraic equations."""
    start = np.array([1.0, 0.5, 0.2])
    problem = cv.AlgebraicProblem(rotating, start, 1.0, spectrum="flow", conditions=[pinned], scale=1.0)
    assert problem.n_multipliers == 2
    u = np.array([0.8, -0.6, 0.3, 0.05])
    _, jacobian, _ = problem.equations(u, 1.0)
    for j in range(4):
        h = np.zeros(4)
        h[j] = 1e-5
        slope = (problem.residuals(u + h, 1.0) - problem.residuals(u - h, 1.0)) / 2e-5
        assert jacobian[:, j] == pytest.approx(slope, abs=1e-8)
    gradient = np.array([-0.8 * start[0], 1.0, 0.3])
    assert abs(jacobian[:3, 3] @ gradient) == pytest.approx(np.linalg.norm(gradient))
    values = eig(jacobian, np.diag([1.0, 1.0, 1.0, 0.0]), right=False)
    finite = values[np.isfinite(values) & (np.abs(values) < 1e6)]
    found = problem.conditions.eigenvalues(jacobian)
    assert np.sort_complex(found) == pytest.approx(np.sort_complex(finite), abs=1e-8)
