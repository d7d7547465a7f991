"""Maps beside values that others print; each is solved anew in many digits as well."""

import mpmath as mp
import numpy as np
import pytest

import contvines as cv
from tests.contvines.loci.systems import generalized_henon


def ricker(x, p):
    return np.array([x[0] * np.exp(p.r * (1.0 - x[0]))])


def cycle_with(multiplier, points, r):
    """The cycle of x exp(r (1 - x)) with this multiplier near some points, and its r."""

    def system(*v):
        xs, r = v[:-1], v[-1]
        factors = [mp.e ** (r * (1 - x)) for x in xs]
        closed = [x * f - y for x, f, y in zip(xs, factors, [*xs[1:], xs[0]])]
        return [*closed, mp.fprod((1 - r * x) * f for x, f in zip(xs, factors)) - multiplier]

    with mp.workdps(30):
        return float(mp.findroot(system, [*map(mp.mpf, points), mp.mpf(r)])[len(points)])


def test_period_doublings_of_the_ricker_map():
    """May, Science 186 (1974) 645: cycles of 2, 4 and 8 points lose their stability at 2.526, 2.656 and 2.685, the fixed point at 2."""
    problem = cv.MapProblem(ricker, [1.0], {"r": 1.5}, parameter="r")
    graph = cv.diagram(problem, over="r", within=(1.0, 2.69), depth=3)
    found = sorted(graph.of_kind("period-doubling"), key=lambda point: len(point.u))
    assert [len(point.u) for point in found] == [1, 2, 4, 8]
    assert found[0].value == pytest.approx(2.0, abs=1e-12)
    for point, printed in zip(found[1:], (2.526, 2.656, 2.685)):
        assert point.value == pytest.approx(printed, abs=5e-4)
        assert point.value == pytest.approx(cycle_with(-1, point.u, point.value), abs=1e-9)


def test_three_cycle_of_the_ricker_map():
    """May, Nature 261 (1976) 459: the 3-cycle appears at r = 3.1024."""
    x = 0.3
    for _ in range(3000):
        x *= np.exp(3.13 * (1.0 - x))
    problem = cv.MapProblem(ricker, [x], {"r": 3.13}, cycle=3, parameter="r")
    graph = cv.diagram(problem, over="r", within=(3.08, 3.15), depth=0)
    (fold,) = graph.of_kind("fold")
    assert fold.value == pytest.approx(3.1024, abs=5e-5)
    assert fold.value == pytest.approx(cycle_with(1, fold.u, fold.value), abs=1e-9)


def test_fixed_point_of_the_generalized_henon_map():
    """MatContM keeps the saddle of its homoclinic example at (al, be, R) = (-0.4, 1.03, -0.1) in Systems/GeneralizedHenon.mat."""
    problem = generalized_henon([-1.6, -1.6], al=-0.4, be=1.03)
    first = next(cv.trace(problem, within=(0.9, 1.2)))
    assert first.u == pytest.approx([-1.62114638486435] * 2, abs=1e-13)
    assert sorted(np.real(first.multipliers)) == pytest.approx(
        [0.27755915589072977, 3.126848252324405], abs=1e-13
    )
