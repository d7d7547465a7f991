"""Margins of admissibility: what makes an orbit real, and which border a vanishing margin is.

Some numbers watch each event and the flight after it (`Alphabet.watched` says what); flows compute them, this module gives them
names, as the laws of the contacts have them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from orbits.contacts.letters import BORDERS, HIT, STRENGTH, STROBE
from orbits.numbers import UNBOUNDED
from orbits.words.alphabet import Watch
from orbits.words.word import Word


@dataclass(frozen=True)
class Margin:
    """One margin of an orbit.

    Attributes
    ----------
    kind : str
        What is watched: ``flight`` (smallest relative speed inside it), ``wall`` (distance kept from the walls),
        ``approach`` (impact speed), ``turn`` (excess of the shaking over friction), ``stick`` (reserve of friction),
        ``slip`` (rate at which friction gives way), ``hold`` (time to the slip, or reserve until then), ``push`` (of a wall that holds),
        ``switch`` (distance from its surface, or rate there) or ``duration``.
    segment : int
        Index of the event it belongs to; a flight is counted with the event before it.
    value : float
        Positive when the orbit is real.
    """

    kind: str
    segment: int
    value: float


def place_of(word: Word, index: int) -> tuple[int, int]:
    """The event to which margin `index` belongs (without events the first node), and what it watches: a contact, or one of `Watch`."""
    place, column = divmod(index, len(word.alphabet.columns))
    return place if len(word) else 0, word.alphabet.columns[column]


def margin_name(word: Word, index: int) -> str:
    """What margin `index` of an orbit with this word watches; see `Margin`."""
    if not word.modes:
        return "stick"  # at rest: the reserve of friction
    place, watch = place_of(word, index)
    if watch == Watch.DURATION:
        return "duration"
    if watch == Watch.STRENGTH:
        return STRENGTH[word.letter(place).kind if len(word) else STROBE]
    return word.alphabet.contacts[watch].watched(word.alphabet.entry(word.mode(place), watch))


def border_kind(word: Word, index: int) -> str:
    """The kind of border that is met where margin `index` vanishes."""
    name = margin_name(word, index)
    if name != "duration":
        return BORDERS[name]
    if not len(word):
        return "corner"
    place, _ = place_of(word, index)
    return word.alphabet.together(word.letter(place), word.letter(place + 1))


def approaches_of(word: Word, margins: np.ndarray) -> np.ndarray:
    """The margins of the impacts, their speeds, from those of all events of a cycle, or of half of them."""
    columns = word.alphabet.columns
    own = margins[columns.index(Watch.STRENGTH) :: len(columns)] if len(word) else margins[:0]
    return own[[word.letter(i).kind == HIT for i in range(own.size)]]


def margin_units(word: Word, units: tuple[float, float]) -> np.ndarray:
    """What margins of one are in a length and a rate, an entry per margin, or one for all."""
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
        return np.ones(1)
    return np.array([sizes[margin_name(word, i)] for i in range(len(word.alphabet.columns) * len(word))])


def named_margins(word: Word, values: np.ndarray) -> list[Margin]:
    """The finite margins among `values` with their names."""
    return [
        Margin(margin_name(word, index), index // len(word.alphabet.columns), float(value))
        for index, value in enumerate(values)
        if np.isfinite(value)
    ]


def limits_of(multipliers: np.ndarray) -> np.ndarray:
    """One-sided limits of multipliers at a border: infinite, of their sign, where they grow without bound, as at a graze."""
    limits = np.array(multipliers, dtype=np.complex128)
    grown = np.abs(limits) >= 0.999 * UNBOUNDED
    for part in limits.view(np.float64).reshape(-1, 2).T:
        part[grown & (np.abs(part) > 1.0)] *= np.inf
    return limits
