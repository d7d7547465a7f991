"""Rewrite a border at which a flight has duration zero (or an impact has speed zero) to the shorter word without it.

Both words describe the same motion, but there the equations of the longer word are singular and those of the shorter word are regular.

=========  ==============================  ======================================
events     at the border                   rewritten to
=========  ==============================  ======================================
``t s``    a turn just before a stick      ``s`` with vanishing friction margin
``t t``    two turns at one instant        no event: a flight that touches w' = 0
``u s``    a slip that stops at once       no event: a stick whose friction margin vanishes inside
``s u``    a stick of duration zero        ``t`` with vanishing margin; if sliding continues in the same direction, no event: a flight that touches w' = 0
``L``      an impact of speed zero         ``t`` at the wall; without friction no event: a flight that touches the wall
=========  ==============================  ======================================
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from orbits.proofs.equations import MIRRORED, Motif
from orbits.proofs.flights import WALLS
from orbits.settings import PROVING

PAIRS = ("ts", "tt", "us", "su")
Merged = tuple[Motif, np.ndarray, tuple[str, int]]


def merged(
    motif: Motif, nodes: np.ndarray, margin: tuple[str, int], room: Mapping[int, float]
) -> Merged | None:
    """Return the shorter word, its nodes and its vanishing margin; None if there is no flight of duration zero or impact of speed zero.

    If no events are left, the shorter word is the stuck absorber.

    Parameters
    ----------
    motif : Motif
        The longer word.
    nodes : float array (l, n)
        Its nodes.
    margin : (str, int)
        Name and event of the margin of the longer word that vanishes.
    room : dict
        Side -> distance of the left (1) and of the right wall (-1) from w = 0.
    """
    name, event = margin
    if name == "approach":
        return _grazing(motif, nodes, event, room)
    pairs = [i for i in range(len(motif)) if _pair(motif, nodes, i)]
    if name == "wall" or not any(event in (i, (i + 1) % len(motif)) for i in pairs):
        return None
    if 2 * len(pairs) == len(motif) and all(_pair(motif, nodes, i) == "us" for i in pairs):
        return replace(motif, events=(), modes=(), periods=1, half=False), nodes[:0], ("hold", 0)
    first = next(i for i in pairs if event in (i, (i + 1) % len(motif)))
    motif, nodes, i = _inwards(motif, nodes, first, room)
    if i + 1 >= len(motif) or i == 0:
        return None
    kind = _pair(motif, nodes, i)
    if kind == "ts":
        return _without(motif, nodes, [i], ("stick", i))
    if kind == "su" and motif.incoming(i) != motif.modes[i + 1]:
        events, modes = list(motif.events), list(motif.modes)
        events[i], modes[i] = "t", motif.modes[i + 1]
        turning = replace(motif, events=tuple(events), modes=tuple(modes))
        return _without(turning, nodes, [i + 1], ("turn", i))
    return _without(motif, nodes, [i, i + 1], ("hold" if kind == "us" else "flight", i - 1))


def _grazing(motif: Motif, nodes: np.ndarray, i: int, room: Mapping[int, float]) -> Merged | None:
    """Rewrite an impact of speed zero, event i."""
    if motif.frictionless:
        motif, nodes, i = _inwards(motif, nodes, i, room)
        return _without(motif, nodes, [i], ("reversal", i - 1)) if i > 0 else None
    side = WALLS[motif.events[i]]
    events, nodes = list(motif.events), nodes.copy()
    events[i], nodes[i, 1] = "t", side * room[side]
    return replace(motif, events=tuple(events)), nodes, ("wall", i)


def _inwards(
    motif: Motif, nodes: np.ndarray, i: int, room: Mapping[int, float]
) -> tuple[Motif, np.ndarray, int]:
    """Rotate the word until event i is not the first one and event i + 1 exists, if it is long enough; return word, nodes and the new i."""
    for _ in range(len(motif)):
        if i > 0 and i + 1 < len(motif):
            break
        last = nodes[:1].copy()
        last[:, 1:] *= motif.twist
        last[:, 0] += np.pi * motif.periods * (1 if motif.half else 2)
        letter = motif.events[0]
        if motif.half and letter not in WALLS:  # mirrored about the middle between the walls
            last[:, 1] += room[1] - room[-1]
        following = MIRRORED.get(letter, letter) if motif.half else letter
        motif = replace(
            motif,
            events=(*motif.events[1:], following),
            modes=(*motif.modes[1:], motif.twist * motif.modes[0]),
        )
        nodes, i = np.concatenate([nodes[1:], last]), (i - 1) % len(motif)
    return motif, nodes, i


def _pair(motif: Motif, nodes: np.ndarray, i: int) -> str:
    """Return the letters of event i and the next one if they form one of `PAIRS` at one instant, else an empty text."""
    last = i + 1 == len(motif)
    turn = np.pi * motif.periods * (1 if motif.half else 2)
    span = nodes[0, 0] + turn - nodes[i, 0] if last else nodes[i + 1, 0] - nodes[i, 0]
    pair = motif.events[i] + motif.arrival(i)[0]
    return pair if abs(span) < PROVING.short and pair in PAIRS else ""


def _without(motif: Motif, nodes: np.ndarray, places: Sequence[int], margin: tuple[str, int]) -> Merged:
    """Remove the events `places`; `margin` is the margin of the shorter word that vanishes."""
    keep = [i for i in range(len(motif)) if i not in places]
    shorter = replace(
        motif, events=tuple(motif.events[i] for i in keep), modes=tuple(motif.modes[i] for i in keep)
    )
    return shorter, nodes[keep], margin
