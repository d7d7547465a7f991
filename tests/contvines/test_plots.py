"""Pictures: what is drawn, in which style, and what the legend says of it."""

import dataclasses
import itertools
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pytest

from contvines.graph.graph import Switch
from contvines.plots import plot_diagram, plot_multipliers, plot_network, plot_portrait, save_figure
from contvines.plots.figures import HOUSE as STYLE
from contvines.plots.figures import check_picture
from contvines.plots.style import LINES, MARKS
from contvines.special import PREFIXES
from tests.contvines import fakes


@pytest.fixture
def graph():
    return fakes.pitchfork_graph()


def dashes(state):
    """How matplotlib itself notes the dashes of a line drawn in the style of a state."""
    return mpl.lines.Line2D([], [], linestyle=LINES[state], linewidth=1.5)._unscaled_dash_pattern[1]


def test_line_styles_say_stable_unstable_virtual(graph):
    axes = plot_diagram(graph).axes[0]
    curves = [line for line in axes.lines if len(line.get_xdata()) > 1]
    seen = {}
    for curve in curves:
        seen.setdefault(curve._unscaled_dash_pattern[1], []).append(curve)
    stable = seen[None]
    lengths = {len(c.get_xdata()) for c in stable}
    assert 21 in lengths and max(lengths) >= 31  # the lower half of B1, all of B2 and what makes it round
    (unstable,) = seen[dashes("unstable")]
    assert unstable.get_xdata()[0] == 0.0 and unstable.get_xdata()[-1] == 1.0
    # a virtual branch is dotted throughout, whatever its multipliers say
    assert {x for c in seen[dashes("virtual")] for x in c.get_xdata()} == set(graph.branches["B3"].values)


def test_special_points_are_marked_labelled_and_explained(graph):
    axes = plot_diagram(graph, ends=True).axes[0]
    texts = {t.get_text() for t in axes.texts}
    assert {"BP1", "VG1", "EP1", "B1", "B2", "B3"} <= texts
    legend = {t.get_text() for t in axes.get_legend().get_texts()}
    assert legend == {
        "stable", "unstable", "virtual (beyond a border)", "branch point", "velocity graze", "end of the interval",
    }  # fmt: skip
    marks = {
        (float(m.get_xdata()[0]), float(m.get_ydata()[0])) for m in axes.lines if len(m.get_xdata()) == 1
    }
    assert (0.0, 0.0) in marks


def test_labels_do_not_cover_one_another(graph):
    figure = plot_diagram(graph)
    figure.canvas.draw()
    boxes = [t.get_window_extent() for t in figure.axes[0].texts]
    for i, one in enumerate(boxes):
        assert not any(one.overlaps(other) for other in boxes[i + 1 :])


def impactless(words, values):
    """The fake graph, its branches with these words and a measure B that is `values` times u on each."""

    class Problem:
        measure_names, default_measure = ("B", "max_abs_w"), "B"

        def __init__(self, B):
            self.B = B

        def measures(self, names, u, p):
            known = {"B": self.B * u[:, 0], "max_abs_w": u[:, 0] + 2}
            return {name: known[name] for name in names}

    graph = fakes.pitchfork_graph()
    for branch, word, value in zip(graph.branches.values(), words, values, strict=True):
        branch.problem, branch.description = Problem(value), {**branch.description, "word": word}
    return graph


def test_branches_without_the_measure_are_named_in_the_legend():
    axes = plot_diagram(impactless(("LR", "", "tt"), (1.0, np.nan, np.nan))).axes[0]
    assert "not drawn: B2, B3 (no impacts)" in {t.get_text() for t in axes.get_legend().get_texts()}


def test_where_no_branch_has_the_measure_another_is_drawn():
    axes = plot_diagram(impactless(("ss", "", "tt"), (np.nan,) * 3)).axes[0]
    assert axes.get_ylabel() == "largest $|w|$"
    assert not any("not drawn" in t.get_text() for t in axes.get_legend().get_texts())


def test_labels_keep_out_of_the_legend(graph):
    for y in ("norm", "p"):
        figure = plot_diagram(graph, y=y, ends=True)
        figure.canvas.draw()
        legend = figure.axes[0].get_legend().get_window_extent()
        texts = [t for t in figure.axes[0].texts if t.get_window_extent().overlaps(legend)]
        assert not texts


def test_a_legend_that_would_cover_curves_stands_beside_them(graph):
    branch = graph.branches["B1"]  # a zigzag over the whole picture leaves no room
    branch.points = np.where(np.arange(len(branch)) % 2, 2.0, 0.0)[:, None]
    figure = plot_diagram(graph)
    figure.canvas.draw()
    axes = figure.axes[0]
    legend = axes.get_legend().get_window_extent()
    assert legend.x0 >= axes.get_window_extent().x1 - 1
    assert legend.x1 <= figure.bbox.x1


def test_an_angle_is_not_drawn_across_the_picture_where_it_wraps():
    class Problem:
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


def test_every_kind_has_a_mark():
    assert set(MARKS) == set(PREFIXES)


def test_an_unfinished_graph_says_so():
    axes = plot_diagram(fakes.pitchfork_graph(finished=False)).axes[0]
    assert "unfinished" in [axes.get_title(loc=loc) for loc in ("left", "center", "right")]


def test_an_unknown_measure_is_refused_with_those_that_can_be_had(graph):
    with pytest.raises(ValueError, match="B1 has no measure 'speed'; choose one of norm, p"):
        plot_diagram(graph, y="speed")


def test_network_has_a_box_per_branch_and_names_the_switches(graph):
    texts = [t.get_text() for t in plot_network(graph).axes[0].texts]
    assert [t.split()[0] for t in texts[:3]] == ["B1", "B2", "B3"]
    assert texts[3:] == ["BP1", "VG1"]


def chain(length):
    """A graph of branches one behind the other, real ones of one point and narrow ranges."""
    graph = fakes.pitchfork_graph()
    first = graph.branches["B2"]
    names = [f"B{i + 1}" for i in range(length)]
    graph.branches = {n: dataclasses.replace(first, label=n, seed=None, marks=()) for n in names}
    graph.switches = [Switch("VG1", a, b, "velocity-graze") for a, b in itertools.pairwise(names)]
    return graph


def test_a_long_network_goes_on_below():
    figure = plot_network(chain(20))
    assert figure.get_size_inches()[0] < 25
    texts = figure.axes[0].texts[:20]
    assert [t.get_text().split()[0] for t in texts] == [f"B{i + 1}" for i in range(20)]
    places = np.array([t.get_position() for t in texts])
    steps = np.abs(np.diff(places, axis=0))
    assert np.allclose(steps.sum(axis=1), 1)  # each box stands beside the one before
    assert len({tuple(p) for p in places}) == 20
    figure.canvas.draw()
    boxes = [t.get_window_extent() for t in texts]
    assert not any(a.overlaps(b) for a, b in itertools.combinations(boxes, 2))


def test_arrows_past_a_box_have_their_labels_beside_it():
    graph = chain(9)  # the seventh to ninth branch leave the sixth: below it, one under the other
    graph.switches[6:] = [Switch(f"PD{i}", "B6", f"B{i}", "period-doubling") for i in (8, 9)]
    figure = plot_network(graph)
    figure.canvas.draw()
    boxes, labels = figure.axes[0].texts[:9], figure.axes[0].texts[9:]
    assert {"PD8", "PD9"} <= {t.get_text() for t in labels}
    for label in labels:
        extent = label.get_window_extent()
        assert not any(extent.overlaps(box.get_window_extent()) for box in boxes)
        assert figure.bbox.x0 < extent.x0 and extent.x1 < figure.bbox.x1


def test_network_captions_tell_ends_apart_and_shorten_words():
    graph = chain(3)
    one, two, three = graph.branches.values()
    one.values = np.linspace(0.990001, 0.990002, 31)
    two.values = np.full(31, 0.25)
    for branch, word in ((one, "LtRLttR" * 8), (two, ""), (three, "LR")):
        branch.description = {"word": word, "periods": 1, "name": "stuck" if not word else "P"}
    texts = [t.get_text() for t in plot_network(graph).axes[0].texts[:3]]
    assert texts[0] == "B1  (LtRLttR)^8  k=1\np 0.990001 to 0.990002"
    assert texts[1] == "B2  stuck  k=1\np 0.25"
    assert texts[2].startswith("B3  LR  k=1")


def test_multipliers_are_drawn_with_the_unit_circle(graph):
    left, right = plot_multipliers(graph.branches["B2"]).axes[:2]
    assert np.allclose(left.lines[0].get_ydata(), 2 * graph.branches["B2"].points[:, 0] ** 2)
    circle = np.hypot(right.lines[0].get_xdata(), right.lines[0].get_ydata())
    assert np.allclose(circle, 1.0)
    graph.branches["B2"].multipliers = np.empty((31, 0))
    with pytest.raises(ValueError, match="B2 has no multipliers"):
        plot_multipliers(graph.branches["B2"])


def test_portrait_asks_the_orbit_first():
    class Orbit:
        def plot(self):
            return plot_portrait(np.array([[0.0, 1.0], [1.0, 0.0]]))

    assert plot_portrait(Orbit()).axes[0].lines[0].get_xdata().tolist() == [0.0, 1.0]


def test_pictures_are_saved_and_the_users_settings_stay(graph, tmp_path):
    before = dict(mpl.rcParams)
    for name in ("a.png", "a.pdf", "a.svg"):
        save_figure(plot_diagram(graph), tmp_path / name)
        assert (tmp_path / name).stat().st_size > 4000
    assert dict(mpl.rcParams) == before
    assert STYLE.exists()


@pytest.mark.parametrize("name", ["a.doc", "a", "none/a.png"])
def test_a_picture_that_cannot_be_written_is_refused_before_work(tmp_path, name):
    with pytest.raises(ValueError, match=r"must end in|there is no folder"):
        check_picture(tmp_path / name)


def test_colours_differ_in_grey():
    """Neighbouring branches must be told apart on a grey printer: by luminance (ITU-R BT.601)."""
    style = mpl.rc_params_from_file(STYLE, use_default_template=False)
    grey = [np.dot(mpl.colors.to_rgb(c["color"]), [0.299, 0.587, 0.114]) for c in style["axes.prop_cycle"]]
    assert max(grey) < 0.55  # dark enough on white
    assert min(abs(a - b) for a, b in itertools.pairwise(grey)) > 0.05


def test_both_packages_draw_in_one_style():
    root = Path(__file__).parents[2]
    ours, theirs = root / "contvines/plots/contvines.mplstyle", root / "orbits/plots/house.mplstyle"
    assert ours.read_text() == theirs.read_text()
