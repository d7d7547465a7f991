"""Alphabets: the letters of a set of contacts, their modes, their mirror images, and the reading of words.

A mode has one entry for every contact between two events: a wall is free (0) or holds (1); a friction slides (-1, +1),
sticks (0) or is absent (2); a switch has a sign (-1, +1). An event changes the entry of its own contact; an impact may also change
the sign of a friction or of a switch.

The shaken machines (`absorber`, `coupled`, `cavity`) have two walls and one friction. Only the friction's entry is written as mode: the absorber
slides towards the right wall (``-``, w' < 0) or the left wall (``+``, w' > 0), or sticks to the cavity floor (``0``).

======  =====================================================  ==================
letter  event                                                  next mode
======  =====================================================  ==================
``L``   impact on the left wall, w = +1, reached in ``+``      ``-``
``R``   impact on the right wall, w = -1, reached in ``-``     ``+``
``t``   turn: w' = 0 while the force exceeds friction          the other sliding
``s``   stick: w' = 0 while friction holds                     ``0``
``u``   slip: the force exceeds friction after a stick         ``-`` or ``+``
======  =====================================================  ==================
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import IntEnum
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from orbits.contacts import HIT, NAMES, SLIP, STICK, SWITCH, Letter, NotAlternating
from orbits.contacts import NAMES as KINDS
from orbits.contacts.dry_friction import ABSENT, SLIDE_BACK, SLIDE_ON, STUCK, CannotFollow, Event, FrictionLaw
from orbits.contacts.wall import FREE, WallLaw

if TYPE_CHECKING:
    from orbits.contacts import Mode

SHOWN = 60  # longest word that a message shows in full
MARKS = {-1: "-", 0: "0", 1: "+", ABSENT: "f"}
DOING = {-1: "sliding back", STUCK: "stuck", 1: "sliding on", None: "open"}


class Watch(IntEnum):
    """Margins that belong to an event or to the duration of a flight; margins of contacts inside a flight have the contact's index 0, 1, ..."""

    STRENGTH = -1
    DURATION = -2


@dataclass(frozen=True, eq=False)
class Alphabet:
    """The letters and modes of a machine.

    Attributes
    ----------
    contacts : tuple
        Laws of contact: walls, frictions, switches.
    mirror : dict of int to int, or None
        Contact -> its mirror image; None if the machine is not symmetric.
    turned : frozenset of int
        Switches whose sign changes in the mirror image.
    flips : dict of (wall, contact) to int or None
        Sign of a friction's velocity, or of a switch, after an impact on the wall (before it: the opposite sign); None: both signs are
        possible after the impact. The impact has no effect on pairs that are not listed.
    rides : frozenset of (switch, friction)
        Switches whose surface moves with the velocity of a friction, so that it has an extremum wherever the friction turns or sticks.
    alone : int, optional
        The only contact whose entry is written as mode, an int; default: a mode is a tuple with one entry per contact.
    without : frozenset of int
        Frictions that are absent in every mode (with `alone`).
    watched : tuple of int
        The margins of each event, in order: the index of a contact, for its margin in the flight after the event, or one of `Watch`. Default:
        all contacts, the strength of the event, the duration of the flight.
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
        """The margins of each event: `watched`, or its default."""
        return self.watched or (*range(len(self.contacts)), Watch.STRENGTH, Watch.DURATION)

    @cached_property
    def letters(self) -> dict[str, Letter]:
        """Text -> letter."""
        return {
            letter.text: letter for j, contact in enumerate(self.contacts) for letter in contact.events(j)
        }

    @cached_property
    def walled(self) -> bool:
        """Whether the machine has a wall with impacts."""
        return any(letter.kind == HIT for letter in self.letters.values())

    @cached_property
    def codes(self) -> dict[str, int]:
        """Text of a letter -> its code in kernels and in rows of events."""
        return {letter: code for code, letter in enumerate(self.letters)}

    def text_of(self, contact: int, kind: int, sign: int = 0) -> str:
        """Return the text of a letter, given its contact, kind and (for a switch) sign."""
        for letter in self.letters.values():
            if letter.contact == contact and letter.kind == kind and (kind != SWITCH or letter.sign == sign):
                return letter.text
        raise KeyError(f"{KINDS[kind]} is no event of {self.contacts[contact]!r}")

    # ------------------------------------------------------------------ modes
    def entry(self, mode: Mode, contact: int) -> int:
        """Return the entry of a contact in a mode."""
        if isinstance(mode, tuple):
            return mode[contact]
        return mode if contact == self.alone else FREE

    def entries(self, mode: Mode) -> tuple[int, ...]:
        """Return the entries of all contacts in a mode."""
        return (
            mode if isinstance(mode, tuple) else tuple(self.entry(mode, j) for j in range(len(self.contacts)))
        )

    def with_entry(self, mode: Mode, contact: int, value: int) -> Mode:
        """Return the mode with another entry for one contact."""
        if not isinstance(mode, tuple):
            return value if contact == self.alone else mode
        changed = list(mode)
        changed[contact] = value
        return tuple(changed)

    def absent(self, mode: Mode, contact: int) -> bool:
        """Whether a friction is absent (has the limit zero) in a mode."""
        return contact in self.without or self.entry(mode, contact) == ABSENT

    def absent_in(self, mode: Mode) -> frozenset[int]:
        """Return the frictions that are absent (have the limit zero) in a mode."""
        return frozenset(j for j in range(len(self.contacts)) if self.entry(mode, j) == ABSENT)

    def after_impact(self, mode: Mode, wall: int) -> Mode:
        """Return the mode after an impact that changes only the signs of absent frictions."""
        for (other, contact), sign in self.flips.items():
            if other == wall and contact in self.without and sign is not None:
                mode = self.with_entry(mode, contact, sign)
        return mode

    # ------------------------------------------------------------------ mirror
    @cached_property
    def images(self) -> dict[str, str]:
        """Text of a letter -> text of its mirror image."""
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
        """Return the mirror image of a mode."""
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
        """Whether an event belongs to a contact, or is an impact that changes the contact's velocity or surface."""
        return letter.contact == contact or (letter.contact, contact) in self.flips

    def together(self, first: Letter, second: Letter) -> str:
        """Return the kind of border at which two consecutive events coincide."""
        if first.contact == second.contact:
            return self.contacts[first.contact].together(first.kind, second.kind)
        for one, other in ((first, second), (second, first)):
            if (one.contact, other.contact) in self.rides:
                return self.contacts[one.contact].together(one.kind, one.kind)
        if self.touches(first, second.contact):
            return self.contacts[second.contact].together(second.kind, second.kind)
        if self.touches(second, first.contact):
            return self.contacts[first.contact].together(first.kind, first.kind)
        return "corner"


LEFT, RIGHT, FLOOR = range(3)
_SHAKEN: dict[str, Any] = {
    "contacts": (WallLaw("L"), WallLaw("R"), FrictionLaw("floor")),
    "mirror": {LEFT: RIGHT, RIGHT: LEFT, FLOOR: FLOOR},
    "flips": {(LEFT, FLOOR): SLIDE_BACK, (RIGHT, FLOOR): SLIDE_ON},
    "alone": FLOOR,
}
SHAKEN = Alphabet(**_SHAKEN, watched=(FLOOR, Watch.STRENGTH, LEFT, Watch.DURATION))
"""Alphabet of the machines with an absorber in a shaken cavity; one margin is the distance from both walls."""
FRICTIONLESS = Alphabet(
    **_SHAKEN, without=frozenset((FLOOR,)), watched=(LEFT, Watch.STRENGTH, LEFT, Watch.DURATION)
)
"""The same without friction: the velocity may change sign in flights, and only impacts are events."""

LETTERS, CODES = "".join(SHAKEN.letters), SHAKEN.codes


def shaken(frictionless: bool) -> Alphabet:
    """Return the alphabet of a machine with a shaken cavity."""
    return FRICTIONLESS if frictionless else SHAKEN


class WordError(ValueError):
    """A word with unknown letters or an impossible order of events."""


def bracket(mode: Sequence[int], alphabet: Alphabet) -> str:
    """Return a mode as written after an event, in brackets."""
    signs = [
        MARKS[value] if not isinstance(contact, WallLaw) else ("h" if value else "")
        for value, contact in zip(mode, alphabet.contacts)
    ]
    return f"[{''.join(signs)}]"


def read(
    text: str | Sequence[str],
    alphabet: Alphabet,
    absent: frozenset[int] = frozenset(),
) -> tuple[tuple[str, ...], tuple[Any, ...]]:
    """Read a word and return its events and modes.

    Parameters
    ----------
    text : str or sequence of str
        Letters, with or without blanks. The slip after a stick may be omitted. The direction of a slip is written
        ``s+`` or ``s-`` if the events do not determine it. ``[+0]`` after an event gives the entries of frictions and switches in the
        order of the contacts. For a shaken machine also the impact maps, as blank-separated pairs (``LR RL``).
    alphabet : Alphabet
    absent : set of int
        Frictions whose limit is zero.

    Returns
    -------
    tuple of str
        Events, with all slips.
    tuple
        Mode after each event; without events one mode, or none for a shaken machine.

    Raises
    ------
    WordError
        If a letter is unknown or the events cannot follow one another.
    """
    if not isinstance(text, str | Sequence):
        raise WordError(f"word = {text!r} is no word: give the events of a period as text, such as 'LR'")
    source = (text if isinstance(text, str) else " ".join(map(str, text))).replace("−", "-")
    quoted = repr(source if len(source) <= SHOWN else f"{source[:40]}...")
    if alphabet.alone is not None:
        source = _from_maps(source, alphabet)
    items, mode = _items(source, alphabet, quoted)
    if not items:
        if alphabet.alone is not None:
            return (), ()
        return (), (_mode_of(mode, alphabet, quoted) if mode else _mode_without_events(alphabet, absent),)
    letters = alphabet.letters
    expanded: list[tuple[str, str | None]] = []
    notes: list[str | None] = []
    for k, (item, sign, note) in enumerate(items):
        letter = letters[item]
        follower = letters[items[(k + 1) % len(items)][0]]
        written = follower.contact == letter.contact and follower.kind == SLIP
        if letter.kind == STICK and not written and (sign is not None or not _slips_later(items, k, letters)):
            expanded += [(item, None), (alphabet.text_of(letter.contact, SLIP), sign)]
            notes += [None, note]
        else:
            expanded.append((item, sign))
            notes.append(note)
    fixed = {i: _mode_of(note, alphabet, quoted) for i, note in enumerate(notes) if note}
    return tuple(text for text, _ in expanded), _modes(expanded, alphabet, absent, fixed, quoted)


def _from_maps(source: str, alphabet: Alphabet) -> str:
    """Convert maps between impacts, such as ``G_LR G_RL``, to events; in other text only commas are replaced by blanks and ``G_`` is removed."""
    tokens = [token.removeprefix("G_") for token in source.replace(",", " ").split()]
    maps = len(tokens) > 1 and all(re.fullmatch("[LR]{2}", token) for token in tokens)
    if not maps or any(one[1] != other[0] for one, other in zip(tokens, tokens[1:] + tokens[:1])):
        return " ".join(tokens)
    joint = "" if alphabet.without else "t"
    return "".join(token[0] + (joint if token[0] == token[1] else "") for token in tokens)


def _items(
    source: str, alphabet: Alphabet, quoted: str
) -> tuple[list[tuple[str, str | None, str | None]], str]:
    """Split a text into letters with their signs and modes; also return a mode that is written without an event."""
    letters = alphabet.letters
    tokens = "|".join(map(re.escape, sorted(letters, key=len, reverse=True))) or "(?!)"
    pattern = re.compile(rf"\s*(?:({tokens})([+-]?)(\[[^\]]*\])?|(\[[^\]]*\]))\s*")
    place, items, mode = 0, [], ""
    source = source.strip()
    while place < len(source):
        match = pattern.match(source, place)
        if match is None:
            choices = ", ".join(f"{text} ({NAMES[letter.kind]})" for text, letter in letters.items())
            raise WordError(
                f"word {quoted} has the letter {source[place]!r}: this machine has {choices or 'no events'}; the direction of a slip "
                "is written as a sign, + or -, after it or after its stick"
            )
        if match[1] is None:
            mode = match[4]
        else:
            if match[2] and letters[match[1]].kind not in (STICK, SLIP):
                raise WordError(f"word {quoted}: only a stick or a slip takes a sign, not {match[1]!r}")
            items.append((match[1], match[2] or None, match[3]))
        place = match.end()
    return items, mode


def _slips_later(items: Sequence[Any], place: int, letters: Mapping[str, Letter]) -> bool:
    """Whether the next event of the friction that sticks at `place` is a slip."""
    contact = letters[items[place][0]].contact
    for step in range(1, len(items)):
        other = letters[items[(place + step) % len(items)][0]]
        if other.contact == contact:
            return other.kind == SLIP
    return False


def _mode_of(note: str, alphabet: Alphabet, quoted: str) -> tuple[int, ...]:
    """Read a mode in brackets."""
    marks = list(note[1:-1])
    values = {mark: value for value, mark in MARKS.items()}
    mode = []
    for contact in alphabet.contacts:
        if isinstance(contact, WallLaw):
            held = bool(marks) and marks[0] == "h"
            mode.append(int(held))
            marks = marks[1:] if held else marks
        elif marks and marks[0] in values:
            mode.append(values[marks.pop(0)])
        else:
            marks = ["?"]
            break
    if marks or alphabet.alone is not None:
        raise WordError(
            f"word {quoted}: {note} must give one of + - 0 for every friction and + or - for every switch, in their order"
        )
    return tuple(mode)


def _mode_without_events(alphabet: Alphabet, absent: frozenset[int]) -> tuple[int, ...]:
    """Default mode of a word without events: walls free, frictions sticking, switches positive."""
    mode = []
    for j, contact in enumerate(alphabet.contacts):
        if isinstance(contact, WallLaw):
            mode.append(FREE)
        elif j in absent:
            mode.append(ABSENT)
        else:
            mode.append(STUCK if isinstance(contact, FrictionLaw) else 1)
    return tuple(mode)


def _modes(
    items: Sequence[tuple[str, str | None]],
    alphabet: Alphabet,
    absent: frozenset[int],
    fixed: Mapping[int, tuple[int, ...]],
    quoted: str,
) -> tuple[Any, ...]:
    """Return the mode after each event; a direction that the events do not determine is a reversal at a slip, else the default of the law."""
    letters = [alphabet.letters[text] for text, _ in items]
    signs = [{"+": 1, "-": -1, None: None}[sign] for _, sign in items]
    columns = []
    for j, contact in enumerate(alphabet.contacts):
        if alphabet.alone not in (None, j):
            continue
        noted = {i: mode[j] for i, mode in fixed.items()}
        if isinstance(contact, WallLaw):
            columns.append([FREE] * len(items))
        elif j in absent or j in alphabet.without:
            if any(letter.contact == j for letter in letters):
                raise WordError(
                    f"word {quoted}: friction {contact.name!r} is zero here, and its turns, sticks and slips are no events without "
                    "friction: write the other events only, or give friction (and gravity) values above 0"
                )
            flips = [alphabet.flips.get((letter.contact, j)) for letter in letters]
            columns.append([ABSENT if j in absent else int(sign or 0) for sign in flips])
        elif isinstance(contact, FrictionLaw):
            columns.append(_directions(j, letters, signs, alphabet, noted, quoted))
        else:
            hits = {
                i: alphabet.flips[letter.contact, j]
                for i, letter in enumerate(letters)
                if (letter.contact, j) in alphabet.flips
            }
            try:
                columns.append(contact.signs(letters, j, noted, hits))
            except NotAlternating:
                between = "; impacts may change its sign between them" if hits else ""
                raise WordError(
                    f"word {quoted}: the crossings of switch {contact.name!r} must alternate, "
                    f"{contact.letters[0]} and {contact.letters[1]}{between}"
                ) from None
    return tuple(columns[0]) if alphabet.alone is not None else tuple(zip(*columns))


def _directions(
    j: int,
    letters: Sequence[Letter],
    signs: Sequence[int | None],
    alphabet: Alphabet,
    noted: Mapping[int, int],
    quoted: str,
) -> list[int]:
    """Return the entry of friction j after each event: its law computes it for events that affect it; between these it stays the same."""
    friction: FrictionLaw = alphabet.contacts[j]
    places = [i for i, letter in enumerate(letters) if alphabet.touches(letter, j)]
    if not places:
        return [next(iter(noted.values()), 1)] * len(letters)
    beats = [
        Event(letters[i].kind, alphabet.flips[letters[i].contact, j] if letters[i].kind == HIT else signs[i])
        for i in places
    ]
    last = np.searchsorted(places, range(len(letters)), side="right") - 1  # -1: the last one, cyclically
    fixed = {int(last[i]) % len(places): mode for i, mode in noted.items()}
    try:
        modes = friction.directions(beats, fixed)
    except CannotFollow as error:
        place = places[error.event]
        letter, before = letters[place], letters[places[error.event - 1]]
        turn, stick, slip = friction.letters
        hint = ""
        if letter.kind == SLIP:
            hint = f"; a slip that follows no stick is none: write {stick} for a stick and its slip"
        elif letter.kind == HIT and letter.contact == before.contact:
            hint = f"; between two impacts on one wall there is a turn ({letter.text}{turn}{letter.text}) or a stick ({letter.text}{stick}{letter.text})"
        raise WordError(
            f"word {quoted} cannot be: after {before.text} friction {friction.name!r} is {DOING[error.before]}, "
            f"so event {place + 1}, {letter.text} ({NAMES[letter.kind]}), cannot come next{hint}"
        ) from None
    return [modes[k] for k in last]
