"""The diagram: what is drawn, marked, labelled, and what the legend says of it."""

from itertools import combinations

import matplotlib as mpl
import numpy as np
import pytest

import contvines as cv
from contvines.plots import plot_diagram
from contvines.plots.style import LINES
from contvines.problems.protocol import ProblemDefaults
from tests.contvines import fakes
from tests.contvines.flows.shooting import van_der_pol


def texts(artists):
    return {artist.get_text() for artist in artists}


def curves_on(axes):
    return [line for line in axes.lines if len(line.get_xdata()) > 1]


def dashes(state):
    """How matplotlib itself notes the dashes of a line drawn in the style of a state."""
    return mpl.lines.Line2D([], [], linestyle=LINES[state], linewidth=1.5)._unscaled_dash_pattern[1]


def test_line_styles_say_stable_unstable_virtual(graph):
    axes = plot_diagram(graph).axes[0]
    seen = {}
    for curve in curves_on(axes):
        seen.setdefault(curve._unscaled_dash_pattern[1], []).append(curve)
    stable = seen[None]
    lengths = {len(c.get_xdata()) for c in stable}
    assert 21 in lengths and max(lengths) >= 31  # the lower half of B1, all of B2 and what makes it round
    (unstable,) = seen[dashes("unstable")]
    assert unstable.get_xdata()[0] == 0.0 and unstable.get_xdata()[-1] == 1.0
    # a virtual branch is dotted throughout, whatever its multipliers say
    assert {x for c in seen[dashes("virtual")] for x in c.get_xdata()} == set(graph.branches["B3"].values)


def test_special_points_are_marked_labelled_and_explained(graph):
    figure = plot_diagram(graph, ends=True)
    figure.canvas.draw()
    axes = figure.axes[0]
    boxes = [text.get_window_extent() for text in axes.texts]
    assert not any(one.overlaps(other) for one, other in combinations(boxes, 2))
    assert {"BP1", "VG1", "EP1", "B1", "B2", "B3"} <= texts(axes.texts)
    assert texts(axes.get_legend().get_texts()) == {
        "stable", "unstable", "virtual (beyond a border)", "branch point", "velocity graze", "end of the interval",
    }  # fmt: skip
    assert [[0.0, 0.0]] in [line.get_xydata().tolist() for line in axes.lines]  # the mark of BP1


def test_branches_without_the_measure_are_named_in_the_legend(graph):
    class Problem(ProblemDefaults):
        measure_names, default_measure = ("B", "max_abs_w"), "B"

        def __init__(self, B):
            self.B = B

        def measures(self, names, u, p):
            known = {"B": self.B * u[:, 0], "max_abs_w": u[:, 0] + 2}
            return {name: known[name] for name in names}

    for branch, word, impacts, B in zip(
        graph, ("LR", "", "tt"), (2, 0, 0), (1.0, np.nan, np.nan), strict=True
    ):
        branch.problem = Problem(B)
        branch.description = {**branch.description, "word": word, "impacts": impacts}
    axes = plot_diagram(graph).axes[0]
    assert "not drawn: B2, B3 (no impacts)" in texts(axes.get_legend().get_texts())


def test_chosen_labels_only(graph):
    axes = plot_diagram(graph, labels=["BP1"]).axes[0]
    assert texts(axes.texts) == {"BP1"}


def test_colours_may_stand_for_stability_or_words(graph):
    axes = plot_diagram(graph, color="stability").axes[0]
    by_dash = {}
    for line in curves_on(axes):
        by_dash.setdefault(line._unscaled_dash_pattern[1], set()).add(line.get_color())
    assert all(len(colors) == 1 for colors in by_dash.values())
    assert len(set.union(*by_dash.values())) == 3
    for branch, word in zip(graph.branches.values(), ("LR", "tt", "LR"), strict=True):
        branch.description = {**branch.description, "word": word}
    axes = plot_diagram(graph, color="word", words=True).axes[0]
    assert {"LR", "tt"} <= texts(axes.texts)
    assert {"LR", "tt"} <= texts(axes.get_legend().get_texts())


def test_two_graphs_on_the_same_axes(graph):
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots()
    plot_diagram(graph, axes=axes)
    plot_diagram(fakes.pitchfork_graph(), y="u0", axes=axes, name="second")
    plot_diagram(fakes.pitchfork_graph(), axes=axes)
    names = texts(axes.texts)
    assert "BP1" in names and any(n.startswith("second ") for n in names)
    legend = [t.get_text() for t in axes.get_legend().get_texts()]
    assert len(legend) == len(set(legend))
    assert len({line.get_color() for line in curves_on(axes)}) >= 6
    axes.clear()
    assert "BP1" in texts(plot_diagram(graph, axes=axes).axes[0].texts)  # alone again
    plt.close(figure)


def test_a_family_of_cycles_at_one_value_does_not_set_the_height():
    """Van der Pol: a linear oscillator at mu = 0, with cycles of all amplitudes; those at other values have an amplitude near 2."""
    flow = cv.FlowProblem(van_der_pol, [0.0, 0.0], {"mu": -0.5})
    graph = cv.diagram(flow, over="mu", within=(-0.5, 1.0))
    assert max(branch.measure("max x0").max() for branch in graph.branches.values()) > 50.0
    low, high = graph.plot(y="max x0").axes[0].get_ylim()
    assert -2.0 < low < 0.0 and 2.0 < high < 5.0


def test_an_angle_is_not_drawn_across_the_picture_where_it_wraps(graph):
    class Problem(ProblemDefaults):
        measure_names, default_measure, angles = ("turn", "other"), "turn", ("turn",)

        def measures(self, names, u, p):
            return {name: np.mod(8 * p, 2 * np.pi) for name in names}

    for branch in graph:
        branch.problem = Problem()

    def longest(y):
        """The longest step that is drawn, and where lines have gaps."""
        heights = [line.get_ydata() for line in curves_on(plot_diagram(graph, y=y).axes[0])]
        steps = np.concatenate([np.abs(np.diff(line)) for line in heights])
        gaps = sum(np.isnan(line).sum() for line in heights)
        return np.nanmax(steps), gaps

    # 8 p passes -2 pi, 0 and 2 pi on B1 (p in [-1, 1]), 2 pi on B2 (p in [0, 1]) and on B3 (p in [0.5, 1])
    assert longest("other") == (pytest.approx(2 * np.pi, abs=0.5), 0)
    step, gaps = longest("turn")
    assert step < 0.8
    assert gaps == 5
    assert {"B1", "B2", "B3"} & texts(
        plot_diagram(graph, y="turn").axes[0].texts
    )  # broken lines have their labels, too
