"""Contacts and their contributions to words: letters of events, modes, and the changes of the word that a contact's law proposes where a margin vanishes.

At a border the old and the new word describe the same motion, so the events of the new word have known positions on the border orbit: at
its events, or where the margin vanishes. A `Change` contains letters and positions only; machines compute the numbers.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    import numpy as np


HIT, TURN, STICK, SLIP, SWITCH, HOLD, RELEASE, STROBE = range(8)
"""Kinds of events."""

NAMES = {
    HIT: "impact",
    TURN: "turn",
    STICK: "stick",
    SLIP: "slip",
    SWITCH: "switch",
    HOLD: "hold",
    RELEASE: "release",
    STROBE: "strobe",
}

STRENGTH = {
    HIT: "approach",
    TURN: "turn",
    STICK: "stick",
    SLIP: "slip",
    SWITCH: "switch",
    STROBE: "strobe",
}
"""Kind of event -> name of its margin: speed of an impact, excess or reserve of friction, rate of a surface."""

BORDERS = {
    "wall": "wall-graze",
    "approach": "wall-graze",
    "push": "wall-graze",
    "flight": "velocity-graze",
    "turn": "stick",
    "stick": "stick",
    "slip": "stick",
    "hold": "stick",
    "switch": "switch-graze",
    "strobe": "corner",
}
"""Name of a margin -> kind of border at which it vanishes; for a duration see `Alphabet.together`."""


@dataclass(frozen=True)
class Letter:
    """One letter: its text, the index of its contact, the kind of event, and for a switch the sign after it."""

    text: str
    contact: int
    kind: int
    sign: int = 0


Mode = int | tuple[int, ...]
"""State of the contacts between two events: one entry for each, or that of the only contact whose entry is written; see
`orbits.words.alphabet`."""


class WordChange(Enum):
    """Changes of a word; the value is the text."""

    STICK_APPEARS = "a stick appears inside a flight"
    STICK_DISAPPEARS = "a stick disappears inside a flight"
    STICK_BECOMES_TURN = "a stick becomes a turn"
    TURN_BECOMES_STICK = "a turn becomes a stick"
    TURN_APPEARS = "a turn appears before a stick"
    TURN_DISAPPEARS = "a turn before a stick disappears"
    TURNS_VANISH = "two turns vanish"
    SLIP_APPEARS = "friction gives way for a moment"
    SLIP_VANISHES = "a slip vanishes"
    IMPACT_APPEARS = "a flight touches a wall"
    IMPACT_VANISHES = "an impact vanishes"
    IMPACT_BECOMES_TURN = "an impact becomes a turn"
    IMPACT_MERGES = "an impact before a stick vanishes"
    TURN_HITS = "a turn hits a wall"
    STICK_HITS = "a stick hits a wall"
    CROSSINGS_APPEAR = "a flight touches a switch"
    CROSSINGS_VANISH = "two crossings of a switch vanish"
    CROSSING_APPEARS = "an impact leaves a switch to be crossed"
    CROSSING_VANISHES = "a crossing of a switch falls into an impact"
    ORDER_CHANGES = "two events change their order"


class Grows(Enum):
    """The quantity that is zero at the border and grows beyond it on the branch of the new word."""

    GAP = "gap"
    """The time between the first two new events."""
    SPEED = "speed"
    """The speed of the impact that is the first new event."""
    MARGIN = "margin"
    """A margin of the new word; no event was inserted."""


class Spot(NamedTuple):
    """Position of a new event on the border orbit.

    Attributes
    ----------
    node : int or None
        The event of the border orbit whose state it takes; None: the point inside the flight where the margin vanishes.
    later : float
        Displacement in time, in units of the first size of the growing quantity.
    clock : int or None
        Another event of the border orbit whose instant it takes.
    between : bool
        Whether its instant is halfway to the next event.
    """

    node: int | None
    later: float = 0.0
    clock: int | None = None
    between: bool = False


@dataclass(frozen=True)
class Change:
    """Replacement of the events `start` .. `stop - 1` of a word.

    Attributes
    ----------
    start, stop : int
    events : tuple of str
        The new events.
    modes : tuple of modes
        The mode after each new event.
    spots : tuple of Spot
        Position of each new event.
    grows : Grows
    effect : WordChange
    """

    start: int
    stop: int
    events: tuple[str, ...]
    modes: tuple[Mode, ...]
    spots: tuple[Spot, ...]
    grows: Grows
    effect: WordChange


class Site(NamedTuple):
    """The word of a border orbit, and the event to which the vanishing margin belongs.

    Attributes
    ----------
    word : orbits.words.Word
        Word of the whole cycle.
    place : int
        The event; a flight belongs to the event before it.
    lengths : float array
        Duration of each flight.
    unit : int
        Number of events after which the cycle repeats itself or its mirror image.
    at : int
        If a contact is reached: the event at which this happens, or -1 inside the flight.
    sign : int
        Sign of the velocity after a slip if the reserve of friction vanishes inside a stick.
    ahead : bool
        Whether event `at` is the one before the flight in which the contact is reached (else the one after it).
    """

    word: Any
    place: int
    lengths: np.ndarray
    unit: int
    at: int = -1
    sign: int = 0
    ahead: bool = False

    def entry(self, place: int, contact: int) -> int:
        """Return the entry of a contact in the mode after an event."""
        return self.word.alphabet.entry(self.word.mode(place), contact)

    def mode(self, place: int, contact: int, value: int) -> Mode:
        """Return the mode after an event, with another entry for one contact."""
        return self.word.alphabet.with_entry(self.word.mode(place), contact, value)

    def is_event(self, place: int, contact: int, *kinds: int) -> bool:
        """Whether event `place` exists, belongs to the contact and is of one of these kinds."""
        if not 0 <= place < len(self.word):
            return False
        letter = self.word.letter(place)
        return letter.contact == contact and letter.kind in kinds


class NotAlternating(ValueError):
    """The crossings of a switch in a word do not alternate."""
