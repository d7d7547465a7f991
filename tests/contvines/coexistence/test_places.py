"""Where an atlas looks: even gaps, one value in every stretch between two changes, narrow windows, a stated end."""

from itertools import pairwise
from types import SimpleNamespace

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from contvines.coexistence.places import changes, scattered_value, untested_values


@given(st.integers(0, 1000), st.integers(2, 400))
def test_scattered_values_leave_no_gap_wider_than_the_theorem_says(seed, count):
    values = np.sort([scattered_value((2.0, 5.0), seed, k) for k in range(count)])
    gaps = np.append(np.diff(values), values[0] + 3.0 - values[-1])  # on the circle
    assert gaps.max() <= 1.9 / count * 3.0 + 1e-12
    assert values[0] >= 2.0 and values[-1] <= 5.0


def graph_with(*intervals):
    """A graph whose branches are stable on these intervals alone."""
    branches = {
        k: SimpleNamespace(real=True, stable_intervals=lambda i=i: [i]) for k, i in enumerate(intervals)
    }
    return SimpleNamespace(within=(0.0, 1.0), branches=branches)


@given(st.lists(st.tuples(st.floats(0.01, 0.98), st.floats(1e-3, 0.3)), max_size=6), st.integers(0, 20))
def test_every_stretch_between_two_changes_is_asked(pairs, asked):
    graph = graph_with(*[(a, min(a + width, 0.99)) for a, width in pairs])
    known = [scattered_value(graph.within, 1, k) for k in range(asked)]
    all_asked = [*known, *untested_values(graph, known, 1000)]
    marks = changes(graph)
    for first, last in pairwise(marks):
        if last - first > 1e-6:
            assert any(first < p < last for p in all_asked)
    assert untested_values(graph, all_asked, 1000) == []  # it ends
    assert len(untested_values(graph, known, 2)) <= 2
