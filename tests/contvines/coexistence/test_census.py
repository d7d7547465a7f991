"""Shares of a census, counted by hand, and the same when the journal remembers them."""

from types import SimpleNamespace

import numpy as np
import pytest

import contvines as cv
from contvines.coexistence.census import census, followed

REACHED = np.array([0, 0, 0, 0, 0, 1, 1, 1, 2, 2])
MIRRORED = np.array([1, 0, 1, 1, 0, 0, 0, 1, 0, 0], dtype=bool)


class Drawn:
    """Ten starts that reach three motions, some of them the mirror image."""

    def starts(self, count, seed, p):
        return np.arange(float(count))[:, None]

    def settle(self, starts, p):
        motions = [
            SimpleNamespace(
                word=word,
                periods=k + 1,
                kind="periodic",
                exponent=np.nan,
                error=np.nan,
                problem=None,
                u=None,
                state=None,
            )
            for k, word in enumerate(("LR", "LRR", "tt"))
        ]
        return motions, REACHED, MIRRORED


def test_shares_are_counted():
    journal = cv.MemoryJournal()
    for population in (Drawn(), SimpleNamespace()):  # the second one is not asked: the journal knows
        found = [counted.attractor for counted in census(population, 0.5, 10, 1, journal)]
        assert [a.word for a in found] == ["LR", "LRR", "tt"]
        assert [a.share for a in found] == pytest.approx([0.5, 0.3, 0.2])
        assert [a.mirror_share for a in found] == pytest.approx([0.3, 0.1, 0.0])
        assert [a.starts for a in found] == [10, 10, 10]


def test_starts_that_were_not_drawn_have_no_share():
    found = followed(Drawn(), 0.5, np.zeros((10, 1)), "here", cv.MemoryJournal())
    for counted in found:
        assert (counted.attractor.share, counted.attractor.mirror_share, counted.attractor.starts) == (
            0.0,
            0.0,
            0,
        )
