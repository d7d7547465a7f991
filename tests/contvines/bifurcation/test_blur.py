"""Stated errors of branch points cover what rounding of the matrices does to their places, and not very much more."""

import numpy as np
import pytest

import contvines as cv
from contvines.bifurcation.located import Located
from contvines.bifurcation.location_error import ENTRY, blurred, missed, singular_within
from contvines.bifurcation.segment import Segment
from contvines.continuation.engine import Engine, Solved
from contvines.continuation.settings import Settings
from tools.brusselator import brusselator


@pytest.mark.parametrize("growth", [5.0, 10.0, 20.0, 30.0])
def test_a_branch_point_beside_an_eigenvalue_that_has_grown(growth):
    """x (x - p + 0.3) = 0 and exp(growth p) (y - 1) = 0, mixed: at p = 0.3 eigenvalues, relative to those at p = -0.7, are 0 and exp(growth)."""
    mixed, rows = np.array([[3.0, 7.0], [2.0, 5.0]]), np.array([[2.0, -3.0], [-7.0, 11.0]])

    def F(u, p):
        x, y = mixed @ u
        return rows @ np.array([x * (x - p + 0.3), np.exp(growth * p) * (y - 1.0)])

    start = np.linalg.solve(mixed, [0.0, 1.0])
    graph = cv.diagram(cv.AlgebraicProblem(F, start, -0.7), within=(-0.8, 0.8), depth=0)
    (point,) = graph.of_kind("branch-point")
    assert abs(point.value - 0.3) <= point.location_error < 1e-8


@pytest.mark.parametrize("m", [50, 400, 1500])
def test_stiff_fields_on_a_line(m):
    """The first Turing point of a brusselator: entries of D/h^2 are rounded, and the stated error grows with them.

    B = (1 + D l)(A^2 + E l)/(E l), l = 4 m^2 sin(k pi/2 m)^2 the eigenvalues of the second difference with no flux at the walls.
    """
    A, D, E = 2.0, 0.02, 0.5
    F, jacobian, derivative = brusselator(m, A, D, E)
    problem = cv.AlgebraicProblem(F, np.tile([A, 1.0], m), 2.0, "B", jacobian=jacobian, derivative=derivative)
    graph = cv.diagram(problem, within=(2.0, 2.16), depth=0)
    lengths = 4.0 * m**2 * np.sin(np.arange(1, 9) * np.pi / (2 * m)) ** 2
    exact = min((1.0 + D * lengths) * (A**2 + E * lengths) / (E * lengths))
    (point,) = graph.of_kind("branch-point")
    assert abs(point.value - exact) <= point.location_error
    assert point.location_error < 2e-11 + 1e-13 * m**2


@pytest.mark.parametrize("start", [-1.7, -0.6, 0.3, 0.9, 1.2, 1.5, 1.9])
def test_errors_of_branch_points_where_all_entries_cancel_are_bounds(start):
    """x (x + 1) (3 p + 2 x - 3), multiplied out: at the crossings, p = 1 and 5/3, both derivatives are sums that cancel, so that their size does not tell their rounding."""
    problem = cv.AlgebraicProblem(
        lambda x, p: 3 * p * x**2 + 3 * p * x + 2 * x**3 - x**2 - 3 * x, [1.5 * (1.0 - start)], start
    )
    points = cv.diagram(problem, within=(-2.0, 2.0), depth=0).of_kind("branch-point")
    assert len(points) == 2
    for point, true in zip(sorted(points, key=lambda point: point.value), (1.0, 5.0 / 3.0), strict=True):
        assert abs(point.value - true) <= point.location_error < 1e-9


@pytest.mark.parametrize("scale", [1.0, 1e6])
def test_how_far_rounding_moves_a_branch_point_in_closed_form(scale):
    """F_u = [[1 + p, 1], [1, 1]] with null vectors (1, -1) on both sides at p = 0: entries wrong by e move the place by 4 e, in any unit of p."""
    problem = cv.AlgebraicProblem(
        lambda u, p: [(1.0 + p / scale) * u[0] + u[1], u[0] + u[1]], [0.0, 0.0], 0.0, scale=1.0
    )
    engine = Engine(problem, (-scale, scale), Settings())
    tangent = engine.unit(np.array([0.0, 0.0, 1.0]))
    found = singular_within(engine, np.zeros(2), 0.0, tangent)
    assert found == pytest.approx(4.0 * ENTRY * scale, rel=1e-6, abs=0.0)


@pytest.mark.parametrize("off", [1e-4, -3e-5])
def test_by_how_much_a_branch_point_is_missed_in_closed_form(off):
    """p u - u^2 has its branch point at 0, where two lines cross: from a place aside on either one Newton step leads there."""
    problem = cv.AlgebraicProblem(lambda u, p: p * u - u**2, [0.0], off, scale=1.0)
    engine = Engine(problem, (-1.0, 1.0), Settings())
    tangent = engine.unit(np.array([0.0, 1.0]))
    assert missed(engine, np.zeros(1), off, tangent) == pytest.approx(abs(off), rel=1e-6, abs=0.0)


@pytest.mark.parametrize("rate", [1.0, 50.0])
def test_how_far_rounding_moves_a_zero_eigenvalue_in_closed_form(rate):
    """The eigenvalue r p of r p u changes by r over one unit of p: what moves it by e moves its zero by e / r."""
    problem = cv.AlgebraicProblem(lambda u, p: rate * p * u, [0.0], -1.0, spectrum="flow")
    engine = Engine(problem, (-1.0, 1.0), Settings())

    def point(p):
        row = np.zeros(engine.row_size)
        row[0] = rate * p / problem.scales.rate if problem.scales else rate * p
        return Solved(np.zeros(1), p, np.array([0.0, 1.0]), row, 1.0, 0.0, 0.0)

    a, b, here = point(-1.0), point(1.0), point(0.25)
    event = Located(0.5, "branch-point", 1, here, (-1.0, 1.0), 0.0)
    told = blurred(Segment(engine, a, b), event, lambda point: float(point.row[0]))
    engine.residual(here.u, here.p)
    moved = problem.blur(engine.work)
    assert moved > 0.0
    assert told.error == pytest.approx(moved / ((b.row[0] - a.row[0]) / 2.0), rel=1e-12, abs=0.0)
    assert (
        blurred(Segment(engine, a, b), event._replace(error=1.0), lambda point: float(point.row[0])).error
        == 1.0
    )
