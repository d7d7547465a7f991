"""Border collisions of piecewise linear maps, x -> a x + p left of zero and b x + p right of it: all of it is known by hand."""

import numpy as np
import pytest

import contvines as cv


def followed(a, b):
    """The diagram, and the notes of the switches at the border."""

    def f(x, p, sign):
        return (a if sign["side"] < 0 else b) * x + p

    side = {"side": lambda x, p: x[0]}
    problem = cv.MapProblem(f, [-0.5 / (1.0 - a)], -0.5, switches=side, scale=1.0)
    graph = cv.diagram(problem, within=(-1.0, 1.0), depth=1)
    (point,) = graph.of_kind("switch")
    assert point.value == pytest.approx(0.0, abs=1e-9)
    return graph, {s.note for s in graph.switches if s.point == point.label}


def test_a_fixed_point_that_goes_on_in_the_next_piece():
    """0 < a, b < 1: x = p / (1 - a) left, p / (1 - b) right."""
    graph, notes = followed(0.5, 0.3)
    assert notes == {"persistence"}
    right = next(b for b in graph.branches.values() if b.points.max() > 0.1)
    np.testing.assert_allclose(right.points[:, 0], right.values / 0.7, atol=1e-10)
    assert right.values.max() == 1.0 and right.stable[1:-1].all()
    assert right.multipliers[5, 0] == pytest.approx(0.3)


def test_two_fixed_points_that_meet_and_vanish():
    """b > 1: the right one is -p / (b - 1), for p < 0 as well, and unstable."""
    graph, notes = followed(0.5, 2.0)
    assert notes == {"nonsmooth fold"}
    right = next(b for b in graph.branches.values() if b.points.max() > 0.1)
    np.testing.assert_allclose(right.points[:, 0], -right.values, atol=1e-10)
    assert right.values.max() == pytest.approx(0.0, abs=1e-9) and right.values.min() == -1.0
    assert not right.stable.any()


def test_a_cycle_of_two_points_that_leaves_the_border():
    """a b = -0.8: beyond the border the right fixed point is unstable, and one point on either side is a stable cycle."""
    graph, notes = followed(0.4, -2.0)
    assert notes == {"persistence", "nonsmooth flip"}
    pair = next(b for b in graph.branches.values() if b.points.shape[1] == 2)
    p = pair.values[-1]
    low, high = sorted(pair.points[-1])
    assert 0.4 * low + p == pytest.approx(high) and -2.0 * high + p == pytest.approx(low)
    assert low < 0.0 < high and p == 1.0
    assert pair.multipliers[len(pair) // 2, 0] == pytest.approx(-0.8)
