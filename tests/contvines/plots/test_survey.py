"""Pictures of surveys."""

from itertools import combinations

import numpy as np

from contvines.plots import plot_survey
from contvines.survey import Plan
from contvines.survey.results import Survey


def steep():
    """A map that rises at one side: contours close together."""
    plan = Plan({"length": np.linspace(8.0, 20.0, 5), "mass": np.array([0.5, 0.6, 0.7])}, {})
    x, y = np.meshgrid(plan.axes["length"], plan.axes["mass"], indexing="ij")
    return Survey(plan, {"peak": np.where(x > 17.0, x, 17.0 - 2.0 * y)}, np.full((5, 3), ""), {}, {})


def test_numbers_on_contours_do_not_stand_on_one_another():
    for size in ((3.4, 2.4), (6.4, 4.8)):
        figure = plot_survey(steep(), figsize=size)
        boxes = [text.get_window_extent() for text in figure.axes[0].texts]
        assert len(boxes) > 1
        assert not any(one.overlaps(other) for one, other in combinations(boxes, 2))
        written = {float(text.get_text()) for text in figure.axes[0].texts}
        assert all(15.0 < height < 20.0 for height in written)
