"""Random polynomial systems against resultants; ``python -m tests.contvines.problems.fuzz 500`` asks for more."""

from itertools import islice

import pytest

from tests.contvines.problems.fuzz import suitable


@pytest.mark.parametrize(("seed", "system"), list(islice(suitable(0), 12)), ids=lambda value: str(value)[:6])
def test_all_branches_and_branch_points_and_no_others(seed, system):
    assert system.wrong() == []


def test_an_unknown_that_rounding_has_moved_from_zero_has_no_scale():
    # its first unknown is 1e-29 all along: steps as small never end
    seed, system = next(iter(suitable(5058)))
    assert seed == 5058
    assert system.wrong() == []
