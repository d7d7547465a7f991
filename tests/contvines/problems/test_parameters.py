"""Named parameters: any of them may vary."""

import numpy as np
import pytest

import contvines as cv
from contvines.problems.registry import rebuild


def cusp(u, p):
    """h + r u - u^3: folds at h = +-2 (r/3)^(3/2)."""
    return p.h + p.r * u - u**3


def test_either_parameter_varies():
    problem = cv.AlgebraicProblem(cusp, [-1.5], {"h": -1.0, "r": 1.2})
    assert problem.parameter == "h" and problem.parameters == {"h": -1.0, "r": 1.2}
    fold = 2.0 * (1.2 / 3.0) ** 1.5
    graph = cv.diagram(problem, over="h", within=(-1.0, 1.0))
    np.testing.assert_allclose(sorted(q.value for q in graph.of_kind("fold")), [-fold, fold], atol=1e-13)
    graph = cv.diagram(problem.against("r", {"h": 0.1}), within=(-1.0, 3.0))
    assert graph.parameter == "r"
    assert [q.value for q in graph.of_kind("fold")] == pytest.approx(
        [3.0 * (0.1 / 2.0) ** (2.0 / 3.0)], abs=1e-12
    )


def test_derivatives_by_name_and_files():
    values = {"h": 0.0, "r": 1.0}
    slopes = {"h": lambda u, p: [1.0], "r": lambda u, p: [u[0]]}
    problem = cv.AlgebraicProblem(cusp, [0.3], values, derivative=slopes)
    u = np.array([0.3])
    assert problem.equations(u, 0.0)[2] == pytest.approx([1.0])
    assert problem.against("r").equations(u, 1.0)[2] == pytest.approx([0.3])
    again = rebuild(cv.AlgebraicProblem(cusp, [0.3], values, parameter="r").describe())
    assert again.parameter == "r" and again.parameters == values
