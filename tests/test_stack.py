"""Work with room on Python's stack gives what it gives anyway."""

import sys

import pytest

from contvines_ground.stack import with_room


def depth(n):
    return 0 if n == 0 else 1 + depth(n - 1)


def test_results_and_errors_come_through():
    assert with_room(divmod, 17, 5) == (3, 2)
    assert with_room(with_room, depth, 100) == 100
    with pytest.raises(ZeroDivisionError):
        with_room(divmod, 17, 0)


def test_frames_below_may_outgrow_the_room():
    limit = sys.getrecursionlimit()
    sys.setrecursionlimit(20_000)
    try:
        assert with_room(depth, 15_000) == 15_000
    finally:
        sys.setrecursionlimit(limit)
