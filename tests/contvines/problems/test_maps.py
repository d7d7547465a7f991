"""Cycles of maps: multipliers in the order of the points, symmetries of cycles that are their own mirror images."""

from types import SimpleNamespace

import numpy as np
import pytest

import contvines as cv


def bent(x, p):
    return np.array([p + x[1] - 1.1 * x[0] ** 2, 0.3 * x[0] + 0.2 * x[0] * x[1]])


def derivative(x):
    return np.array([[-2.2 * x[0], 1.0], [0.3 + 0.2 * x[1], 0.2 * x[0]]])


@pytest.mark.parametrize("cycle", [1, 2, 3, 4])
def test_multipliers_are_those_of_the_composed_map(cycle):
    """The first point's derivative acts first: of three or more factors the order matters."""
    draw = np.random.default_rng(cycle)
    nodes = draw.normal(size=(cycle, 2))
    problem = cv.MapProblem(bent, nodes, 1.0, cycle=cycle, dimension=2, scale=1.0)
    _, jacobian, _ = problem.equations(nodes.ravel(), 1.0)
    found = problem.raw_spectrum(SimpleNamespace(jacobian=jacobian))
    product = np.eye(2)
    for node in nodes:
        product = derivative(node) @ product
    assert np.sort_complex(found) == pytest.approx(np.sort_complex(np.linalg.eigvals(product)), rel=1e-7)


def test_cycles_that_are_their_own_mirror_images():
    """x -> -p x + x^3 is odd: its cycle (a, -a) is mirrored half a cycle on, (a, b) is not."""
    problem = cv.MapProblem(lambda x, p: -p * x + x**3, [0.5, -0.5], 0.75, cycle=2, mirror=[[-1.0]])
    breaking = [s for s in problem.symmetries if s.kind == "symmetry-breaking"]
    own = np.array([0.5, -0.5])
    assert any(np.allclose(s.apply(own), own) for s in breaking)
    assert not any(np.allclose(s.apply(np.array([0.5, -0.4])), [0.5, -0.4]) for s in breaking)
    doubling = [s for s in problem.symmetries if s.kind == "period-doubling"]
    assert any(np.allclose(s.apply(np.array([0.4, 0.4])), [0.4, 0.4]) for s in doubling)
