"""Endings in words."""

import pytest

from contvines.branches.ending import Ending, Reason


@pytest.mark.parametrize(
    "ending, says",
    [
        (Ending(Reason.MEETS, 0.5, "VG1", "B1", "stick"), "meets B1 at VG1 (stick), p = 0.5"),
        (Ending(Reason.MEETS_SYMMETRIC, 0.5, "SB1", "B1"), "meets B1 at SB1, p = 0.5"),
        (Ending(Reason.REACHES, 0.5, "VG1", None, "stick"), "reaches VG1 (stick) at p = 0.5"),
        (Ending(Reason.LEAVES, 0.5, "PD1", "B1"), "leaves B1 at PD1"),
        (Ending(Reason.GOES_ON, 0.5, "VG1", "B1"), "goes on from B1 at VG1"),
        (Ending(Reason.STOPS, 0.5, "US1", None, "user", "height"), "stops at US1 (height), p = 0.5"),
        (Ending(Reason.COMES_BACK, 0.5, "SB1"), "comes back to more symmetric solutions at SB1, p = 0.5"),
    ],
)
def test_an_ending_says_which_branch_and_which_point(ending, says):
    assert ending.sentence("p") == says
    assert Ending.from_dict(ending.to_dict()) == ending
