"""Branches of cycles as wholes: closed ones, those that are traced once, those that grow."""

import numpy as np
import pytest

import contvines as cv
from tests.contvines.flows.shooting import unit_circle

pytestmark = pytest.mark.slow


def test_cycles_in_an_invariant_plane_are_one_branch():
    def f(x, p):
        square = x[0] ** 2 + x[1] ** 2
        growth = p.m * (1.0 - p.m) - square
        return [growth * x[0] - x[1], x[0] + growth * x[1], (square - 0.4) * x[2] + x[0] * x[2] * x[1]]

    graph = cv.diagram(cv.FlowProblem(f, [0.0, 0.0, 0.0], {"m": -0.2}), over="m", within=(-0.3, 1.3))
    cycles = [b for b in graph.branches.values() if b.description["word"] == "cycle"]
    assert len(cycles) == 1  # from one Hopf point to the next, whatever rounding says of the third state
    assert cycles[0].range == pytest.approx((0.0, 1.0), abs=1e-9)


def beside(power, gain, at):
    """r' = r (1 - r^2), turning once in 2 pi; z' = z (a - z^power); w' = (gain (z^power - at) + 0.3 i) w - w |w|^2.

    A branch leaves z = 0 at a = 0, and has z^power = a: a pair passes the circle at a = at, with w = 0 all along.
    """

    def f(x, p):
        (c, s, z, v, w), inward = x, 1.0 - x[0] ** 2 - x[1] ** 2
        size = z if power == 1 else z**2
        growth = gain * (size - at) - v**2 - w**2
        return [inward * c - s, inward * s + c, z * (p.a - size), growth * v - 0.3 * w, 0.3 * v + growth * w]

    return cv.FlowProblem(f, [1.0, 0.0, 0.0, 0.0, 0.0], {"a": -0.2}).cycle(*unit_circle(5))


@pytest.mark.parametrize(
    ("power", "gain", "values", "error"), [(2, 1.0, [0.05, 0.05], 1e-8), (1, 3e3, [1e-7], 1e-11)]
)
def test_a_pair_passes_the_circle_while_its_states_are_zero(power, gain, values, error):
    """Derivatives by them are below the least normal number, and of few bits; or it passes within a part of the first step behind a branch point."""
    graph = cv.diagram(beside(power, gain, values[0]), over="a", within=(-0.3, 0.2), depth=1)
    assert [p.value for p in graph.of_kind("neimark-sacker")] == pytest.approx(values, abs=error)


def test_a_hopf_point_within_a_part_of_the_first_step_behind_a_branch_point():
    def f(x, p):
        (z, v, w), growth = x, 3e4 * (x[0] - 1e-7) - x[1] ** 2 - x[2] ** 2
        return [z * (p.a - z), growth * v - w, v + growth * w]

    flow = cv.FlowProblem(f, [0.0, 0.0, 0.0], {"a": -0.2})
    graph = cv.diagram(flow, over="a", within=(-0.3, 0.4), depth=1)
    assert [p.value for p in graph.of_kind("hopf")] == pytest.approx([1e-7], abs=1e-11)


def test_cycles_that_turn_over_keep_no_phase_that_does_not_suit_them():
    """The unit circle in a plane that turns by the angle q: where q = pi, motions are orthogonal, in the mean, to those where q = 0."""

    def f(x, p):
        c, s = np.cos(p.q), np.sin(p.q)
        y, z = c * x[1] + s * x[2], c * x[2] - s * x[1]
        growth = 1.0 - x[0] ** 2 - y**2
        a, b, d = growth * x[0] - y, x[0] + growth * y, -2.0 * z
        return [a, c * b - s * d, s * b + c * d]

    flow = cv.FlowProblem(f, [1.0, 0.0, 0.0], {"q": 0.0})
    branch = cv.diagram(flow.attractor(), over="q", within=(0.0, 2.0 * np.pi), depth=0)["B1"]
    assert branch.range == (0.0, 2.0 * np.pi)
    assert np.allclose(branch.measure("period"), 2.0 * np.pi, rtol=1e-9)
    assert np.allclose(branch.measure("max x2"), np.abs(np.sin(branch.values)), atol=1e-6)


def hodgkin_huxley(x, p):
    """As printed by Hodgkin and Huxley (1952), depolarised upwards from rest at zero."""
    v, m, h, n = x
    opens = (25 - v) / 10 / (np.exp((25 - v) / 10) - 1), (10 - v) / 100 / (np.exp((10 - v) / 10) - 1)
    currents = 120 * m**3 * h * (v - 115) + 36 * n**4 * (v + 12) + 0.3 * (v - 10.599)
    return [
        p.current - currents,
        opens[0] * (1 - m) - 4 * np.exp(-v / 18) * m,
        0.07 * np.exp(-v / 20) * (1 - h) - h / (np.exp((30 - v) / 10) + 1),
        opens[1] * (1 - n) - 0.125 * np.exp(-v / 80) * n,
    ]


def test_doublings_where_a_pair_meets_on_the_axis_in_the_same_step():
    """Both doublings by multiple shooting with scipy's DOP853."""
    neuron = cv.FlowProblem(hodgkin_huxley, [4.0, 0.09, 0.45, 0.38], {"current": 9.0})
    graph = cv.diagram(neuron, over="current", within=(7.0, 11.0), depth=1)
    doublings = sorted(point.value for point in graph.of_kind("period-doubling"))
    assert doublings == [pytest.approx(7.849537397847, abs=1e-9), pytest.approx(7.921977675728, abs=1e-9)]
    assert "unresolved" not in str(graph)


def test_cycles_that_become_their_own_mirror_images_end_there():
    """r' = (p + z^2 - r^2) r, z' = (1 - z^2 - r^2 / 2) z: cycles with r^2 = 2 (p + 1) / 3 from rest at z = 1 to z = 0, at p = 2."""

    def rates(s, p):
        x, y, z = s
        growth, turning = p.p + z * z - x * x - y * y, 1.0 + 0.9 * z * x
        return [growth * x - turning * y, growth * y + turning * x, (1.0 - z * z - 0.5 * (x * x + y * y)) * z]

    flow = cv.FlowProblem(rates, [0.0, 0.0, 1.0], {"p": -1.5}, mirror=lambda s: -s)
    graph = cv.diagram(flow, over="p", within=(-1.5, 3.0), depth=2)
    assert sorted(point.value for point in graph.of_kind("hopf")) == pytest.approx([-1.0, 0.0], abs=1e-6)
    (point,) = graph.of_kind("symmetry-breaking")
    assert point.value == pytest.approx(2.0, abs=1e-6)
    assert not graph.of_kind("branch-point") and not graph.of_kind("fold")
    born = graph.branches["B2"]
    assert born.range == pytest.approx((-1.0, 2.0), abs=1e-6)
    symmetric = graph.branches["B3"]  # r^2 = p
    assert symmetric.measure("max x0") == pytest.approx(np.sqrt(np.abs(symmetric.values)), rel=1e-7, abs=1e-5)
