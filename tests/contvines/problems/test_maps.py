"""Cycles of maps: multipliers in the order of the points."""

from types import SimpleNamespace

import numpy as np
import pytest

import contvines as cv
from tests.contvines.flows.shooting import jacobian


def bent(x, p):
    return np.array([p + x[1] - 1.1 * x[0] ** 2, 0.3 * x[0] + 0.2 * x[0] * x[1]])


@pytest.mark.parametrize("cycle", [1, 2, 3, 4])
def test_multipliers_are_those_of_the_composed_map(cycle):
    """The first point's derivative acts first: of three or more factors the order matters."""
    nodes = np.random.default_rng(cycle).normal(size=(cycle, 2))
    problem = cv.MapProblem(bent, nodes, 1.0, cycle=cycle, dimension=2, scale=1.0)
    found = problem.raw_spectrum(SimpleNamespace(jacobian=problem.equations(nodes.ravel(), 1.0)[1]))
    product = np.eye(2)
    for node in nodes:
        product = jacobian(bent, node, 1.0) @ product
    assert np.sort_complex(found) == pytest.approx(np.sort_complex(np.linalg.eigvals(product)), rel=1e-7)
