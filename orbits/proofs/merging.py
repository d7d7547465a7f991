"""Borders seen from the side where a flight has shrunk to nothing, rewritten to the word without it.

There the equations of the longer word are singular, those of the shorter one are not: it is the same motion.

=========  ==============================  ======================================
events     at one instant                  becomes
=========  ==============================  ======================================
``t s``    a turn just before a stick      ``s``, friction just holding
``t t``    two turns                       none, a flight that touches w' = 0
``u s``    a slip that stops at once       none, a stick that just holds inside
=========  ==============================  ======================================
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from orbits.proofs.equations import Motif

SHORT = 1e-3  # radians of the forcing
Merged = tuple[Motif, np.ndarray, tuple[str, int]]


def merged(motif: Motif, nodes: np.ndarray) -> Merged | None:
    """The shorter word, its nodes and the margin that vanishes; None where no flight has shrunk to nothing.

    A word with no events left is the stuck absorber.
    """
    pairs = [i for i in range(len(motif)) if _pair(motif, nodes, i)]
    if not pairs:
        return None
    if 2 * len(pairs) == len(motif) and all(_pair(motif, nodes, i) == "us" for i in pairs):
        return replace(motif, events=(), modes=()), nodes[:0], ("hold", 0)
    i = pairs[0]
    if i + 1 >= len(motif):
        return None
    kind = _pair(motif, nodes, i)
    if kind == "ts":
        return _without(motif, nodes, [i]), np.delete(nodes, i, axis=0), ("stick", i)
    if i == 0:
        return None
    return (
        _without(motif, nodes, [i, i + 1]),
        np.delete(nodes, [i, i + 1], axis=0),
        ("flight" if kind == "tt" else "hold", i - 1),
    )


def _pair(motif: Motif, nodes: np.ndarray, i: int) -> str:
    last = i + 1 == len(motif)
    turn = np.pi * motif.periods * (1 if motif.half else 2)
    span = nodes[0, 0] + turn - nodes[i, 0] if last else nodes[i + 1, 0] - nodes[i, 0]
    pair = motif.events[i] + motif.arrival(i)[0]
    return pair if abs(span) < SHORT and pair in ("ts", "tt", "us") else ""


def _without(motif: Motif, nodes: np.ndarray, places: Sequence[int]) -> Motif:
    keep = [i for i in range(len(motif)) if i not in places]
    return replace(
        motif, events=tuple(motif.events[i] for i in keep), modes=tuple(motif.modes[i] for i in keep)
    )
