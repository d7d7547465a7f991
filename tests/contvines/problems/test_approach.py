"""Rough starts: to which solution they lead, and that this is told."""

import numpy as np
import pytest

import contvines as cv
from contvines.problems.scouting import approach

# the spruce budworm of Ludwig, Jones and Holling (J. Anim. Ecol. 47 (1978) 315): x' = r x (1 - x/k) - x^2/(1 + x^2)
R, K = 0.5, 10.0


def budworm(u, p):
    x = u[0]
    return np.array([p.r * x * (1 - x / p.k) - x**2 / (1 + x**2)])


def times_denominator():
    """Polynomials: the numerator of F over 1 + x^2, and that of F' over (1 + x^2)^2."""
    x, one = np.poly1d([1.0, 0.0]), np.poly1d([1.0, 0.0, 1.0])
    growth = R * x - R / K * x**2
    return growth * one - x**2, growth.deriv() * one**2 - 2.0 * x


def real(polynomial):
    roots = polynomial.roots
    return np.sort(np.real(roots[np.abs(roots.imag) < 1e-9]))


@pytest.mark.parametrize("guess", np.linspace(-0.3, 15.0, 30))
def test_the_solution_on_this_side_of_the_extrema_is_found(guess):
    """Damped Newton does not pass a place where F' = 0, so it finds the zero between the same two of them, or none."""
    value, slope = times_denominator()
    problem = cv.AlgebraicProblem(budworm, [guess], {"r": R, "k": K})
    found = approach(problem, np.array([guess]), R)
    ends = real(slope)
    side = np.searchsorted(ends, guess)
    inside = [root for root in real(value) if np.searchsorted(ends, root) == side]
    if inside:
        assert found is not None and found[0] == pytest.approx(inside[0], abs=0.03)
    else:
        assert found is None


def test_a_rough_start_is_told():
    problem = cv.AlgebraicProblem(budworm, [5.0], {"r": R, "k": K}, spectrum="flow")
    graph = cv.diagram(problem, over="r", within=(0.01, 1.0))
    assert "no solution" in graph.start and "instead of 5" in graph.start and graph.start in str(graph)
    size = abs(budworm(np.array([5.0]), problem.values.at(R))[0])
    assert f"{size:.2g}" in graph.start
    assert graph.to_dict()["start"] == graph.start
    problem = cv.AlgebraicProblem(budworm, [2.001], {"r": R, "k": K})  # 2 is a zero: 0.5 * 0.8 = 2/5
    assert cv.diagram(problem, over="r", within=(0.01, 1.0)).start == ""  # good to three digits
