"""A handful of drawn polynomial flows; ``python -m tools.flow_fuzz 200`` draws more."""

from itertools import pairwise

import pytest

from tools.flow_fuzz import atlas_of, drawn, judge


@pytest.mark.slow
@pytest.mark.parametrize("seed", [6, 7, 10])
def test_what_an_atlas_says_is_true_and_nothing_is_missing(seed):
    done = judge(33, seed)
    assert not done.findings
    assert done.tried["equilibria"] and done.tried["cycles"] and done.tried["motions"]


@pytest.mark.slow
def test_an_atlas_follows_nothing_that_leaves_beside_the_orbit_of_a_saddle_focus():
    """Glendinning and Sparrow 1984: doublings accumulate at the homoclinic orbit, and on each branch that leaves there again."""
    graph = atlas_of(drawn(4501, 107))
    orbit = graph.special["HC1"]
    doublings = [point for point in graph.of_kind("period-doubling") if point.branch == orbit.branch]
    gaps = [
        abs(point.value - orbit.value) for point in doublings[::2]
    ]  # of the two at each turn of the branch the first
    assert len(gaps) >= 3 and all(other < 0.2 * one for one, other in pairwise(gaps))
    assert "is not followed" in " ".join(doublings[0].remarks)
    assert graph.complete and not {switch.point for switch in graph.switches} & {
        point.label for point in doublings
    }
