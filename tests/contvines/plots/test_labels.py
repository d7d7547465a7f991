"""Labels that find no clean place are left out; only those of special points are counted."""

import matplotlib.pyplot as plt
import numpy as np
import pytest

from contvines.plots.labels import Ground, Label, grouped, place_labels


@pytest.fixture
def axes():
    figure, axes = plt.subplots(figsize=(1.5, 1.5))
    axes.set(xlim=(0, 1), ylim=(0, 1))
    figure.canvas.draw()
    yield axes
    plt.close(figure)


def test_names_of_branches_are_left_out_in_silence(axes):
    everywhere = np.array([(x, y) for x in np.linspace(0, 1, 150) for y in np.linspace(0, 1, 150)])
    point, name = Label("SB1", 0.5, 0.5), Label("B1", 0.4, 0.6, near=True)
    assert place_labels(axes, [point, name], everywhere, size=8) == ([], 1)
    assert place_labels(axes, [name], everywhere, size=8) == ([], 0)
    written, left_out = place_labels(axes, [Label("SB1", 0.5, 0.5, kept=True)], everywhere, size=8)
    assert [text.get_text() for text in written] == ["SB1"] and left_out == 0
    outside = Label("SB2", 2.0, 0.5)
    assert place_labels(axes, [outside], np.zeros((0, 2)), size=8) == ([], 0)


def test_a_leader_takes_the_way_that_crosses_no_curve(axes):
    # curves above the point at every height, nothing below it: the text must go below
    x = np.linspace(0.0, 1.0, 600)
    above = np.vstack([np.column_stack([x, np.full_like(x, h)]) for h in np.arange(0.54, 0.9, 0.04)])
    (text,), _ = place_labels(axes, [Label("SB1", 0.5, 0.5)], above, size=8)
    assert text.xyann[1] < 0


def test_curves_are_counted_along_a_line(axes):
    x = np.linspace(0.0, 1.0, 600)
    curves = np.vstack([np.column_stack([x, np.full_like(x, h)]) for h in (0.3, 0.5, 0.7)])
    ground = Ground(axes.bbox, axes.transData.transform(curves))
    ends = axes.transData.transform([(0.5, 0.3), (0.5, 0.95), (0.5, 0.05)])
    assert (
        2.0 <= ground.crossed((*ends[0], *ends[1])) < 3.0
    )  # its own curve, at the first end, is not counted
    assert ground.crossed((*ends[0], *ends[2])) == 0.0


def test_of_a_crowd_the_number_is_told_and_not_one_name(axes):
    crowd = [Label(f"LP{i}", 0.5, 0.5) for i in range(1, 38)]
    assert [label.text for label in grouped(axes, crowd)] == ["37 points"]
    assert [label.text for label in grouped(axes, crowd[:4])] == ["LP1, LP2 +2"]


def test_a_label_stands_clearly_nearer_to_its_own_mark(axes):
    """Two marks side by side, whose texts could be read as either's above and below the gap between them."""
    marks = np.array([[0.45, 0.5], [0.56, 0.49]])
    labels = [Label("PD2", *marks[0]), Label("WG1", *marks[1])]
    written, _ = place_labels(axes, labels, marks, size=6)
    places = axes.transData.transform(marks)
    for text in written:
        box = text.get_bbox_patch() and text.get_window_extent()
        near = np.clip(places, (box.x0, box.y0), (box.x1, box.y1))
        gaps = np.hypot(*(near - places).T)
        own = [entry.text for entry in labels].index(text.get_text())
        assert gaps[own] < 0.85 * gaps[1 - own], text.get_text()
