"""Named parameters: any of them may vary."""

import numpy as np
import pytest

import contvines as cv
from contvines.problems.functions import ParameterSet


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
    start = cv.AlgebraicProblem(cusp, [-1.5], {"h": 0.1, "r": 2.5}, parameter="r")
    assert [q.value for q in cv.diagram(start, within=(0.0, 3.0)).of_kind("fold")] == pytest.approx(
        [3.0 * (0.1 / 2.0) ** (2.0 / 3.0)], abs=1e-12
    )
    assert graph.parameter == "r"


def test_derivatives_by_name_and_files():
    slopes = {"h": lambda u, p: [1.0], "r": lambda u, p: [u[0]]}
    problem = cv.AlgebraicProblem(cusp, [0.3], {"h": 0.0, "r": 1.0}, derivative=slopes)
    u = np.array([0.3])
    assert problem.equations(u, 0.0)[2] == pytest.approx([1.0])
    assert problem.against("r").equations(u, 1.0)[2] == pytest.approx([0.3])
    from contvines.problems.registry import rebuild

    again = rebuild(cv.AlgebraicProblem(cusp, [0.3], {"h": 0.0, "r": 1.0}, parameter="r").describe())
    assert again.parameter == "r" and again.parameters == {"h": 0.0, "r": 1.0}


def odd(x, p):
    return p.a * x - p.c * x**3


def test_a_map_with_a_mirror():
    """x -> a x - c x^3: pitchfork at 1, flips at -1 and 2; the 2-cycle (x, -x) is born at a = -1 by a flip."""
    problem = cv.MapProblem(odd, [0.0], {"a": 0.5, "c": 1.0}, mirror=lambda x: -x)
    graph = cv.diagram(problem, over="a", within=(-1.5, 2.2), depth=3)
    assert [q.value for q in graph.of_kind("symmetry-breaking")] == pytest.approx([1.0], abs=1e-13)
    assert sorted(q.value for q in graph.of_kind("period-doubling")) == pytest.approx([-1.0, 2.0], abs=1e-12)
    assert not graph.of_kind("fold")
    assert graph.of_kind("symmetry-breaking")[0].mirror


def test_a_parameter_that_is_none_of_those_given_is_refused():
    with pytest.raises(ValueError, match="there is no parameter 'gane'.*gain.*; the problem has gain, loss"):
        cv.AlgebraicProblem(lambda u, p: [p.gain - u[0]], [1.0], {"gain": 1.0, "loss": 2.0}, parameter="gane")
    assert ParameterSet({"gain": 1.0, "loss": 2.0}, "p").varying == "gain"
