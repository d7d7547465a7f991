"""Figures: styles, sizes, files, notebooks; multipliers and portraits."""

import matplotlib as mpl
import numpy as np
import pytest

from contvines.plots import plot_diagram, plot_multipliers, plot_portrait, save_figure
from contvines.plots.figures import check_picture
from contvines.shared.figures import HOUSE as STYLE
from tests.contvines import fakes


@pytest.fixture
def graph():
    return fakes.pitchfork_graph()


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
