"""Two branches that nearly touch: a step that is longer than their gap does not lead from one to the other."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

import contvines as cv
from contvines.problems.dense import KERNELS, DenseWork
from contvines.problems.protocol import Kernels, ProblemDefaults

GAPS = st.floats(-5.0, -1.5).map(lambda exponent: 10.0**exponent)


def hyperbola(gap, u, p, **options):
    """u^2 - p^2 = gap |gap|: two branches at a distance of 2 |gap|, on the asymptotes u = +-p."""
    return cv.AlgebraicProblem(lambda x, q: x**2 - q**2 - gap * abs(gap), [u], p, **options)


@settings(max_examples=12, deadline=None)
@given(GAPS, st.sampled_from([-1.0, 1.0]), st.sampled_from(["none", "flow"]))
@example(1e-3, 1.0, "none")
@example(1e-4, -1.0, "flow")
def test_a_branch_that_turns_away(gap, side, spectrum):
    """u = +-sqrt(p^2 + gap^2) stays on its side; neither folds nor branch points."""
    problem = hyperbola(gap, side * np.hypot(1.0, gap), -1.0, spectrum=spectrum)
    graph = cv.diagram(problem, within=(-1.0, 1.0))
    assert list(graph.branches) == ["B1"] and graph["B1"].range == (-1.0, 1.0)
    assert [point.kind for point in graph.special.values()] == ["end", "end"]
    np.testing.assert_allclose(
        graph["B1"].points[:, 0], side * np.hypot(graph["B1"].values, gap), rtol=1e-9, atol=1e-12
    )


@settings(max_examples=12, deadline=None)
@given(GAPS, st.sampled_from([-1.0, 1.0]))
@example(1e-3, 1.0)
def test_a_branch_that_turns_back(gap, side):
    """p = -sqrt(u^2 + gap^2) has its fold at u = 0."""
    problem = hyperbola(-gap, side, -np.hypot(1.0, gap))
    graph = cv.diagram(problem, within=(-1.5, 1.5))
    assert list(graph.branches) == ["B1"]
    kinds = [point.kind for point in graph.special.values()]
    assert sorted(kinds) == ["end", "end", "fold"]
    assert graph["LP1"].value == pytest.approx(-gap, rel=1e-9)
    np.testing.assert_allclose(
        graph["B1"].values, -np.hypot(graph["B1"].points[:, 0], gap), rtol=1e-9, atol=1e-12
    )


def test_branches_that_do_touch():
    """Without a gap there is a branch point, and the branch goes straight on."""
    graph = cv.diagram(hyperbola(0.0, 1.0, -1.0), within=(-1.0, 1.0))
    assert [point.kind for point in graph.of_kind("branch-point")] == ["branch-point"]
    assert abs(graph["BP1"].value) < 1e-12
    np.testing.assert_allclose(graph["B1"].points[:, 0], -graph["B1"].values, atol=1e-9)
    assert len(graph) == 2


def inspect(data, u, p, work, row):
    row[0] = u[0]


class Floor(ProblemDefaults):
    """u^2 - p^2 = 1e-6 above the floor u = 0: the upper branch never touches it."""

    dimension, n_margins, u0, p0 = 1, 1, np.array([1.0]), -1.0
    kernels = Kernels(KERNELS.linearise, KERNELS.bordered, inspect)

    def __init__(self):
        self.data = self

    def workspace(self):
        return DenseWork(1)

    def equations(self, u, p):
        return u**2 - p**2 - 1e-6, np.diag(2.0 * u), np.array([-2.0 * p])

    def margin_kind(self, j):
        return "velocity-graze"


def test_no_border_on_another_branch():
    """The other branch lies below the floor; that is no border of this one."""
    graph = cv.diagram(Floor(), within=(-1.0, 1.0))
    assert [point.kind for point in graph.special.values()] == ["end", "end"]
    assert graph["B1"].points.min() > 0.0
    assert graph["B1"].points[-1, 0] == pytest.approx(np.sqrt(1.0 + 1e-6), abs=1e-12)
