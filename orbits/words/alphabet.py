"""Alphabets: the letters of a set of contacts, their modes, and the mirror image of both.

A mode says for every contact what it is doing between two events: a wall is free (0) or holds (1), a friction slides (-1, +1),
sticks (0) or is absent (2), a switch has its sign. An event changes the mode of its own contact; an impact may also turn
the sign of a friction or of a switch.

The shaken machines (`absorber`, `coupled`, `cavity`) have two walls and one friction, whose mode alone is written: the absorber slides
towards the right wall (mode ``-``, w' < 0), towards the left wall (mode ``+``, w' > 0) or sticks to the cavity floor (mode ``0``).

======  =====================================================  ==================
letter  event                                                  next mode
======  =====================================================  ==================
``L``   impact on the left wall, w = +1, reached in ``+``      ``-``
``R``   impact on the right wall, w = -1, reached in ``-``     ``+``
``t``   turn: w' = 0 while the shaking beats friction          the other sliding
``s``   stick: w' = 0 while friction holds                     ``0``
``u``   slip: friction gives way                               ``-`` or ``+``
======  =====================================================  ==================
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import IntEnum
from functools import cached_property
from typing import TYPE_CHECKING, Any

from orbits.contacts.dry_friction import ABSENT, SLIDE_BACK, SLIDE_ON, FrictionLaw
from orbits.contacts.letters import HIT, SWITCH, Letter
from orbits.contacts.letters import NAMES as KINDS
from orbits.contacts.wall import FREE, WallLaw

if TYPE_CHECKING:
    from orbits.contacts.letters import Mode


class Watch(IntEnum):
    """What a margin of an event watches, where it is no contact between events (those are 0, 1, ...)."""

    STRENGTH = -1
    DURATION = -2


@dataclass(frozen=True, eq=False)
class Alphabet:
    """The letters of a machine.

    Attributes
    ----------
    contacts : tuple
        Laws of contact: walls, frictions, switches.
    mirror : dict of int to int, or None
        Contact -> its mirror image.
    turned : frozenset of int
        Switches whose sign the mirror turns.
    flips : dict of (wall, contact) to int or None
        Sign of a friction's velocity, or of a switch, after an impact (before it: the opposite); None: an impact may leave
        either. A pair that is not listed: the impact does not touch it.
    rides : frozenset of (switch, friction)
        Switches whose surface moves with the velocity of a friction: it has an extreme wherever that one turns or sticks.
    alone : int, optional
        The contact whose mode alone is written; the others have one mode only. Left out: one entry per contact.
    without : frozenset of int
        Frictions that are absent whatever the mode says (with `alone`).
    watched : tuple of int
        What each of the margins per event watches: the index of a contact, in the flight after the event, or one of `Watch`. Left out: every
        contact, the event's strength, the flight's duration.
    """

    contacts: tuple[Any, ...]
    mirror: Mapping[int, int] | None = None
    turned: frozenset[int] = frozenset()
    flips: Mapping[tuple[int, int], int | None] = field(default_factory=dict)
    rides: frozenset[tuple[int, int]] = frozenset()
    alone: int | None = None
    without: frozenset[int] = frozenset()
    watched: tuple[int, ...] = ()

    @cached_property
    def columns(self) -> tuple[int, ...]:
        """`watched`, or what stands for it."""
        return self.watched or (*range(len(self.contacts)), Watch.STRENGTH, Watch.DURATION)

    @cached_property
    def letters(self) -> dict[str, Letter]:
        """By their text."""
        return {
            letter.text: letter for j, contact in enumerate(self.contacts) for letter in contact.events(j)
        }

    @cached_property
    def walled(self) -> bool:
        """Whether there is a wall that can be hit."""
        return any(letter.kind == HIT for letter in self.letters.values())

    @cached_property
    def codes(self) -> dict[str, int]:
        """Numbers of the letters, in kernels and in rows of events."""
        return {letter: code for code, letter in enumerate(self.letters)}

    def text_of(self, contact: int, kind: int, sign: int = 0) -> str:
        """The letter's text."""
        for letter in self.letters.values():
            if letter.contact == contact and letter.kind == kind and (kind != SWITCH or letter.sign == sign):
                return letter.text
        raise KeyError(f"{KINDS[kind]} is no event of {self.contacts[contact]!r}")

    # ------------------------------------------------------------------ modes
    def entry(self, mode: Mode, contact: int) -> int:
        """What a contact does in a mode."""
        if isinstance(mode, tuple):
            return mode[contact]
        return mode if contact == self.alone else FREE

    def entries(self, mode: Mode) -> tuple[int, ...]:
        """What every contact does in a mode."""
        return (
            mode if isinstance(mode, tuple) else tuple(self.entry(mode, j) for j in range(len(self.contacts)))
        )

    def with_entry(self, mode: Mode, contact: int, value: int) -> Mode:
        """The mode with another entry for one contact."""
        if not isinstance(mode, tuple):
            return value if contact == self.alone else mode
        changed = list(mode)
        changed[contact] = value
        return tuple(changed)

    def absent(self, mode: Mode, contact: int) -> bool:
        """Whether a friction's limit is zero in a mode."""
        return contact in self.without or self.entry(mode, contact) == ABSENT

    def absent_in(self, mode: Mode) -> frozenset[int]:
        """Frictions whose limit is zero in a mode."""
        return frozenset(j for j in range(len(self.contacts)) if self.entry(mode, j) == ABSENT)

    def after_impact(self, mode: Mode, wall: int) -> Mode:
        """The mode after an impact in a flight with this mode, where it turns nothing that has events of its own."""
        for (other, contact), sign in self.flips.items():
            if other == wall and contact in self.without and sign is not None:
                mode = self.with_entry(mode, contact, sign)
        return mode

    # ------------------------------------------------------------------ mirror
    @cached_property
    def images(self) -> dict[str, str]:
        """Letter -> its mirror image."""
        assert self.mirror is not None
        return {
            text: self.text_of(
                self.mirror[letter.contact],
                letter.kind,
                -letter.sign if letter.contact in self.turned else letter.sign,
            )
            for text, letter in self.letters.items()
        }

    def mirrored_mode(self, mode: Mode) -> Mode:
        """The mirror image of a mode."""
        assert self.mirror is not None
        if not isinstance(mode, tuple):
            assert self.alone is not None
            return self.contacts[self.alone].mirrored(mode, self.alone in self.turned)
        image = [0] * len(mode)
        for j, value in enumerate(mode):
            image[self.mirror[j]] = self.contacts[j].mirrored(value, j in self.turned)
        return tuple(image)

    # ------------------------------------------------------------------ pairs of events
    def touches(self, letter: Letter, contact: int) -> bool:
        """Whether an event is one of a contact's, or an impact that changes its velocity or surface."""
        return letter.contact == contact or (letter.contact, contact) in self.flips

    def together(self, here: Letter, there: Letter) -> str:
        """The kind of border at which two consecutive events fall together."""
        if here.contact == there.contact:
            return self.contacts[here.contact].together(here.kind, there.kind)
        for one, other in ((here, there), (there, here)):
            if (one.contact, other.contact) in self.rides:
                return self.contacts[one.contact].together(one.kind, one.kind)
        if self.touches(here, there.contact):
            return self.contacts[there.contact].together(there.kind, there.kind)
        if self.touches(there, here.contact):
            return self.contacts[here.contact].together(here.kind, here.kind)
        return "corner"


LEFT, RIGHT, FLOOR = range(3)
_SHAKEN: dict[str, Any] = {
    "contacts": (WallLaw("L"), WallLaw("R"), FrictionLaw("floor")),
    "mirror": {LEFT: RIGHT, RIGHT: LEFT, FLOOR: FLOOR},
    "flips": {(LEFT, FLOOR): SLIDE_BACK, (RIGHT, FLOOR): SLIDE_ON},
    "alone": FLOOR,
}
SHAKEN = Alphabet(**_SHAKEN, watched=(FLOOR, Watch.STRENGTH, LEFT, Watch.DURATION))
"""Of the machines with an absorber in a shaken cavity; one margin watches both walls."""
FRICTIONLESS = Alphabet(
    **_SHAKEN, without=frozenset((FLOOR,)), watched=(LEFT, Watch.STRENGTH, LEFT, Watch.DURATION)
)
"""The same without friction: flights may reverse freely, and only impacts are events."""

LETTERS, CODES = "".join(SHAKEN.letters), SHAKEN.codes


def shaken(frictionless: bool) -> Alphabet:
    """The alphabet of a machine with a shaken cavity."""
    return FRICTIONLESS if frictionless else SHAKEN
