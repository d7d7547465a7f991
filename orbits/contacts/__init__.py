"""Contacts, and what words are made of there: letters of events, modes, and the changes that a contact's law proposes where a margin vanishes.

At a border the old and the new description are the same motion, so the new word's events sit at known places of the border orbit: at
its own events, or where the margin vanished. A change says so in words and places only; machines turn places into numbers.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    import numpy as np


HIT, TURN, STICK, SLIP, SWITCH, HOLD, RELEASE, STROBE = range(8)
"""What an event does."""

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
"""Margin that says how definite an event is: speed of an impact, excess or reserve of a friction, rate of a surface."""

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
"""Margin -> the kind of border at which it vanishes; of a duration that vanishes the alphabet tells (`Alphabet.together`)."""


@dataclass(frozen=True)
class Letter:
    """One letter: its text, the index of its contact, what it does, and for a switch the sign after it."""

    text: str
    contact: int
    kind: int
    sign: int = 0


Mode = int | tuple[int, ...]
"""What the contacts do between two events: an entry for each, or that of the one contact whose mode is written; read and written by the
alphabet (`orbits.words.alphabet`)."""


class What(Enum):
    """What happens to the word; the value is the sentence."""

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
    """What vanishes at the border and grows beyond it."""

    GAP = "gap"
    """The clock between the first two new events."""
    SPEED = "speed"
    """The speed of the impact that is the first new event."""
    MARGIN = "margin"
    """A margin of the new word; nothing was inserted."""


class Spot(NamedTuple):
    """Where a new event sits: at event `node` of the border orbit, or, None, where the margin vanishes inside the flight.

    `clock` names another event whose instant it takes, `between` puts it halfway to the next one, `later` moves it by so many first
    sizes of what grows.
    """

    node: int | None
    later: float = 0.0
    clock: int | None = None
    between: bool = False


@dataclass(frozen=True)
class Change:
    """Events `start` .. `stop - 1` give way to others.

    Attributes
    ----------
    start, stop : int
    events : tuple of str
    modes : tuple of modes
    spots : tuple of Spot
        Where each of the new events sits.
    grows : Grows
    what : What
    """

    start: int
    stop: int
    events: tuple[str, ...]
    modes: tuple[Mode, ...]
    spots: tuple[Spot, ...]
    grows: Grows
    what: What


class Site(NamedTuple):
    """The border orbit's word, seen from the event to which the vanishing margin belongs.

    Attributes
    ----------
    word : orbits.words.Word
        Of the whole cycle.
    place : int
        The event; a flight is counted with the event before it.
    lengths : float array
        Clock that passes in each flight.
    unit : int
        Number of events after which the cycle repeats, or mirrors, itself.
    at : int
        For a contact that is met: the event at which that is, -1 for the inside of the flight.
    sign : int
        Of the velocity after a slip whose reserve vanishes.
    ahead : bool
        Whether event `at` is the one before the flight in which the contact is met, not the one after it.
    """

    word: Any
    place: int
    lengths: np.ndarray
    unit: int
    at: int = -1
    sign: int = 0
    ahead: bool = False

    def entry(self, place: int, contact: int) -> int:
        """What a contact does after an event."""
        return self.word.alphabet.entry(self.word.mode(place), contact)

    def mode(self, place: int, contact: int, value: int) -> Mode:
        """The mode after an event, with another entry for one contact."""
        return self.word.alphabet.with_entry(self.word.mode(place), contact, value)

    def is_event(self, place: int, contact: int, *kinds: int) -> bool:
        """Whether an event inside the word is one of a contact's, of these kinds."""
        if not 0 <= place < len(self.word):
            return False
        letter = self.word.letter(place)
        return letter.contact == contact and letter.kind in kinds


class NotAlternating(ValueError):
    """The crossings of a switch in a word do not alternate."""
