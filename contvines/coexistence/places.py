"""Where an atlas looks beside the values it was given: in every stretch between two changes, and evenly all over."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from ..graph.graph import Graph

BEYOND = 2e-3  # of the interval: so far outside a stable stretch it is asked what the motion becomes
NARROWEST = 1e-6  # of the interval: narrower stretches between two changes are left out
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
    """Values where what attracts may differ from what has been seen at `asked`, at most `most`, in increasing order.

    Between two neighbouring changes of what is stable something else may have taken over: there is one value at least in
    each such stretch, in its middle if none lies there, and one right beyond each change, where a motion that ceases to be stable
    hands over to another. Wide stretches come first.
    """
    low, high = graph.within
    size = high - low
    known = np.sort(np.asarray(asked, dtype=float))
    marks = changes(graph)
    wanted: list[tuple[float, float]] = []
    for first, last in pairwise(marks):
        width = float(last - first)
        if width <= NARROWEST * size:
            continue
        inside = known[(known > first) & (known < last)]
        if not inside.size:
            wanted.append((width, float(0.5 * (first + last))))
        step = BEYOND * size
        if width <= 4.0 * step:
            continue
        for edge, p in ((first, first + step), (last, last - step)):
            # the ends of the interval are no changes
            if low < edge < high and not np.any(np.abs(inside - edge) <= 2.0 * step):
                wanted.append((0.25 * width, float(p)))
    wanted.sort(key=lambda entry: (-entry[0], entry[1]))
    return sorted({p for _, p in wanted[:most]})
