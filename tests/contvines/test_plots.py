"""Pictures: what is drawn, in which style, and what the legend says of it."""

import dataclasses
import itertools
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pytest

import contvines as cv
from contvines.events.kinds import PREFIXES
from contvines.graph.graph import Switch
from contvines.plots import plot_diagram, plot_multipliers, plot_network, plot_portrait, save_figure
from contvines.plots.figures import HOUSE as STYLE
from contvines.plots.figures import check_picture
from contvines.plots.style import LINES, MARKS
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
        branch.problem, branch.description = (
            Problem(value),
            {
                **branch.description,
                "word": word,
                "impacts": sum(letter in "LR" for letter in word),
            },
        )
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


def test_the_users_own_settings_come_before_ours(graph):
    with mpl.rc_context({"axes.labelcolor": "#ff0000", "lines.linewidth": 5.0}):
        axes = plot_diagram(graph).axes[0]
        assert axes.xaxis.label.get_color() == "#ff0000"
        assert max(line.get_linewidth() for line in axes.lines) > 5.0
    axes = plot_diagram(graph, style={"axes.labelcolor": "#00ff00"}).axes[0]
    assert axes.xaxis.label.get_color() == "#00ff00"
    assert plot_diagram(graph, style="ggplot").axes[0].get_facecolor()[:3] == mpl.colors.to_rgb("#E5E5E5")


def test_figures_do_not_pile_up_and_show_themselves_in_a_notebook(graph):
    import matplotlib.pyplot as plt

    before = plt.get_fignums()
    figure = plot_diagram(graph)
    assert plt.get_fignums() == before
    assert figure._repr_png_().startswith(b"\x89PNG")


@pytest.mark.parametrize("size", [(3.4, 2.4), (2.6, 2.2), (10.0, 6.0)])
def test_nothing_is_cut_at_any_size(graph, size):
    figure = plot_diagram(graph, figsize=size)
    figure.canvas.draw()
    page, axes = figure.bbox, figure.axes[0]
    assert axes.get_window_extent().width > 0.5 * page.width
    assert axes.get_window_extent().height > 0.35 * page.height
    legends = [axes.get_legend(), *figure.legends]
    for thing in (axes.xaxis.label, axes.yaxis.label, *axes.texts, *filter(None, legends)):
        box = thing.get_window_extent()
        assert box.x0 >= page.x0 - 1 and box.x1 <= page.x1 + 1
        assert box.y0 >= page.y0 - 1 and box.y1 <= page.y1 + 1


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


def test_chosen_labels_only(graph):
    axes = plot_diagram(graph, labels=["BP1"]).axes[0]
    assert [t.get_text() for t in axes.texts] == ["BP1"]
    with pytest.raises(ValueError, match="the graph has no 'LP7'"):
        plot_diagram(graph, labels=["LP7"])
    with pytest.raises(ValueError, match="give True, False or a list"):
        plot_diagram(graph, labels="BP1")


def test_colours_may_stand_for_stability_or_words(graph):
    axes = plot_diagram(graph, color="stability").axes[0]
    by_dash = {}
    for line in axes.lines:
        if len(line.get_xdata()) > 1:
            by_dash.setdefault(line._unscaled_dash_pattern[1], set()).add(line.get_color())
    assert all(len(colors) == 1 for colors in by_dash.values())
    assert len(set.union(*by_dash.values())) == 3
    for branch, word in zip(graph.branches.values(), ("LR", "tt", "LR"), strict=True):
        branch.description = {**branch.description, "word": word}
    axes = plot_diagram(graph, color="word", words=True).axes[0]
    assert {"LR", "tt"} <= {t.get_text() for t in axes.texts}
    assert {"LR", "tt"} <= {t.get_text() for t in axes.get_legend().get_texts()}
    with pytest.raises(ValueError, match="color = 'kind' is unknown; choose one of branch, word, stability"):
        plot_diagram(graph, color="kind")


def test_two_graphs_on_the_same_axes(graph):
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots()
    plot_diagram(graph, axes=axes)
    plot_diagram(fakes.pitchfork_graph(), y="u0", axes=axes, name="second")
    plot_diagram(fakes.pitchfork_graph(), axes=axes)
    names = {t.get_text() for t in axes.texts}
    assert "BP1" in names and any(n.startswith("second ") for n in names)
    legend = [t.get_text() for t in axes.get_legend().get_texts()]
    assert len(legend) == len(set(legend))
    colors = {line.get_color() for line in axes.lines if len(line.get_xdata()) > 1}
    assert len(colors) >= 6
    plt.close(figure)


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


def test_ticks_stay_when_a_figure_is_drawn_again_outside_the_style(graph):
    """The number of ticks follows the size of their labels, which must not be taken from the settings of the moment."""
    figure = plot_diagram(graph, figsize=(3.4, 2.4))
    axes = figure.axes[0]
    before = [label.get_text() for label in axes.get_yticklabels()], axes.yaxis.label.get_window_extent().x0
    with mpl.rc_context({"font.size": 20}):
        figure.draw_without_rendering()
    assert ([t.get_text() for t in axes.get_yticklabels()], axes.yaxis.label.get_window_extent().x0) == before
