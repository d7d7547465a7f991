"""Random polynomial systems against resultants; ``python -m tests.contvines.problems.fuzz 500`` asks for more."""

from itertools import islice

import pytest

from tests.contvines.problems.fuzz import suitable


@pytest.mark.parametrize(("seed", "system"), list(islice(suitable(0), 12)), ids=lambda value: str(value)[:6])
def test_all_branches_and_branch_points_and_no_others(seed, system):
    assert system.wrong() == []
