"""A drawn machine on whose branch a pair of multipliers leaves the circle between a period doubling and a fold, all within one step."""

import numpy as np
import pytest

import contvines as cv
from orbits.simulation import replay
from tools.fuzz.drawing import draw
from tools.fuzz.many_digits import exact
from tools.fuzz.searching import LIMITS

pytestmark = pytest.mark.slow


def outermost(orbit):
    """The largest modulus of its multipliers in eighty digits."""
    found = exact(orbit)
    assert found is not None and abs(found.shift) < 1e-14
    return np.abs(found.multipliers).max()


def test_stable_up_to_the_pair():
    """Over 1.4e-6 (frequency) behind the doubling, in eighty digits and in simulation, until a pair has modulus 1 there as well."""
    drawn = draw("coupled", 112831, 30)
    graph = cv.diagram(drawn.orbit, **drawn.options, settings=LIMITS)
    (point,) = graph.of_kind("neimark-sacker")
    branch = next(branch for branch in graph if branch.label == point.branch)
    index = next(i for i, label in branch.marks if label == point.label)
    before, behind = branch.orbit(index - 1), branch.orbit(index + 1)
    assert outermost(point.orbit) == pytest.approx(1.0, abs=1e-9)
    assert outermost(before) < 1.0 - 1e-3 and outermost(behind) > 1.0 + 1e-3
    assert replay(before, thorough=True).returned
