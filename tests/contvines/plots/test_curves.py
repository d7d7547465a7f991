"""Curves: angles that wrap, cycles with all their points, corners, scales and limits."""

import dataclasses

import numpy as np
import pytest

import contvines as cv
from contvines.plots import plot_diagram
from contvines.problems.protocol import ProblemDefaults
from tests.contvines import fakes


@pytest.fixture
def graph():
    return fakes.pitchfork_graph()


def test_an_angle_is_not_drawn_across_the_picture_where_it_wraps():
    class Problem(ProblemDefaults):
        measure_names, default_measure, angles = ("turn", "other"), "turn", ("turn",)

        def measures(self, names, u, p):
            return {name: np.mod(8 * p, 2 * np.pi) for name in names}

    graph = fakes.pitchfork_graph()
    for branch in graph.branches.values():
        branch.problem = Problem()

    def longest(y):
        """The longest step that is drawn, and where lines have gaps."""
        lines = [line.get_xydata() for line in plot_diagram(graph, y=y).axes[0].lines]
        steps = np.concatenate([np.abs(np.diff(line[:, 1])) for line in lines if len(line) > 1])
        gaps = sum(np.isnan(line[:, 1]).sum() for line in lines)
        return np.nanmax(steps), gaps

    # 8 p passes -2 pi, 0 and 2 pi on B1 (p in [-1, 1]), 2 pi on B2 (p in [0, 1]) and on B3 (p in [0.5, 1])
    assert longest("other") == (pytest.approx(2 * np.pi, abs=0.5), 0)
    step, gaps = longest("turn")
    assert step < 0.8
    assert gaps == 5
    texts = {t.get_text() for t in plot_diagram(graph, y="turn").axes[0].texts}
    assert {"B1", "B2", "B3"} & texts  # broken lines have their labels, too


def test_a_curve_has_no_corners_where_few_points_were_stored(graph):
    """x = p^2 from 5 points: the drawn line follows the parabola to a thousandth of its height."""
    branch = graph.branches["B2"]
    keep = [0, 3, 7, 15, 30]
    graph.branches = {"B2": dataclasses.replace(
        branch, points=branch.points[keep], values=branch.values[keep], tangents=branch.tangents[keep],
        multipliers=branch.multipliers[keep], margin=branch.margin[keep], stable=branch.stable[keep],
        marks=())}  # fmt: skip
    x = branch.points[keep, 0]
    slopes = np.column_stack([np.ones(5), 2 * x])  # of (x, p = x^2), by hand
    graph.branches["B2"].tangents = slopes / np.linalg.norm(slopes, axis=1)[:, None]
    graph.special = {}
    line = max(plot_diagram(graph, y="u0").axes[0].lines, key=lambda entry: len(entry.get_xdata()))
    p, x = np.asarray(line.get_xdata()), np.asarray(line.get_ydata())
    assert len(p) > 20
    assert np.abs(p - x**2).max() < 2e-3


def test_limits_are_laid_out_again(graph):
    figure = plot_diagram(graph, xlim=(-0.2, 0.2), ylim=(-0.2, 0.6))
    axes = figure.axes[0]
    assert axes.get_xlim() == (-0.2, 0.2)
    assert {t.get_text() for t in axes.texts} >= {"BP1", "B1", "B2"}
    assert "EP1" not in {t.get_text() for t in axes.texts}
    axes.set_xlim(0.5, 1.1)  # as a zoom with the mouse
    figure.canvas.draw()
    texts = {t.get_text() for t in axes.texts}
    assert "BP1" not in texts
    for text in axes.texts:
        box, frame = text.get_window_extent(), axes.get_window_extent()
        assert frame.x0 - 5 < box.x0 and box.x1 < frame.x1 + 5


def test_a_cycle_is_drawn_with_all_its_points():
    """The logistic map's 2-cycle at p = 3.3: both points, by hand (1 + p +- sqrt((p - 3)(p + 1)))/(2 p)."""
    problem = cv.MapProblem(lambda x, p: p * x * (1 - x), [0.6], 2.8)
    graph = cv.diagram(problem, within=(2.7, 3.4), depth=1)
    axes = plot_diagram(graph, y="x0", xlim=(2.7, 3.4)).axes[0]
    for sign in (-1, 1):
        x = (1 + 3.3 + sign * np.sqrt(0.3 * 4.3)) / 6.6
        lines = [line.get_xydata() for line in axes.lines if len(line.get_xdata()) > 1]
        near = [np.interp(3.3, *xy[np.argsort(xy[:, 0])].T) for xy in lines if np.ptp(xy[:, 0]) > 0.1]
        assert np.abs(np.array(near) - x).min() < 1e-4


def test_a_branch_that_runs_away_does_not_set_the_scale(graph):
    branch = graph.branches["B2"]
    points = branch.points.copy()
    points[-1] = 1e6
    branch.points = points
    graph.special.pop("EP1")
    low, high = plot_diagram(graph, y="u0").axes[0].get_ylim()
    assert high < 10


def test_a_zoom_across_is_as_high_as_what_is_seen(graph):
    """On B2, u = sqrt(p), and on B1, u = 0: within [0.01, 0.04] they span 0 to 0.2."""
    graph.branches.pop("B3")
    low, high = plot_diagram(graph, y="u0", xlim=(0.01, 0.04)).axes[0].get_ylim()
    assert -0.05 < low < 0.0 and 0.2 < high < 0.25
    assert plot_diagram(graph, y="u0", xlim=(0.01, 0.04), ylim=(-1, 1)).axes[0].get_ylim() == (-1, 1)
    graph.branches.pop("B2")  # a level line has a height, too
    low, high = plot_diagram(graph, y="u0", xlim=(-0.5, -0.4)).axes[0].get_ylim()
    assert low < 0.0 < high
