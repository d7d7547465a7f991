"""Margins of admissibility: what makes an orbit real, and which border a vanishing margin is.

Four numbers watch each node and the segment after it; the compiled kernels compute them (`margins` of each model), this
module gives them names, as the laws of the contacts have them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from orbits.contacts.letters import BORDERS, STRENGTH
from orbits.contacts.wall import FREE
from orbits.words import Word
from orbits.words.alphabet import FLOOR, LEFT

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
    contacts = word.alphabet.contacts
    if column == EVENT:
        return STRENGTH[word.letter(place).kind]
    if column == DURATION:
        return "duration"
    if column == WALL or word.frictionless:
        return contacts[LEFT].watched(FREE)
    return contacts[FLOOR].watched(word.mode(place))


def border_kind(word: Word, index: int) -> str:
    """The kind of border that is met where margin `index` vanishes."""
    name, place = margin_name(word, index), index // PER_NODE
    if name == "duration":
        return word.alphabet.together(word.letter(place), word.letter(place + 1))
    return BORDERS[name]


def approaches_of(word: Word, margins: np.ndarray) -> np.ndarray:
    """The margins of the impacts, their speeds, from those of all events of a cycle, or of half of them."""
    own = margins[EVENT::PER_NODE]
    return own[word.codes[: own.size] < 2]


def margin_units(word: Word, units: tuple[float, float]) -> np.ndarray:
    """What margins of one are in a length and a rate, shape (4 L,)."""
    length, rate = units
    sizes = {
        "flight": length * rate,
        "approach": length * rate,
        "wall": length,
        "turn": length * rate**2,
        "stick": length * rate**2,
        "slip": length * rate**3,
        "hold": 1.0 / rate,
        "duration": 1.0 / rate,
    }
    if not len(word) or (length == 1.0 and rate == 1.0):
        return np.ones(max(PER_NODE * len(word), 1))
    return np.array([sizes[margin_name(word, index)] for index in range(PER_NODE * len(word))])


def named_margins(word: Word, values: np.ndarray) -> list[Margin]:
    """The finite margins among `values`, shape (4 L,), with their names."""
    return [
        Margin(margin_name(word, index), index // PER_NODE, float(value))
        for index, value in enumerate(values)
        if np.isfinite(value)
    ]


UNBOUNDED = 0.999e15  # multipliers of 1e15, but for rounding, grow without bound towards the border


def limits_of(multipliers: np.ndarray) -> np.ndarray:
    """One-sided limits of multipliers at a border: infinite, of their sign, where they grow without bound, as at a graze."""
    limits = np.array(multipliers, dtype=np.complex128)
    grown = np.abs(limits) >= UNBOUNDED
    for part in limits.view(np.float64).reshape(-1, 2).T:
        part[grown & (np.abs(part) > 1.0)] *= np.inf
    return limits
