"""Curves: angles that wrap, cycles with all their points, corners, scales and limits."""

import numpy as np
import pytest

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
