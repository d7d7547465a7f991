"""Margins of admissibility: what makes an orbit real, and which border a vanishing margin is.

Four numbers watch each node and the segment after it; the compiled kernels compute them (`margins` of each model), this
module gives them names.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from orbits.words import Word
from orbits.words.alphabet import is_impact

PER_NODE = 4
FLIGHT, EVENT, WALL, DURATION = range(PER_NODE)


@dataclass(frozen=True)
class Margin:
    """One margin of an orbit.

    Attributes
    ----------
    kind : str
        What is watched: ``flight`` (smallest relative speed inside it), ``wall`` (distance kept from the walls),
        ``approach`` (impact speed), ``turn`` (excess of the shaking over friction), ``stick`` (reserve of friction),
        ``slip`` (rate at which friction gives way), ``hold`` (time to the slip) or ``duration``.
    segment : int
        Index of the event it belongs to; a flight is counted with the event before it.
    value : float
        Positive when the orbit is real.
    """

    kind: str
    segment: int
    value: float


def margin_name(word: Word, index: int) -> str:
    """What margin `index` of an orbit with this word watches; see `Margin`."""
    place, column = divmod(index, PER_NODE)
    if not len(word):
        return "stick"  # the reserve of friction
    letter = word.events[place % len(word)]
    if column == FLIGHT:
        if word.modes[place % len(word)] == 0 and not word.frictionless:
            return "hold"
        return "wall" if word.frictionless else "flight"
    if column == EVENT:
        return "approach" if is_impact(letter) else {"t": "turn", "s": "stick", "u": "slip"}[letter]
    return "wall" if column == WALL else "duration"


def border_kind(word: Word, index: int) -> str:
    """The kind of border that is met where margin `index` vanishes."""
    place, _ = divmod(index, PER_NODE)
    name = margin_name(word, index)
    if name == "duration":
        here, following = word.events[place % len(word)], word.events[(place + 1) % len(word)]
        if is_impact(here) and is_impact(following):
            return "chatter"
        return "stick" if "s" in (here, following) or "u" in (here, following) else "velocity-graze"
    return {
        "flight": "velocity-graze",
        "wall": "wall-graze",
        "approach": "wall-graze",
        "turn": "stick",
        "stick": "stick",
        "slip": "stick",
        "hold": "stick",
    }[name]


def named_margins(word: Word, values: np.ndarray) -> list[Margin]:
    """The finite margins among `values`, shape (4 L,), with their names."""
    return [
        Margin(margin_name(word, index), index // PER_NODE, float(value))
        for index, value in enumerate(values)
        if np.isfinite(value)
    ]
