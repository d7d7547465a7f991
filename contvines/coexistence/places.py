"""Where an atlas looks beside the values it was given: in every stretch between two changes, and evenly all over."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise

import numpy as np

from ..graph.graph import Graph
from .settings import ATLAS

RESOLVED = (
    0.01  # of the interval: a kind of motion that has no branch is told of up to so near to where it ends
)
UNBRANCHED = ("chaotic", "quasi-periodic", "chatter")  # kinds of motion that have none
TURN = 0.5 * (np.sqrt(5.0) - 1.0)  # of the additive recurrence, see `scattered`


def scattered(within: tuple[float, float], seed: int, k: int) -> float:
    """The k-th of a sequence of values that fills an interval evenly at every length.

    ``shift + k (sqrt(5) - 1) / 2 mod 1``; among its first n values no gap is wider than 1.9 / n of the interval (the
    three-distance theorem; L. Ramshaw, J. Number Theory 13 (1981) 138).
    """
    low, high = within
    shift = float(np.random.default_rng(seed).random())
    return float(low + (high - low) * ((shift + (k + 1) * TURN) % 1.0))


def changes(graph: Graph) -> np.ndarray:
    """Values at which a known real motion becomes stable or ceases to be, in increasing order, and the interval's ends."""
    ends = {e for b in graph.branches.values() if b.real for pair in b.stable_intervals() for e in pair}
    return np.array(sorted({*graph.within, *ends}))


def unasked(graph: Graph, asked: Sequence[float], most: int) -> list[float]:
    """Values where what attracts may differ from what has been seen at `asked`, at most `most`, those of wide stretches first.

    Between two neighbouring changes of what is stable something else may have taken over: there is one value at least in
    each such stretch, in its middle if none lies there, and one right beyond each change, where a motion that ceases to be stable
    hands over to another, and beside each end of the interval.
    """
    size = graph.within[1] - graph.within[0]
    known = np.sort(np.asarray(asked, dtype=float))
    marks = changes(graph)
    wanted: list[tuple[float, float]] = []
    for first, last in pairwise(marks):
        width = float(last - first)
        if width <= ATLAS.narrow * size:
            continue
        inside = known[(known > first) & (known < last)]
        if not inside.size:
            wanted.append((width, float(0.5 * (first + last))))
        step = ATLAS.beyond * size
        if width <= 4.0 * step:
            continue
        for p in (first + step, last - step):
            if not np.any(np.abs(inside - p) <= 2.0 * step):
                wanted.append((0.25 * width, float(p)))
    wanted.sort(key=lambda entry: (-entry[0], entry[1]))
    return list(dict.fromkeys(p for _, p in wanted[:most]))


def unresolved(
    met: Mapping[str, Sequence[float]], asked: Sequence[float], within: tuple[float, float], most: int
) -> list[float]:
    """Values between two neighbours of which one has met a kind of motion without a branch and the other has not.

    At most `most`, those of distant neighbours first.

    Parameters
    ----------
    met : mapping
        The values at which each kind has been met.
    asked : sequence of float
        The values at which it would have been met, had it been there.
    within : (float, float)
    most : int
    """
    wanted: dict[float, float] = {}
    for kind in UNBRANCHED:
        here = set(met.get(kind, ()))
        for first, last in pairwise(sorted(here | set(asked)) if here else ()):
            if (first in here) != (last in here) and last - first > RESOLVED * (within[1] - within[0]):
                wanted[0.5 * (first + last)] = last - first
    return sorted(wanted, key=lambda p: (-wanted[p], p))[:most]


def unknown(graph: Graph, asked: Sequence[float]) -> list[tuple[float, float]]:
    """Stretches of the interval, none narrower than a hundredth, with no stable branch and none of the values `asked`."""
    low, high = graph.within
    covered = [pair for b in graph.branches.values() if b.real for pair in b.stable_intervals()]
    marks = sorted({low, high, *asked, *(end for pair in covered for end in pair)})
    return [
        (float(first), float(last))
        for first, last in pairwise(marks)
        if last - first > RESOLVED * (high - low) and not any(a <= first and last <= b for a, b in covered)
    ]
