"""Signs of determinants that errors of the entries can change say nothing."""

from fractions import Fraction
from itertools import product

import numpy as np
import pytest

import contvines as cv
from contvines.bifurcation.determinant import ROUNDING, certain, passes_for_certain
from contvines.bifurcation.segment import Segment
from contvines.continuation.engine import Engine, Solved
from contvines.continuation.settings import Settings


def fibonacci(k):
    """[[f_(k+1), f_k], [f_k, f_(k-1)]], whose determinant is (-1)^k (Cassini)."""
    a, b = 1, 0
    for _ in range(k):
        a, b = a + b, a
    return [[a, b], [b, a - b]]


def one_sign(matrix):
    """Whether all matrices whose entries differ by so much have determinants of one sign: it is linear in each, so corners tell."""
    sides = [1 + Fraction(ROUNDING) * side for side in (-1, 1)]
    (a, b), (c, d) = matrix
    values = [a * w * d * z - b * x * c * y for w, x, y, z in product(sides, repeat=4)]
    return all(v > 0 for v in values) or all(v < 0 for v in values)


@pytest.mark.parametrize("rows", [1.0, 1e9])
@pytest.mark.parametrize("k", range(20, 42))
def test_as_exact_fractions_have_it(k, rows):
    matrix = np.array(fibonacci(k), dtype=float) * [[1.0], [rows]]
    problem = cv.AlgebraicProblem(lambda u, p: matrix @ u, [0.0, 0.0], 0.0, jacobian=lambda u, p: matrix)
    engine = Engine(problem, (-1.0, 1.0), Settings())
    point = Solved(np.zeros(2), 0.0, np.array([0.0, 0.0, 1.0]), np.zeros(engine.row_size), 0.0, 0.0, 0.0)
    assert certain(engine, point) == one_sign(fibonacci(k))


def test_a_change_of_sign_is_certain_where_both_ends_are():
    """det [[1, 1], [1, 1 + p]] = p: next to p = 0 it is rounding, at p = -1 and 1 it is not."""
    problem = cv.AlgebraicProblem(lambda u, p: [u[0] + u[1], u[0] + (1.0 + p) * u[1]], [0.0, 0.0], -1.0)
    engine = Engine(problem, (-1.0, 1.0), Settings())

    def point(p):
        row = np.zeros(engine.row_size)
        return Solved(np.zeros(2), p, np.array([0.0, 0.0, 1.0]), row, np.sign(p), 0.0, 0.0)

    sure, rounding = point(-1.0), point(1e-16)
    assert passes_for_certain(Segment(engine, sure, point(1.0)), 0.5)
    assert not passes_for_certain(Segment(engine, sure, rounding), 0.5)
    assert not passes_for_certain(Segment(engine, rounding, point(1.0)), 0.5)
    # next to a place where the determinant is zero it may well be rounding
    assert passes_for_certain(Segment(engine, sure, rounding), 1.0)
