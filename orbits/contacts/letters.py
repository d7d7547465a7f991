"""Letters: what an event at a contact is called, and what it does."""

from __future__ import annotations

from dataclasses import dataclass

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
