"""A handful of drawn polynomial flows; ``python -m tools.flow_fuzz 200`` draws more."""

import pytest

from tools.flow_fuzz import judge


@pytest.mark.slow
@pytest.mark.parametrize("seed", [4, 6, 9])
def test_what_an_atlas_says_is_true_and_nothing_is_missing(seed):
    done = judge(33, seed)
    assert not done.findings
    assert done.tried["equilibria"] and done.tried["cycles"] and done.tried["motions"]
