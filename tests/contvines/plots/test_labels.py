"""Labels that find no clean place are left out; only those of special points are counted."""

import matplotlib.pyplot as plt
import numpy as np
import pytest

from contvines.plots.labels import Label, place_labels


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
