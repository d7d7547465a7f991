"""The graph does not depend on how wide an interval is asked for."""

from __future__ import annotations

import numpy as np
import pytest

import contvines as cv
from tests.machines import ABSORBER

EDGE = 1.3


def _forms(graph: cv.Graph) -> set:
    """Kinds and values of the special points up to the edge."""
    return {
        (point.kind, round(point.value, 9))
        for point in graph.special.values()
        if point.value < EDGE and point.kind != "end"
    }


def _words(graph: cv.Graph) -> set:
    return {
        branch.problem.canonical(branch.points[1], float(branch.values[1]))[0]
        for branch in graph
        if branch.range[0] < EDGE
    }


@pytest.mark.parametrize("upper", [1e4, 1e6])
def test_silly_interval(upper):
    absorber = ABSORBER
    seed = absorber.symmetric_orbit(amplitude=0.55)
    narrow = cv.diagram(seed, over="amplitude", within=(0.2, EDGE), depth=1)
    wide = cv.diagram(seed, over="amplitude", within=(0.2, upper), depth=1)
    assert _forms(narrow) <= _forms(wide)
    assert _words(narrow) <= _words(wide)
    assert len(_words(narrow)) == 5
    for branch in wide:
        ends = {label for index, label in branch.marks if index in (0, len(branch) - 1)}
        assert branch.closed or len(ends) == 2, branch
        assert len(np.unique(branch.values)) > 2
