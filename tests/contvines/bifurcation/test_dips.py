"""Narrow windows between two points: nothing changes sign at the points, and still nothing is missed."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

import contvines as cv
from contvines.bifurcation.detect import Detector
from contvines.continuation.engine import Engine
from contvines.continuation.settings import Settings
from contvines.problems.dense import KERNELS, DenseWork
from contvines.problems.protocol import Kernels, ProblemDefaults


def inspect(data, u, p, work, row):
    row[0], row[1] = data.multiplier(p), 0.0
    row[2] = data.margin(p)


class Line(ProblemDefaults):
    """u = p with a margin and a multiplier that are given functions of p."""

    dimension, n_multipliers, n_margins, spectrum, parameter = 1, 1, 1, "map", "p"
    kernels = Kernels(KERNELS.linearise, KERNELS.bordered, inspect)
    u0, p0 = np.array([-0.95]), -0.95

    def __init__(self, margin=lambda p: 1.0, multiplier=lambda p: 0.5):
        self.margin, self.multiplier, self.data = margin, multiplier, self

    def workspace(self):
        return DenseWork(1)

    def equations(self, u, p):
        return u - p, np.eye(1), np.array([-1.0])

    def margin_kind(self, j):
        return "velocity-graze"


class TwoMargins(Line):
    """u = p with a margin that dips, and one that is lost for good a little later."""

    n_margins = 2

    def __init__(self, centre, half, later):
        def inspect_both(data, u, p, work, row):
            row[:] = 0.5, 0.0, (p - centre) ** 2 - half**2, centre + half + later - p

        super().__init__()
        self.kernels = Kernels(KERNELS.linearise, KERNELS.bordered, inspect_both)

    def margin_kind(self, j):
        return ("velocity-graze", "wall-graze")[j]


@settings(max_examples=80, deadline=None)
@example(
    -0.1875, 0.0078125, 0.015625
)  # between the ends of two chunks, another margin is lost in the next segment
@example(
    0.289122949011563, 0.00390625, 0.0078125
)  # a margin that is nearly zero at a point, lost right behind it
@given(st.floats(-0.6, 0.6), st.floats(1e-3, 0.02), st.floats(1e-3, 0.02))
def test_short_loss_of_a_margin_before_another_one_is_lost(centre, half, later):
    """The branch ends where the first of them is lost, though the next point lies beyond the other one."""
    graph = cv.diagram(TwoMargins(centre, half, later), within=(-1.0, 1.0))
    assert graph["VG1"].value == pytest.approx(centre - half, abs=1e-12)
    assert graph["B1"].values[-1] == graph["VG1"].value


@settings(max_examples=80, deadline=None)
@given(st.floats(-0.6, 0.6), st.floats(1e-3, 0.02), st.floats(1e-9, 1e-2))
def test_short_loss_of_a_margin_that_is_not_the_smallest(centre, half, level):
    """Another margin is smaller nearly everywhere, and does not vanish."""

    def inspect_both(data, u, p, work, row):
        row[:] = 0.5, 0.0, (p - centre) ** 2 - half**2, level

    problem = TwoMargins(centre, half, 0.0)
    problem.kernels = Kernels(KERNELS.linearise, KERNELS.bordered, inspect_both)
    graph = cv.diagram(problem, within=(-1.0, 1.0))
    assert graph["VG1"].value == pytest.approx(centre - half, abs=1e-12)


@settings(max_examples=40, deadline=None)
@given(st.floats(-0.6, 0.6), st.floats(1e-3, 0.05))
def test_short_loss_of_stability(centre, half):
    graph = cv.diagram(
        Line(multiplier=lambda p: -1.0 + 0.5 * ((p - centre) ** 2 - half**2)), within=(-1.0, 1.0)
    )
    found = sorted(point.value for point in graph.of_kind("period-doubling"))
    assert found == pytest.approx([centre - half, centre + half], abs=1e-12)
    np.testing.assert_allclose(
        graph["B1"].stable_intervals(), [(-1.0, centre - half), (centre + half, 1.0)], atol=1e-12
    )


@settings(max_examples=20, deadline=None)
@given(
    st.floats(0.2, 0.8),
    st.floats(5e-3, 0.05),
    st.sampled_from([0.999, 1.001, 0.98]),
    st.sampled_from([1.0, -1.0]),
)
def test_short_loss_of_stability_while_another_multiplier_is_nearer_to_the_circle(centre, half, near, side):
    """x -> +-(s x - x^3) at x = 0, where s = 1 + 4 (half^2 - (p - centre)^2), and y -> +-near y."""

    def right(x, p):
        s = 1.0 + 4.0 * (half**2 - (p.p - centre) ** 2)
        return [side * near * x[0], side * (s * x[1] - x[1] ** 3)]

    graph = cv.diagram(cv.MapProblem(right, [0.0, 0.0], {"p": 0.0}), over="p", within=(0.0, 1.0), depth=0)
    found = sorted(p.value for p in graph.of_kind("branch-point" if side > 0.0 else "period-doubling"))
    assert found == pytest.approx([centre - half, centre + half], abs=1e-9)


@pytest.mark.parametrize("centre", [0.43, 0.467, 0.5])
def test_short_loss_of_stability_in_two_directions_at_once(centre):
    """z -> (s + |z|^2) z in the plane, s = 1 + 4 (0.02^2 - (p - centre)^2)."""

    def right(x, p):
        return (1.0 + 4.0 * (0.02**2 - (p.p - centre) ** 2) + x @ x) * x

    graph = cv.diagram(cv.MapProblem(right, [0.0, 0.0], {"p": 0.0}), over="p", within=(0.0, 1.0), depth=0)
    found = sorted(point.value for point in graph.of_kind("branch-point"))
    assert found == pytest.approx([centre - 0.02, centre + 0.02], abs=1e-8)


def test_a_touch_from_above_is_no_event():
    graph = cv.diagram(Line(margin=lambda p: (p - 0.1234) ** 2 + 1e-9), within=(-1.0, 1.0))
    assert len(graph) == 1 and not graph.of_kind("velocity-graze")


def test_points_that_hit_a_special_point_exactly():
    """The start itself is the fold, the branch point, the zero of a user function."""
    fold = cv.diagram(cv.AlgebraicProblem(lambda u, p: p - u**2, [0.0], 0.0), within=(-1.0, 1.0))
    assert [p.value for p in fold.of_kind("fold")] == pytest.approx([0.0], abs=1e-14)
    for spectrum in ("none", "flow"):
        problem = cv.AlgebraicProblem(lambda x, p: p * x - x**2, [0.0], -0.5, spectrum=spectrum)
        graph = cv.diagram(problem, within=(-0.5, 0.5), settings={"first_step": 0.5, "max_step": 0.5})
        assert [p.value for p in graph.of_kind("branch-point")] == pytest.approx([0.0], abs=1e-14)
        assert len(graph) == 2
    line = cv.AlgebraicProblem(lambda u, p: u - p, [0.0], 0.0)
    graph = cv.diagram(line, within=(-1.0, 1.0), user_functions={"zero": lambda u, p: u[0]})
    assert [p.value for p in graph.of_kind("user")] == pytest.approx([0.0], abs=1e-15)


def test_a_vertical_branch_has_no_folds():
    """(p - 1/3) u = 0 and more: along p = 1/3 the parameter stands still."""
    problem = cv.AlgebraicProblem(lambda u, p: (p - 1.0 / 3.0) * (1.0 + u**2), [0.2], 1.0 / 3.0)
    graph = cv.diagram(problem, within=(-1.0, 1.0))
    assert not graph.of_kind("fold") and "run away" in graph["B1"].ended[0]


class Pair(Line):
    """u = p; two real multipliers meet, as a pair pass the circle and come back, x = (p - centre) / half: their product is D(x), their sum T(x)."""

    n_multipliers, n_margins = 3, 0

    def __init__(self, centre, half):
        def inspect_pair(data, u, p, work, row):
            x = (p - centre) / half
            product, mean = (
                0.3 + 0.9 * np.exp(-(x**2)),
                0.5 * (0.825 - 0.325 * np.tanh(2.0 * (x + 1.2))),
            )
            root = np.sqrt(complex(mean**2 - product))
            pair = sorted((mean + root, mean - root), key=lambda z: (-abs(z), -z.imag))
            row[:] = pair[0].real, pair[0].imag, pair[1].real, pair[1].imag, 0.1, 0.0

        super().__init__()
        self.kernels = Kernels(KERNELS.linearise, KERNELS.bordered, inspect_pair)


@settings(max_examples=40, deadline=None)
@given(st.floats(-0.6, 0.6), st.floats(6e-3, 0.03))
def test_a_pair_that_passes_the_circle_and_comes_back_in_the_step_in_which_it_comes_about(centre, half):
    """D = 1 at x^2 = ln(9/7)."""
    graph = cv.diagram(Pair(centre, half), within=(-1.0, 1.0))
    off = half * np.sqrt(np.log(9.0 / 7.0))
    found = sorted(point.value for point in graph.of_kind("neimark-sacker"))
    assert found == pytest.approx([centre - off, centre + off], abs=1e-9)


@pytest.mark.parametrize("slope", [1.0, 1e-4, 1e-8])
def test_told_errors_of_borders_cover_the_rounding_of_flat_margins(slope):
    """A margin that comes from 1 - (1 - m), so that it is known to 1.1e-16, passes zero at 0.3."""
    flat = Line(margin=lambda p: 1.0 - (1.0 - slope * (0.3 - p)), multiplier=lambda p: 0.5)
    border = cv.diagram(flat, within=(-1.0, 1.0))["VG1"]
    assert abs(border.value - 0.3) <= border.location_error
    assert 1e-16 / slope < border.location_error < 1e-15 / slope + 1e-15


class Bulge(Line):
    """u = p; the logarithms of a pair go from -depth + i angle to -depth + i (angle + turn) at p = 1e-4, by way of -depth + height halfway."""

    n_multipliers, n_margins, width = 2, 0, 1e-4

    def __init__(self, depth, height, turn):
        def inspect_pair(data, u, p, work, row):
            s = p / self.width
            z = np.exp(complex(-depth + 4.0 * height * s * (1.0 - s), 0.3 + turn * s))
            row[:] = z.real, z.imag, z.real, -z.imag

        super().__init__()
        self.kernels = Kernels(KERNELS.linearise, KERNELS.bordered, inspect_pair)


@pytest.mark.parametrize("turn", [0.3, -0.25])
@pytest.mark.parametrize("height", [0.06, 0.08, 0.12])
def test_a_pair_that_passes_the_circle_and_comes_back_before_the_first_point_of_a_branch(height, turn):
    """Two points, and none before or behind: that it may have, its way along the circle tells."""
    problem, depth = Bulge(0.05, height, turn), 0.05
    engine = Engine(problem, (-1.0, 1.0), Settings())
    origin, first = (engine.at_value(np.array([p]), p) for p in (0.0, problem.width))
    found = Detector(engine).beside(origin, first)
    off = 0.5 * np.sqrt(1.0 - depth / height)
    assert [event.kind for event in found] == ["neimark-sacker"] * 2
    assert [event.point.p / problem.width for event in found] == pytest.approx([0.5 - off, 0.5 + off])


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize("power", [3, 4])
def test_a_multiplier_that_grows_faster_than_is_extrapolated_is_infinite(power, side):
    """Like the inverse of the third power of the distance, and at the border itself nothing can be computed."""
    grown = Line(
        margin=lambda p: 0.3 - p,
        multiplier=lambda p: side * (0.3 - p) ** -power if p < 0.3 - 1e-15 else np.nan,
    )
    (limit,) = cv.diagram(grown, within=(-1.0, 1.0))["VG1"].multipliers
    assert abs(limit) >= 1e15 and limit.real * side > 0.0


def test_a_multiplier_beyond_one_before_the_first_point_of_a_branch():
    """x -> -(1 + q) x + x^3 doubles at q = 0 to x^2 = q, where y -> exp(g(x^2)) y - y^3 has g > 0 for q between A^2/4 and 3 A^2/4."""
    A = 0.0028

    def right(x, p):
        t = x[0] ** 2 / A**2
        return [-(1.0 + p.q) * x[0] + x[0] ** 3, x[1] * np.exp(-0.3 + 1.6 * t * (1.0 - t)) - x[1] ** 3]

    problem = cv.MapProblem(right, [0.0, 0.0], {"q": -0.2}, scale=1.0)
    graph = cv.diagram(problem, over="q", within=(-0.3, 1e-5), depth=1)
    points = [point for point in graph.of_kind("branch-point") if point.branch == "B2"]
    assert len(points) == 2
    for point, value in zip(points, (A**2 / 4, 3 * A**2 / 4)):
        assert point.value == pytest.approx(value, abs=min(point.location_error, 1e-2 * A**2))
