"""Even draws: the three-distance theorem, shares of boxes, draws that go on, seeds."""

import numpy as np
import pytest

from contvines.shared.motions import low_discrepancy


@pytest.mark.parametrize("count", [2, 7, 50, 613])
def test_gaps_on_a_circle_have_at_most_three_lengths(count):
    places = np.sort(low_discrepancy(1, count, 3)[:, 0])
    gaps = np.append(np.diff(places), 1.0 + places[0] - places[-1])
    assert len(np.unique(np.round(gaps, 10))) <= 3


@pytest.mark.parametrize("dimension", [2, 3, 5])
def test_boxes_get_their_share(dimension):
    points = low_discrepancy(dimension, 2000, 0)
    chance = np.random.default_rng(1)
    for _ in range(20):
        low = 0.6 * chance.random(dimension)
        high = low + 0.4
        share = np.all((points >= low) & (points < high), axis=1).mean()
        assert abs(share - 0.4**dimension) < 3e-3 + 0.5 * np.sqrt(0.4**dimension / 2000)


def test_draws_go_on_and_differ_by_seed():
    whole = low_discrepancy(3, 30, 5)
    assert np.array_equal(np.concatenate([low_discrepancy(3, 10, 5), low_discrepancy(3, 20, 5, 10)]), whole)
    assert not np.array_equal(whole, low_discrepancy(3, 30, 6))
