"""Outcomes of the coupled machine: activation is the borders and folds of the diagram, shares are those of an atlas."""

import numpy as np
import pytest

import contvines as cv
from contvines.survey import survey
from contvines.survey.outcomes import Findings, activation
from orbits import Coupled
from orbits.design import Family

pytestmark = pytest.mark.slow


MACHINE = Coupled(
    restitution=0.6, friction=0.1, gravity=0.26, mass_ratio=0.02, damping=1.5, frequency=1.003, forcing=1.0
)


def test_activation_is_at_special_points():
    seed = MACHINE.orbit("LR", forcing=1.2)
    graph = cv.diagram(seed, over="forcing", within=(0.05, 2.0), depth=2)
    values = activation(Findings(graph, seed, [(1.0, {}, "LR"), (1.0, {}, "tt")]))
    places = [float(point.value) for point in graph.special.values()]
    for value in values.values():
        assert np.isnan(value) or min(abs(value - place) for place in places) < 1e-8
    assert np.isfinite(values["activation_from_above"])
    assert values["activation_from_above"] <= np.nan_to_num(values["activation_from_below"], nan=2.0)


def test_an_atlas_of_each_machine_is_the_atlas_of_that_machine():
    asked = {"values": [1.0, 1.6], "starts": 12, "seed": 3, "scan": 0}
    made = survey(
        Family(MACHINE, "LR", loose={"forcing": 1.2}), {"friction": [0.1, 0.12]}, over="forcing", within=(0.8, 2.0),
        outcomes=("share:LR", "coexisting"), atlas=asked, workers=1, depth=1,
    )  # fmt: skip
    assert made.failed == 0
    for i, friction in enumerate((0.1, 0.12)):
        graph = cv.atlas(
            MACHINE.changed(friction=friction), over="forcing", within=(0.8, 2.0), depth=1, **asked
        )
        assert made["share_LR"][i] == sum(a.share for a in graph.attractors if a.word == "LR") / 2
