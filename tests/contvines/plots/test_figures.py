"""Figures: styles, files, notebooks; multipliers, portraits and the network."""

import matplotlib as mpl
import numpy as np
import pytest

from contvines.plots import plot_diagram, plot_multipliers, plot_network, plot_portrait, save_figure


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


def test_network_has_a_box_per_branch_and_names_the_switches(graph):
    figure = plot_network(graph)
    texts = [t.get_text() for t in figure.axes[0].texts]
    assert [t.split()[0] for t in texts] == ["B1", "B2", "B3", "BP1", "VG1"]
    figure.set_dpi(200)  # arrows end at their boxes at any resolution, the first time they are drawn
    once, twice = (figure.canvas.draw() or np.array(figure.canvas.buffer_rgba()) for _ in range(2))
    assert np.all(once == twice)


def test_pictures_are_saved_shown_in_notebooks_and_the_users_settings_stay(graph, tmp_path):
    before = dict(mpl.rcParams)
    for name in ("a.png", "a.pdf", "a.svg"):
        save_figure(plot_diagram(graph), tmp_path / name)
        assert (tmp_path / name).stat().st_size > 4000
    assert plot_diagram(graph)._repr_png_().startswith(b"\x89PNG")
    assert dict(mpl.rcParams) == before
