"""Test functions of multipliers: the k-th largest of a sort, so that two that cross at once are two special points."""

from __future__ import annotations

from collections.abc import Sequence

from ..continuation.aims import SORTS, aim_at_multiplier
from .kind import Test
from .located import Located
from .segment import Segment

JUMP = 0.05  # change of a multiplier's logarithm over a small part of a segment: it has come from elsewhere


def passing(segment: Segment, sort: str) -> list[Test]:
    """One test for each multiplier of a sort ("plus", "minus", "pair") that is past the circle at one end only."""
    engine, place = segment.engine, tuple(SORTS).index(sort)
    one, other = segment.counts[0][place], segment.counts[1][place]
    return [
        Test(aim_at_multiplier(engine.m, engine.detection, sort, k), k, JUMP)
        for k in range(min(one, other) + 1, max(one, other) + 1)
    ]


def flips(segment: Segment, found: Sequence[Located], kind: str) -> list[Test]:
    """Multipliers that pass -1, where the problem says that this is what they mean."""
    return passing(segment, "minus") if segment.engine.problem.flip_kind == kind else []


def pairs(segment: Segment, found: Sequence[Located], spectrum: str) -> list[Test]:
    """Complex pairs that pass the circle (the imaginary axis)."""
    return passing(segment, "pair") if segment.engine.detection == spectrum else []
