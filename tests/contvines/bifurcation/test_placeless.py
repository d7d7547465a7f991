"""A special point whose place rounding leaves open is not told."""

from dataclasses import replace

import numpy as np
import pytest

import contvines as cv
from contvines.bifurcation.segment_search import SegmentSearch


@pytest.mark.parametrize(("error", "told"), [(1e-3, 1), (1.0, 1), (2.1, 0), (np.inf, 0)])
def test_an_error_longer_than_the_interval(error, told, monkeypatch):
    """x (x - p) = 0 has a branch point at p = 0, which is said to be somewhere within the interval, or anywhere."""
    search = SegmentSearch.search

    def vaguely(self, *args, **options):
        found = search(self, *args, **options)
        return [replace(e, error=error) if e.kind == "branch-point" else e for e in found]

    monkeypatch.setattr(SegmentSearch, "search", vaguely)
    monkeypatch.setattr("contvines.bifurcation.consistency.inexact", lambda segment, event: False)
    graph = cv.diagram(
        cv.AlgebraicProblem(lambda u, p: u * (u - p), [0.0], -0.7), within=(-1.0, 1.0), depth=0
    )
    assert len(graph.of_kind("branch-point")) == told
