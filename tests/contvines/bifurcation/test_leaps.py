"""Two branches that nearly touch: a step that is longer than their gap does not lead from one to the other."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

import contvines as cv
from tests.contvines.lines import Line

GAPS = st.floats(-5.0, -1.5).map(lambda exponent: 10.0**exponent)
SIDES = st.sampled_from([-1.0, 1.0])


def followed(gap, u, p, **options):
    """Along u^2 - p^2 = gap |gap|, two branches at a distance of 2 |gap|, on the asymptotes u = +-p: unknowns, values and the graph."""
    problem = cv.AlgebraicProblem(lambda x, q: x**2 - q**2 - gap * abs(gap), [u], p, **options)
    graph = cv.diagram(problem, within=(-1.5, 1.0))
    return graph["B1"].points[:, 0], graph["B1"].values, graph


@settings(max_examples=12)
@given(GAPS, SIDES, st.sampled_from(["none", "flow"]))
@example(1e-3, 1.0, "none")
@example(1e-4, -1.0, "flow")
def test_a_branch_that_turns_away(gap, side, spectrum):
    """u = +-sqrt(p^2 + gap^2) stays on its side; neither folds nor branch points."""
    u, p, graph = followed(gap, side * np.hypot(1.0, gap), -1.0, spectrum=spectrum)
    assert list(graph.branches) == ["B1"] and graph["B1"].range == (-1.5, 1.0)
    assert [point.kind for point in graph.special.values()] == ["end", "end"]
    np.testing.assert_allclose(u, side * np.hypot(p, gap), rtol=1e-9, atol=1e-12)


@settings(max_examples=12)
@given(GAPS, SIDES)
@example(1e-3, 1.0)
def test_a_branch_that_turns_back(gap, side):
    """p = -sqrt(u^2 + gap^2) has its fold at u = 0."""
    u, p, graph = followed(-gap, side, -np.hypot(1.0, gap))
    assert list(graph.branches) == ["B1"]
    assert sorted(point.kind for point in graph.special.values()) == ["end", "end", "fold"]
    assert graph["LP1"].value == pytest.approx(-gap, rel=1e-9)
    np.testing.assert_allclose(p, -np.hypot(u, gap), rtol=1e-9, atol=1e-12)


def test_branches_that_do_touch():
    """Without a gap there is a branch point, and the branch goes straight on."""
    u, p, graph = followed(0.0, 1.0, -1.0)
    (point,) = graph.of_kind("branch-point")
    assert abs(point.value) < 1e-12 and len(graph) == 2
    np.testing.assert_allclose(u, -p, atol=1e-9)


def test_no_border_on_another_branch():
    """Below the floor u = 0 lies the other branch of u^2 - p^2 = 1e-6; that is no border of the upper one, which never touches it."""
    floor = Line(
        lambda u, p: [u], curve=lambda u, p: (u**2 - p**2 - 1e-6, 2.0 * u, -2.0 * p), start=(1.0, -1.0)
    )
    graph = cv.diagram(floor, within=(-1.0, 1.0))
    assert [point.kind for point in graph.special.values()] == ["end", "end"]
    assert graph["B1"].points.min() > 0.0
    assert graph["B1"].points[-1, 0] == pytest.approx(np.sqrt(1.0 + 1e-6), abs=1e-12)
