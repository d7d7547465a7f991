"""Newton's corrections one by one: when they are taken, when they are enough, when there is no hope."""

import itertools
import math

import numpy as np
import pytest

import contvines as cv
from contvines.bifurcation.segment import Segment
from contvines.continuation.arrays import (
    Metric,
    compare,
    correction_size,
    extrapolate,
    fix_parameter,
    hermite,
    plane,
    remainder,
)
from contvines.continuation.corrector import improve
from contvines.continuation.engine import Engine
from contvines.continuation.settings import Settings

ONES = np.ones(2)
FLAT = Metric(ONES, ONES, 1.0, 1.0)
UNEVEN = Metric(np.array([0.5, 0.5, 0.25]), np.ones(3), 0.5, 0.25)


def judged(sizes, residual=1.0, tolerance=1e-8, noise=0.0):
    """Verdicts on successive corrections of the sizes given, of an unknown near 0."""
    before, found = 0.0, []
    for sweep, size in enumerate(sizes):
        p, before, verdict = improve(
            np.zeros(1), 0.0, np.array([size, 0.0]), sweep, residual, before, tolerance, FLAT, noise
        )
        found.append(verdict)
    return found


def test_growing_corrections_are_a_divergence():
    """Newton's method for arctan u = 0 from u = 1.5: each correction is larger than the one before."""
    u, sizes = 1.5, []
    for _ in range(4):
        step = -math.atan(u) * (1.0 + u * u)
        sizes.append(abs(step))
        u += step
    assert sizes[1] < 2.0 * sizes[0] or sizes[2] > 2.0 * sizes[1]
    verdicts = judged(sizes)
    assert verdicts[:2] == [0, 0] and -1 in verdicts[2:]


@pytest.mark.filterwarnings("ignore:invalid value")
@pytest.mark.parametrize("size", [1e7, math.inf, math.nan])
def test_corrections_beyond_all_measure_are_a_divergence(size):
    assert judged([size]) == [-1]


def test_quadratic_convergence_is_believed_and_slow_convergence_is_not():
    assert judged([1e-2, 1e-5, 1e-10]) == [0, 0, 1]
    assert judged([1e-2, 1e-9]) == [0, 1]  # the next one would be about (1e-7)^2 1e-9
    assert judged([1e-2, 9e-3, 8e-3, 7e-3]) == [0, 0, 0, 0]
    assert judged([1e-12]) == [1]
    assert judged([1e-3, 1e-7, 9e-8], residual=1e-12) == [0, 0, 1]  # rounding: no smaller any more
    assert judged([1e-3, 1e-7, 9e-8], residual=1e-3) == [0, 0, 0]


def test_a_solution_that_newton_misses_is_none_and_costs_little():
    calls = []

    def F(u, p):
        calls.append(float(np.real(u[0])))
        return np.arctan(u) - p

    problem = cv.AlgebraicProblem(F, [0.0], 0.0, scale=1.0)
    engine = Engine(problem, (-1.0, 1.0), Settings())
    calls.clear()
    assert engine.at_value(np.array([3.0]), 0.0) is None
    assert len(calls) < 60
    assert engine.at_value(np.array([1.0]), 0.0).u[0] == pytest.approx(0.0, abs=1e-12)


def circle(angles):
    """Points of the unit circle as unknown and parameter, and their tangents."""
    z = np.column_stack([np.cos(angles), np.sin(angles)])
    t = np.column_stack([-np.sin(angles), np.cos(angles)])
    return np.ascontiguousarray(z[:, :1]), np.ascontiguousarray(z[:, 1]), t


def ahead(step):
    """Error of the prediction over a step on the unit circle, from two points as far apart."""
    points, values, tangents = circle(0.4 + step * np.arange(3.0))
    u = np.zeros(1)
    p = extrapolate(points, values, tangents, 2, step, FLAT, u)
    return math.hypot(u[0] - points[2, 0], p - values[2])


def test_the_prediction_is_of_fourth_order():
    """So it is in arc length; with chords for arcs it would be of third order."""
    errors = [ahead(step) for step in (0.2, 0.1, 0.05)]
    orders = [math.log2(a / b) for a, b in itertools.pairwise(errors)]
    assert orders == pytest.approx([4.0, 4.0], abs=0.15)
    assert errors[1] < 0.3 * 0.1**4


def test_the_first_prediction_is_along_the_tangent():
    points, values, tangents = circle(np.array([0.4, 0.5]))
    u = np.zeros(1)
    p = extrapolate(points, values, tangents, 1, 0.1, FLAT, u)
    assert [u[0], p] == pytest.approx([points[0, 0] + 0.1 * tangents[0, 0], values[0] + 0.1 * tangents[0, 1]])


def test_a_segment_guesses_its_inside_in_arc_length():
    """Of a curve z(s) the Hermite cubic over a length h misses the middle by h^4 abs(z'''') / 384; here z'''' = z."""
    problem = cv.AlgebraicProblem(lambda u, p: u**2 + p**2 - 1.0, [1.0], 0.0, scale=1.0)
    engine = Engine(problem, (-1.0, 1.0), Settings())
    engine.weights[:] = 1.0
    for length in (0.4, 0.2):
        ends = [engine.at_value(np.array([math.cos(a)]), math.sin(a)) for a in (0.3, 0.3 + length)]
        ends = [e._replace(tangent=np.array([-e.p, e.u[0]])) for e in ends]
        guess = np.empty(2)
        hermite(Segment(engine, *ends).chord, 0.5, np.empty(1), guess)
        assert abs(math.hypot(*guess) - 1.0) == pytest.approx(length**4 / 384.0, rel=0.05)


def test_sums_over_the_unknowns():
    u, step = np.array([1.0, -3.0]), np.array([0.1, 0.4, -0.3])
    assert correction_size(step, u, 0.5, UNEVEN) == pytest.approx(max(0.1 / 2.0, 0.4 / 4.0, 0.3 / 1.5))
    assert correction_size(np.array([0.1, np.nan, 0.0]), u, 0.5, UNEVEN) == math.inf
    border = np.array([0.2, -0.5, 2.0])
    assert remainder(border, u, 0.7, 4.0) == pytest.approx(4.0 - (0.2 + 1.5 + 1.4))
    fix_parameter(border)
    assert border.tolist() == [0.0, 0.0, 1.0]
    tangent = np.array([0.3, 0.4, 0.5])
    target = plane(tangent, u, 0.7, UNEVEN, border)
    assert border.tolist() == pytest.approx([0.15, 0.2, 0.125])
    assert target == pytest.approx(0.15 - 0.6 + 0.125 * 0.7)
    other = np.array([0.6, -0.1, 0.2])
    norm, cosine, error = compare(tangent, other, u, np.array([0.9, -2.8]), 0.7, 0.4, UNEVEN)
    assert norm == pytest.approx(math.sqrt(0.5 * 0.25 + 0.25 * 0.25))
    assert cosine == pytest.approx((0.5 * (0.18 - 0.04) + 0.25 * 0.1) / norm)
    assert error == pytest.approx(math.sqrt(0.5 * (0.01 + 0.04) + 0.25 * 0.09))


def test_the_sign_of_the_determinant_turns_with_the_tangent():
    problem = cv.AlgebraicProblem(lambda u, p: u**2 + p**2 - 1.0, [1.0], 0.0, scale=1.0)
    engine = Engine(problem, (-1.0, 1.0), Settings())
    for angle in (0.3, 1.2):
        u, p = np.array([math.cos(angle)]), math.sin(angle)
        tangent = engine.unit(np.array([-p, u[0]]))
        for border in (engine.weights * tangent, -engine.weights * tangent):
            target = float(border @ np.append(u, p))
            for sign in (1.0, -1.0):
                found = engine.solve(u, p, border, target, sign * tangent)
                matrix = np.array([[2.0 * u[0], 2.0 * p], sign * tangent * engine.weights])
                assert found.sign == np.sign(np.linalg.det(matrix))
