"""Labels as they are written: at their true width, none over another, in every figure's size."""

import itertools

import numpy as np
import pytest
from matplotlib.text import Text

from contvines.plots.figures import new_axes, settle, styled
from contvines.plots.labels import Label, place_labels


@pytest.mark.parametrize("size", [(3.4, 2.4), (7.0, 5.0)])
@pytest.mark.parametrize("texts", [("WG1", "PD2", "GPD10"), ("WWW", "MMM", "WMW, MWM, WMW")])
def test_wide_letters_do_not_run_into_one_another(texts, size):
    with styled():
        figure, axes = new_axes(None, figsize=size)
        axes.set(xlim=(0, 1), ylim=(0, 1))
        settle(figure)
        figure.set_layout_engine("none")
        labels = [Label(text, 0.5 + 0.06 * i, 0.5, kept=True) for i, text in enumerate(texts)]
        written, left_out = place_labels(axes, labels, np.empty((0, 2)), size=8.0)
        figure.canvas.draw()
    assert len(written) == len(texts) and left_out == 0
    boxes = [Text.get_window_extent(artist) for artist in written]  # without the leaders
    for one, other in itertools.combinations(boxes, 2):
        shared = [
            min(one.x1, other.x1) - max(one.x0, other.x0),
            min(one.y1, other.y1) - max(one.y0, other.y0),
        ]
        assert min(shared) <= 1.0, (one, other)  # pixels
