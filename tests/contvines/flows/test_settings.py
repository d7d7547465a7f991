"""Tolerances of a flow of one's own."""

import numpy as np
import pytest

import contvines as cv


def snic(x, p):
    """theta' = p - sin(theta) on the unit circle: period 2 pi / sqrt(p^2 - 1)."""
    turn, inward = p.w - x[1], 1.0 - x[0] ** 2 - x[1] ** 2
    return [inward * x[0] - turn * x[1], inward * x[1] + turn * x[0]]


def test_a_branch_goes_on_to_the_longest_period_that_is_asked_for(tmp_path):
    flow = cv.FlowProblem(snic, [1.0, 0.0], {"w": 2.0}, settings={"longest": 10.0})
    orbit = flow.attractor()
    graph = cv.diagram(orbit, over="w", within=(0.9, 3.0))
    (end,) = graph.of_kind("homoclinic")
    assert end.orbit.period == pytest.approx(10.0 * orbit.period, rel=1e-6)
    assert end.value == pytest.approx(np.sqrt(1.0 + 3.0 / 100.0), abs=1e-8)  # w^2 - 1 = 3 / 10^2


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        ({"longst": 10.0}, "there is no 'longst' of a flow .did you mean 'longest'"),
        ({"near": -1.0}, "near = -1.0 must be a positive number"),
    ],
)
def test_wrong_settings(given, sentence):
    with pytest.raises(ValueError, match=sentence):
        cv.FlowProblem(snic, [1.0, 0.0], {"w": 2.0}, settings=given)
