"""Narrow windows between two points: nothing changes sign at the points, and still nothing is missed."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

import contvines as cv
from tests.contvines.lines import Line

UNIT = (-1.0, 1.0)
CENTRES, HALVES = st.floats(-0.6, 0.6), st.floats(1e-3, 0.02)


def ends_where_it_dips(centre, half, other):
    """The branch ends where the first of two margins is lost for a short while, whatever the other one is."""
    graph = cv.diagram(Line(lambda u, p: [(p - centre) ** 2 - half**2, other(p)]), within=UNIT)
    assert graph["VG1"].value == pytest.approx(centre - half, abs=1e-12)
    assert graph["B1"].values[-1] == graph["VG1"].value


@settings(max_examples=80)
# between the ends of two chunks, another margin is lost in the next segment
@example(-0.1875, 0.0078125, 0.015625)
# a margin that is nearly zero at a point, lost right behind it
@example(0.289122949011563, 0.00390625, 0.0078125)
@given(CENTRES, HALVES, HALVES)
def test_short_loss_of_a_margin_before_another_one_is_lost(centre, half, later):
    """Though the next point lies beyond the other one."""
    ends_where_it_dips(centre, half, lambda p: centre + half + later - p)


@settings(max_examples=80)
@given(CENTRES, HALVES, st.floats(1e-9, 1e-2))
def test_short_loss_of_a_margin_that_is_not_the_smallest(centre, half, level):
    """Another margin is smaller nearly everywhere, and does not vanish."""
    ends_where_it_dips(centre, half, lambda p: level)


def test_a_touch_from_above_is_no_event():
    graph = cv.diagram(Line(lambda u, p: [(p - 0.1234) ** 2 + 1e-9]), within=UNIT)
    assert len(graph) == 1 and not graph.of_kind("velocity-graze")


@pytest.mark.parametrize("slope", [1.0, 1e-4, 1e-8])
def test_told_errors_of_borders_cover_the_rounding_of_flat_margins(slope):
    """A margin that comes from 1 - (1 - m), so that it is known to 1.1e-16, passes zero at 0.3."""
    flat = Line(lambda u, p: [1.0 - (1.0 - slope * (0.3 - p))])
    border = cv.diagram(flat, within=UNIT)["VG1"]
    assert abs(border.value - 0.3) <= border.location_error
    assert 1e-16 / slope < border.location_error < 1e-15 / slope + 1e-15


@settings(max_examples=40)
@given(CENTRES, st.floats(1e-3, 0.05))
def test_short_loss_of_stability(centre, half):
    problem = Line(multipliers=lambda u, p: [-1.0 + 0.5 * ((p - centre) ** 2 - half**2)])
    graph = cv.diagram(problem, within=UNIT)
    found = sorted(point.value for point in graph.of_kind("period-doubling"))
    assert found == pytest.approx([centre - half, centre + half], abs=1e-12)
    np.testing.assert_allclose(
        graph["B1"].stable_intervals(), [(-1.0, centre - half), (centre + half, 1.0)], atol=1e-12
    )


@settings(max_examples=20)
@given(
    st.floats(0.2, 0.8),
    st.floats(5e-3, 0.05),
    st.sampled_from([0.999, 1.001, 0.98]),
    st.sampled_from([1.0, -1.0]),
)
def test_short_loss_of_stability_while_another_multiplier_is_nearer_to_the_circle(centre, half, near, side):
    """x -> +-(s x - x^3) at x = 0, where s = 1 + 4 (half^2 - (p - centre)^2), and y -> +-near y."""

    def right(x, p):
        s = 1.0 + 4.0 * (half**2 - (p - centre) ** 2)
        return [side * near * x[0], side * (s * x[1] - x[1] ** 3)]

    graph = cv.diagram(cv.MapProblem(right, [0.0, 0.0], 0.0), within=(0.0, 1.0), depth=0)
    found = sorted(p.value for p in graph.of_kind("branch-point" if side > 0.0 else "period-doubling"))
    assert found == pytest.approx([centre - half, centre + half], abs=1e-9)


@pytest.mark.parametrize("centre", [0.43, 0.467, 0.5])
def test_short_loss_of_stability_in_two_directions_at_once(centre):
    """z -> (s + |z|^2) z in the plane, s = 1 + 4 (0.02^2 - (p - centre)^2)."""
    problem = cv.MapProblem(
        lambda x, p: (1.0 + 4.0 * (0.02**2 - (p - centre) ** 2) + x @ x) * x, [0.0, 0.0], 0.0
    )
    found = sorted(p.value for p in cv.diagram(problem, within=(0.0, 1.0), depth=0).of_kind("branch-point"))
    assert found == pytest.approx([centre - 0.02, centre + 0.02], abs=1e-8)


@settings(max_examples=40)
@given(CENTRES, st.floats(0.016, 0.03))
def test_a_pair_that_passes_the_circle_and_comes_back_in_the_step_in_which_it_comes_about(centre, half):
    """Two real multipliers meet, as a pair pass the circle and come back; with x = (p - centre) / half their product is 1 at x^2 = ln(9/7)."""

    def multipliers(u, p):
        x = (p - centre) / half
        product, mean = 0.3 + 0.9 * np.exp(-(x**2)), 0.5 * (0.825 - 0.325 * np.tanh(2.0 * (x + 1.2)))
        root = np.sqrt(complex(mean**2 - product))
        return [mean + root, mean - root, 0.1]

    graph = cv.diagram(Line(multipliers=multipliers), within=UNIT)
    off = half * np.sqrt(np.log(9.0 / 7.0))
    found = sorted(point.value for point in graph.of_kind("neimark-sacker"))
    assert found == pytest.approx([centre - off, centre + off], abs=1e-9)


@pytest.mark.parametrize(
    ("kind", "depth", "angle", "turn"),
    [
        ("branch-point", 0.3, 0.0, 0.0),
        ("neimark-sacker", 0.05, 0.3, 0.3),
        ("neimark-sacker", 0.05, 0.3, -0.25),
    ],
)
def test_a_multiplier_or_pair_that_is_outside_before_the_first_point_of_a_branch(kind, depth, angle, turn):
    """x -> -(1 + q) x + x^3 doubles at q = 0 to x^2 = q; beside that y grows by the factor exp(depth (16/3 t (1 - t) - 1)), t = q / A^2.

    It is above 1 for t between 1/4 and 3/4. A pair turns by the angle, too; where there are two points only, its way along the circle tells.
    """
    A = 0.0028
    n = 1 if kind == "branch-point" else 2

    def right(x, p):
        t, y = x[0] ** 2 / A**2, np.append(x[1:], 0.0)[:2]
        c, s = np.cos(angle + turn * t), np.sin(angle + turn * t)
        grown = np.exp(depth * (16.0 / 3.0 * t * (1.0 - t) - 1.0)) * np.array(
            [c * y[0] - s * y[1], s * y[0] + c * y[1]]
        )
        return [-(1.0 + p) * x[0] + x[0] ** 3, *(grown - y * (y @ y))[:n]]

    graph = cv.diagram(cv.MapProblem(right, np.zeros(n + 1), -0.2, scale=1.0), within=(-0.3, 2e-5), depth=1)
    points = [point for point in graph.of_kind(kind) if point.branch == "B2"]
    assert len(points) == 2
    for point, value in zip(points, (A**2 / 4, 3 * A**2 / 4)):
        assert point.value == pytest.approx(value, abs=min(point.location_error, 1e-2 * A**2))


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize("power", [3, 4])
def test_a_multiplier_that_grows_faster_than_is_extrapolated_is_infinite(power, side):
    """Like the inverse of the third power of the distance, and at the border itself nothing can be computed."""
    grown = Line(
        lambda u, p: [0.3 - p],
        lambda u, p: [side * (0.3 - p) ** -power if p < 0.3 - 1e-15 else np.nan],
    )
    (limit,) = cv.diagram(grown, within=UNIT)["VG1"].multipliers
    assert abs(limit) >= 1e15 and limit.real * side > 0.0


def test_points_that_hit_a_special_point_exactly():
    """A step ends at the branch point; the start is the zero of a user's function."""
    for spectrum in ("none", "flow"):
        problem = cv.AlgebraicProblem(lambda x, p: p * x - x**2, [0.0], -0.5, spectrum=spectrum)
        graph = cv.diagram(problem, within=(-0.5, 0.5), settings={"first_step": 0.5, "max_step": 0.5})
        assert [p.value for p in graph.of_kind("branch-point")] == pytest.approx([0.0], abs=1e-14)
        assert len(graph) == 2
    line = cv.AlgebraicProblem(lambda u, p: u - p, [0.0], 0.0)
    graph = cv.diagram(line, within=UNIT, user_functions={"zero": lambda u, p: u[0]})
    assert [p.value for p in graph.of_kind("user")] == pytest.approx([0.0], abs=1e-15)


def test_a_vertical_branch_has_no_folds():
    """(p - 1/3) u = 0 and more: along p = 1/3 the parameter stands still."""
    problem = cv.AlgebraicProblem(lambda u, p: (p - 1.0 / 3.0) * (1.0 + u**2), [0.2], 1.0 / 3.0)
    graph = cv.diagram(problem, within=UNIT)
    assert not graph.of_kind("fold") and "run away" in graph["B1"].ended[0]
