"""Insets: where marks hide one another and the picture has room; never where it is crowded all over."""

import matplotlib.pyplot as plt
import numpy as np
import pytest

from contvines.plots import plot_diagram
from contvines.plots.insets import crowded_region, find_room
from tests.contvines import fakes

CROWD = np.array([(0.5 + 0.004 * i, 0.5 + 0.003 * i) for i in range(8)])


@pytest.fixture
def axes():
    figure, axes = plt.subplots(figsize=(7.2, 4.6))
    axes.set(xlim=(0, 1), ylim=(0, 1))
    figure.canvas.draw()
    yield axes
    plt.close(figure)


def test_the_crowd_is_found_and_lies_in_its_region(axes):
    (x0, x1), (y0, y1) = crowded_region(axes, np.vstack([CROWD, [(0.1, 0.9), (0.9, 0.1)]]))
    assert x0 < 0.5 and 0.528 < x1 < 0.6 and y0 < 0.5 and 0.521 < y1 < 0.6
    assert not x0 < 0.1 < x1


def test_no_crowd_no_region(axes):
    assert crowded_region(axes, CROWD[:5]) is None  # few
    assert crowded_region(axes, np.tile([[0.5, 0.5]], (9, 1))) is None  # all at one point
    spread = np.column_stack([np.linspace(0.1, 0.9, 30), np.full(30, 0.5)])
    assert crowded_region(axes, np.vstack([CROWD, spread])) is None  # a small part of all


def test_room_is_free_of_curves_and_legends(axes):
    region = ((0.45, 0.55), (0.45, 0.55))
    line = np.column_stack([np.linspace(0, 1, 2000)] * 2)
    x, y, width, height = find_room(axes, region, line, [])
    corners = np.array([(x, y), (x + width, y + height)])
    assert (corners >= 0).all() and (corners <= 1).all()
    assert (x > y + height) or (x + width < y)  # on one side of the diagonal
    whole = tuple(axes.bbox.extents)
    assert find_room(axes, region, line, [whole]) is None


def crowded_graph():
    """The pitchfork's branches with eight folds close together at (0.5, 0.5) on B2 (x against p there: sqrt p)."""
    graph = fakes.pitchfork_graph()
    pattern = graph.special["BP1"]
    import dataclasses

    for i in range(8):
        p = 0.5 + 0.002 * i
        graph.special[f"LP{i + 1}"] = dataclasses.replace(
            pattern, label=f"LP{i + 1}", kind="fold", branch="B2", u=np.array([np.sqrt(p)]), value=p
        )
    return graph


def test_a_crowded_diagram_has_an_inset_with_the_labels_of_its_place():
    graph = crowded_graph()
    axes = plot_diagram(graph, y="u0", figsize=(7.2, 4.6)).axes[0]
    (inset,) = axes.child_axes
    x0, x1 = inset.get_xlim()
    assert 0.4 < x0 < 0.5 and 0.514 < x1 < 0.6
    inside = " ".join(text.get_text() for text in inset.texts)
    outside = " ".join(text.get_text() for text in axes.texts)
    assert "LP" in inside and "LP" not in outside and "BP1" in outside
    assert not any(text.get_window_extent().overlaps(inset.bbox) for text in axes.texts)
    axes.set_xlim(x0, x1)  # zoomed there, it is no crowd any more
    assert len(axes.child_axes) <= 1


def test_an_inset_can_be_refused_or_asked_for():
    graph = crowded_graph()
    assert not plot_diagram(graph, y="u0", inset=False).axes[0].child_axes
    assert not plot_diagram(graph, y="u0", figsize=(3.4, 2.4)).axes[0].child_axes  # no room
    figure, axes = plt.subplots(figsize=(7.2, 4.6))
    plot_diagram(graph, y="u0", axes=axes)
    assert not axes.child_axes  # the user's axes stay his
    plt.close(figure)
    asked = plot_diagram(graph, y="u0", inset=((0.4, 0.6), (0.6, 0.8))).axes[0]
    assert asked.child_axes[0].get_xlim() == (0.4, 0.6)
