"""Plans of surveys: grids, lists, samples; neighbours; and a sentence for what cannot be planned."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from contvines.survey import PlanError, planned


def test_a_grid_and_a_list():
    plan = planned({"a": {"within": [1, 2], "count": 3}, "b": [5.0, 7.0]})
    assert plan.shape == (3, 2) and plan.dimensions == ("a", "b")
    assert plan.systems()[:3] == [{"a": 1.0, "b": 5.0}, {"a": 1.0, "b": 7.0}, {"a": 1.5, "b": 5.0}]


@pytest.mark.parametrize("sampling", ["latin", "sobol", "random"])
def test_samples_follow_their_distributions(sampling):
    vary = {
        "a": [1.0, 2.0],
        "r": {"normal": [0.6, 0.05]},
        "mu": {"uniform": [0.1, 0.3]},
        "m": {"within": [2, 4]},
    }
    plan = planned(vary, sampling, 256, 3)
    assert plan.shape == (2, 256) and plan.dimensions == ("a", "sample")
    r, mu, m = (plan.samples[name] for name in ("r", "mu", "m"))
    assert np.mean(r) == pytest.approx(0.6, abs=0.01) and np.std(r) == pytest.approx(0.05, abs=0.01)
    assert 0.1 <= mu.min() < 0.12 and 0.28 < mu.max() <= 0.3
    assert np.mean(m) == pytest.approx(3.0, abs=0.12)
    again = planned(vary, sampling, 256, 3)
    assert all(np.array_equal(again.samples[name], plan.samples[name]) for name in plan.samples)
    if sampling == "latin":  # one in each of 256 equal slices
        assert len(np.unique(np.floor((mu - 0.1) / 0.2 * 256))) == 256


@given(st.lists(st.integers(1, 4), min_size=1, max_size=3), st.booleans())
def test_a_neighbour_comes_first_and_differs_in_one_place(lengths, sampled):
    vary = {f"x{i}": list(range(n)) for i, n in enumerate(lengths)}
    if sampled:
        vary["s"] = {"uniform": [0, 1]}
    plan = planned(vary, samples=3)
    places = [np.unravel_index(i, plan.shape) for i in range(len(plan))]
    for i, j in enumerate(plan.neighbours()):
        if i == 0:
            assert j is None
            continue
        assert j is not None and j < i
        assert sum(a != b for a, b in zip(places[i], places[j])) == 1


@pytest.mark.parametrize(
    ("vary", "says"),
    [
        ({}, "vary is empty"),
        ({"a": []}, "a list of values"),
        ({"a": ["x"]}, "vary.a[0] = 'x' is no finite number"),
        ({"a": {"within": [2, 1], "count": 3}}, "expected low < high"),
        ({"a": {"within": [1, 2], "count": 0}}, "vary.a.count = 0"),
        ({"a": {"normal": [1, 0]}}, "the second above 0"),
        ({"a": {"uniform": [1]}}, "expected two numbers"),
        ({"a": {"between": [1, 2]}}, "vary.a.between: there is no such field"),
        ({"a": {"within": [0, 1], "count": 1000000}, "b": [1, 2, 3]}, "means 3000000 systems"),
    ],
)
def test_what_cannot_be_planned(vary, says):
    with pytest.raises(PlanError) as caught:
        planned(vary)
    assert says in str(caught.value)


def test_bad_sampling():
    for options in ({"sampling": "dice"}, {"samples": 0}):
        with pytest.raises(PlanError):
            planned({"a": {"uniform": [0, 1]}}, **options)
