"""Coefficients told by branches, against those of equations whose normal form can be read off."""

import numpy as np
import pytest

import contvines as cv
from contvines.bifurcation.normal_forms.along_branch import criticality, crossing_speed, fold_coefficient
from contvines.continuation.engine import Engine
from contvines.continuation.settings import Settings


def engine_of(problem, within=(-1.0, 1.0)):
    return Engine(problem, within, Settings())


@pytest.mark.parametrize("a, s", [(-2.0, 3.0), (0.5, 3.0), (-1.5, -0.4), (2.0, -0.7)])
def test_sides_and_coefficients_of_pitchforks_and_flips(a, s):
    """x -> (1 + s p) x + a x^3 has p = -(a/s) x^2; x -> -(1 + s p) x + c x^3 the 2-cycle p = (c/s) x^2."""
    name, value = criticality(-a / s, s, flip=False)
    assert value == pytest.approx(a) and name == ("supercritical" if a < 0.0 else "subcritical")
    name, value = criticality(a / s, s, flip=True)
    assert value == pytest.approx(a) and name == ("supercritical" if a > 0.0 else "subcritical")
    assert criticality(1.0, None, flip=False) == (None, None) == criticality(0.0, s, flip=True)


@pytest.mark.parametrize("k", [1.0, -3.0, 1e6, 1e-5])
def test_the_speed_at_which_an_eigenvalue_crosses(k):
    """Of x' = k (p x - x^3) at x = 0 the eigenvalue is k p, whatever the unit of time."""
    problem = cv.AlgebraicProblem(lambda u, p: k * (p * u - u**3), [0.0], -0.5, spectrum="flow")
    engine = engine_of(problem)
    point = engine.start(np.zeros(1), 1e-3)
    assert crossing_speed(engine, point, "plus", 1) == pytest.approx(k, rel=1e-8)


@pytest.mark.parametrize("a", [0.25, 2.0, -3.0])
def test_how_a_fold_opens(a):
    problem = cv.AlgebraicProblem(lambda u, p: p - a * u**2, [np.sqrt(1 / abs(a))], np.sign(a), parameter="p")
    fold = cv.diagram(problem, within=(-1.0, 1.0)).special["LP1"]
    assert fold.value == pytest.approx(0.0, abs=1e-12)
    assert fold.coefficient == pytest.approx(a, rel=1e-6)
    engine = engine_of(problem)
    border = np.array([1.0, 0.0])
    point = engine.solve(np.zeros(1), 0.0, border, 0.0, border)
    assert fold_coefficient(engine, point) == pytest.approx(a, rel=1e-6)
