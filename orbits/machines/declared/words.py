"""Words over any set of contacts: the letters of an alphabet, and cyclic lists of them with their modes.

A mode says for every contact what it is doing between two events: a wall is free (0) or holds (1), a friction slides (-1, +1),
sticks (0) or is absent (2), a switch has its sign. An event changes the mode of its own contact; an impact may also turn
the sign of a friction.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from orbits.contacts.dry_friction import ABSENT, STUCK, DryFriction
from orbits.contacts.switch import Switch
from orbits.contacts.wall import FREE, Wall
from orbits.words import WordError

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


@dataclass(frozen=True)
class Letter:
    """One letter: its text, the index of its contact, what it does, and for a switch the sign after it."""

    text: str
    contact: int
    kind: int
    sign: int = 0


@dataclass(frozen=True, eq=False)
class Alphabet:
    """The letters of a machine.

    Attributes
    ----------
    contacts : tuple
    mirror : dict of int to int, or None
        Contact -> its mirror image.
    turned : frozenset of int
        Switches whose sign the mirror turns.
    flips : dict of (wall, friction) to int or None
        Sign of the friction's velocity after an impact (before it: the opposite); None: an impact may leave either.
        A pair that is not listed: the impact does not touch the velocity.
    """

    contacts: tuple[Any, ...]
    mirror: Mapping[int, int] | None = None
    turned: frozenset[int] = frozenset()
    flips: Mapping[tuple[int, int], int | None] = field(default_factory=dict)

    @cached_property
    def letters(self) -> dict[str, Letter]:
        """By their text."""
        found: dict[str, Letter] = {}
        for j, contact in enumerate(self.contacts):
            for letter in _letters(j, contact):
                found[letter.text] = letter
        return found

    def text_of(self, contact: int, kind: int, sign: int = 0) -> str:
        """The letter's text."""
        for letter in _letters(contact, self.contacts[contact]):
            if letter.kind == kind and (kind != SWITCH or letter.sign == sign):
                return letter.text
        raise KeyError(f"{NAMES[kind]} is no event of {self.contacts[contact]!r}")

    def mirrored_letter(self, text: str) -> str:
        """The mirror image of a letter."""
        letter = self.letters[text]
        assert self.mirror is not None
        sign = -letter.sign if letter.contact in self.turned else letter.sign
        return self.text_of(self.mirror[letter.contact], letter.kind, sign)

    def mirrored_mode(self, mode: Sequence[int]) -> tuple[int, ...]:
        """The mirror image of a mode."""
        assert self.mirror is not None
        image = [0] * len(mode)
        for j, value in enumerate(mode):
            contact = self.contacts[j]
            turns = isinstance(contact, DryFriction) or j in self.turned
            image[self.mirror[j]] = -value if turns and value in (-1, 1) else value
        return tuple(image)


def _letters(j: int, contact: Any) -> list[Letter]:
    if isinstance(contact, Wall):
        return [Letter(contact.letter, j, HIT)]
    if isinstance(contact, DryFriction):
        return [Letter(text, j, kind) for text, kind in zip(contact.letters, (TURN, STICK, SLIP))]
    plus, minus = contact.letters
    return [Letter(plus, j, SWITCH, 1), Letter(minus, j, SWITCH, -1)]


@dataclass(frozen=True)
class Word:
    """A cyclic list of events with the mode that follows each of them.

    Attributes
    ----------
    events : tuple of str
    modes : tuple of tuples of int
        One entry per contact, after each event; a word without events has one mode.
    alphabet : Alphabet
    """

    events: tuple[str, ...]
    modes: tuple[tuple[int, ...], ...]
    alphabet: Alphabet = field(compare=False, repr=False)

    def _like(self, events: Sequence[str], modes: Sequence[tuple[int, ...]]) -> Word:
        return Word(tuple(events), tuple(modes), self.alphabet)

    def __len__(self) -> int:
        return len(self.events)

    def __str__(self) -> str:
        return self.text

    def letter(self, place: int) -> Letter:
        """The letter of an event."""
        return self.alphabet.letters[self.events[place % len(self.events)]]

    @property
    def impacts(self) -> int:
        """Number of impacts."""
        return sum(self.alphabet.letters[text].kind == HIT for text in self.events)

    # ------------------------------------------------------------------ text
    @cached_property
    def text(self) -> str:
        """As it is written in studies: modes appear, in brackets, only where the events leave them open."""
        turns = bool(self.events) and all(self.letter(i).kind == TURN for i in range(len(self)))
        for signed, noted in ((False, ()), (True, ()), (True, (0,))):
            text = self._written(signed, noted)
            try:
                read = parse(text, self.alphabet, _absent(self.modes[0]))
                places = range(len(self)) if turns and read.events == self.events else (0,)
                if any(read.rotate(k) == self for k in places):
                    return text  # the same cycle, even where the text leaves open from which event it is read
            except WordError:
                pass
        return self._written(False, range(len(self.modes)))

    def _written(self, signed: bool, noted: Sequence[int]) -> str:
        if not self.events:
            return _bracket(self.modes[0], self.alphabet) if noted else ""
        parts: list[str] = []
        n = len(self.events)
        joined = not noted or len(noted) < n
        for i, text in enumerate(self.events):
            letter, before, following = self.letter(i), self.letter(i - 1), self.letter(i + 1)
            own = letter.contact
            if joined and letter.kind == SLIP and i > 0 and before.kind == STICK and before.contact == own:
                continue
            mark = ""
            if signed and letter.kind == SLIP:
                mark = "+" if self.modes[i][own] > 0 else "-"
            elif signed and joined and letter.kind == STICK and following.kind == SLIP and i + 1 < n:
                mark = "+" if self.modes[(i + 1) % n][own] > 0 else "-"
            parts.append(text + mark + (_bracket(self.modes[i], self.alphabet) if i in noted else ""))
        joint = " " if any(len(text) > 1 for text in self.events) else ""
        return joint.join(parts)

    # ------------------------------------------------------------------ transformations
    def rotate(self, places: int) -> Word:
        """The same cycle read from the event `places` further on."""
        if not self.events:
            return self
        k = places % len(self.events)
        return self._like(self.events[k:] + self.events[:k], self.modes[k:] + self.modes[:k])

    def mirror(self) -> Word:
        """The word of the mirror image."""
        a = self.alphabet
        return self._like(
            [a.mirrored_letter(text) for text in self.events], [a.mirrored_mode(mode) for mode in self.modes]
        )

    def repeat(self, times: int) -> Word:
        """The word written `times` times."""
        return self._like(self.events * times, self.modes * times if self.events else self.modes)

    def double(self) -> Word:
        """The word written twice."""
        return self.repeat(2)

    def head(self, length: int) -> Word:
        """The first `length` events."""
        return self._like(self.events[:length], self.modes[:length] if self.events else self.modes)

    @cached_property
    def repetitions(self) -> int:
        """How often the primitive root is written in this word."""
        n = len(self.events)
        for length in range(1, n):
            if n % length == 0 and self.rotate(length) == self:
                return n // length
        return 1

    @cached_property
    def readings(self) -> list[tuple[bool, int]]:
        """(mirrored, rotation) of every way in which this word reads as its canonical form."""
        words = [(False, self)] + ([(True, self.mirror())] if self.alphabet.mirror is not None else [])
        found = [(w.rotate(k), mirrored, k) for mirrored, w in words for k in range(max(1, len(self.events)))]
        best = min((w.events, w.modes) for w, _, _ in found)
        return [(mirrored, k) for w, mirrored, k in found if (w.events, w.modes) == best]

    def canonical(self) -> Word:
        """The smallest of all rotations of the word and of its mirror image."""
        mirrored, k = self.readings[0]
        return (self.mirror() if mirrored else self).rotate(k)

    @property
    def mirror_symmetric_halves(self) -> bool:
        """Whether the second half is the mirror image of the first."""
        if self.alphabet.mirror is None:
            return False
        n = len(self.events)
        if n == 0:
            return self.mirror() == self
        return n % 2 == 0 and self.rotate(n // 2) == self.mirror()


def _bracket(mode: Sequence[int], alphabet: Alphabet) -> str:
    marks = {-1: "-", 0: "0", 1: "+", 2: "f"}
    shown = [
        marks[value] if not isinstance(contact, Wall) else ("h" if value else "")
        for value, contact in zip(mode, alphabet.contacts)
    ]
    return f"[{''.join(shown)}]"


def _absent(mode: Sequence[int]) -> frozenset[int]:
    return frozenset(j for j, value in enumerate(mode) if value == ABSENT)


# ---------------------------------------------------------------------- reading
def parse(
    text: str, alphabet: Alphabet, absent: frozenset[int] = frozenset(), default: Sequence[int] | None = None
) -> Word:
    """Read a word.

    Parameters
    ----------
    text : str
        Letters, with or without blanks. A stick may stand for itself and the slip after it; a slip's direction is written
        ``s+`` or ``s-`` where it does not follow; ``[+0]`` after an event gives the modes of frictions and switches in the
        order of the contacts.
    alphabet : Alphabet
    absent : set of int
        Frictions whose limit is zero.
    default : sequence of int, optional
        The mode of contacts that no event of the word fixes.

    Raises
    ------
    WordError
        If a letter is unknown or the events cannot follow one another.
    """
    letters = alphabet.letters
    tokens = sorted(letters, key=len, reverse=True)
    pattern = (
        re.compile(rf"\s*(?:({'|'.join(map(re.escape, tokens))})([+-]?)(\[[^\]]*\])?|(\[[^\]]*\]))\s*")
        if tokens
        else re.compile(r"\s*()()()(\[[^\]]*\])\s*")
    )
    place, items, alone = 0, [], None
    source = text.strip()
    while place < len(source):
        match = pattern.match(source, place)
        if match is None:
            raise WordError(
                f"word {text!r}: {source[place]!r} begins no letter of this machine; it has {', '.join(letters)}"
            )
        if match[1] is None:
            alone = match[4]
        else:
            kind = letters[match[1]].kind
            if match[2] and kind not in (STICK, SLIP):
                raise WordError(f"word {text!r}: only a stick or a slip takes a sign, not {match[1]!r}")
            items.append((match[1], match[2] or None, match[3]))
        place = match.end()
    if not items:
        mode = _mode_of(alone, alphabet, text) if alone else _open(alphabet, absent, default)
        return Word((), (mode,), alphabet)
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
    fixed = {i: _mode_of(note, alphabet, text) for i, note in enumerate(notes) if note}
    modes = assigned(expanded, alphabet, absent, fixed, default, text)
    return Word(tuple(t for t, _ in expanded), modes, alphabet)


def _slips_later(items: Sequence[Any], place: int, letters: Mapping[str, Letter]) -> bool:
    """Whether the next event of a stick's friction is a slip that is written out."""
    own = letters[items[place][0]].contact
    for step in range(1, len(items)):
        other = letters[items[(place + step) % len(items)][0]]
        if other.contact == own:
            return other.kind == SLIP
    return False


def _mode_of(note: str, alphabet: Alphabet, text: str) -> tuple[int, ...]:
    marks = list(note[1:-1].replace("−", "-"))
    values = {"+": 1, "-": -1, "0": 0, "f": ABSENT}
    mode = []
    for contact in alphabet.contacts:
        if isinstance(contact, Wall):
            held = bool(marks) and marks[0] == "h"
            mode.append(int(held))
            marks = marks[1:] if held else marks
        elif marks and marks[0] in values:
            mode.append(values[marks.pop(0)])
        else:
            marks = ["?"]
            break
    if marks:
        raise WordError(
            f"word {text!r}: {note} must give one of + - 0 for every friction and + or - for every switch, in their order"
        )
    return tuple(mode)


def _open(alphabet: Alphabet, absent: frozenset[int], default: Sequence[int] | None) -> tuple[int, ...]:
    mode = []
    for j, contact in enumerate(alphabet.contacts):
        if isinstance(contact, Wall):
            mode.append(FREE)
        elif j in absent:
            mode.append(ABSENT)
        elif default is not None:
            mode.append(default[j])
        else:
            mode.append(STUCK if isinstance(contact, DryFriction) else 1)
    return tuple(mode)


def assigned(
    items: Sequence[tuple[str, str | None]],
    alphabet: Alphabet,
    absent: frozenset[int] = frozenset(),
    fixed: Mapping[int, tuple[int, ...]] | None = None,
    default: Sequence[int] | None = None,
    text: str = "",
) -> tuple[tuple[int, ...], ...]:
    """The mode after each event; what nothing fixes becomes a reversal at a slip, else the default.

    Raises
    ------
    WordError
        If the events cannot follow one another.
    """
    letters = [alphabet.letters[t] for t, _ in items]
    signs = [{"+": 1, "-": -1, None: None}[s] for _, s in items]
    columns = []
    for j, contact in enumerate(alphabet.contacts):
        if isinstance(contact, Wall):
            columns.append([FREE] * len(items))
        elif j in absent:
            if any(letter.contact == j for letter in letters):
                raise WordError(
                    f"word {text!r}: friction {contact.name!r} is zero here, so its turns, sticks and slips are no events"
                )
            columns.append([ABSENT] * len(items))
        elif isinstance(contact, Switch):
            columns.append(_switched(j, contact, letters, fixed or {}, default, text))
        else:
            columns.append(_frictional(j, contact, letters, signs, alphabet, fixed or {}, default, text))
    return tuple(zip(*columns))


def _switched(j, contact, letters, fixed, default, text) -> list[int]:
    n = len(letters)
    own = [i for i in range(n) if letters[i].contact == j]
    if not own:
        given = next((mode[j] for mode in fixed.values()), None)
        return [given if given is not None else (default[j] if default is not None else 1)] * n
    column = [0] * n
    for a, i in enumerate(own):
        if (letters[i].sign == letters[own[a - 1]].sign and len(own) > 1) or len(own) == 1:
            raise WordError(
                f"word {text!r}: the crossings of switch {contact.name!r} must alternate, "
                f"{contact.letters[0]} and {contact.letters[1]}"
            )
        for k in range(n):
            place = (i + k) % n
            if k and place in own:
                break
            column[place] = letters[i].sign
    return column


def _frictional(j, contact, letters, signs, alphabet, fixed, default, text) -> list[int]:
    n = len(letters)
    t, s, u = contact.letters
    after: list[int | None] = [fixed[i][j] if i in fixed else None for i in range(n)]
    before: list[int | None] = [None] * n
    for i, letter in enumerate(letters):
        if letter.contact == j:
            if letter.kind == STICK:
                after[i] = STUCK
            elif letter.kind == SLIP:
                before[i] = STUCK
                after[i] = after[i] if signs[i] is None else signs[i]
        elif letter.kind == HIT and alphabet.flips.get((letter.contact, j)) is not None:
            sign = alphabet.flips[letter.contact, j]
            after[i] = sign if after[i] is None else after[i]
            before[i] = -sign  # type: ignore[operator]

    def spread() -> None:
        for _ in range(2 * n + 2):
            changed = False
            for i, letter in enumerate(letters):
                here = (i - 1) % n
                for a, b in ((after, here), (before, i)):
                    other = before[i] if a is after else after[here]
                    if a[b] is None and other is not None:
                        a[b], changed = other, True
                if letter.contact == j and letter.kind == TURN:
                    if after[i] is None and before[i] is not None:
                        after[i], changed = -before[i], True  # type: ignore[operator]
                    if before[i] is None and after[i] is not None:
                        before[i], changed = -after[i], True  # type: ignore[operator]
                elif letter.contact != j and not (
                    letter.kind == HIT and (letter.contact, j) in alphabet.flips
                ):
                    if after[i] is None and before[i] is not None:
                        after[i], changed = before[i], True
                    if before[i] is None and after[i] is not None:
                        before[i], changed = after[i], True
            if not changed:
                return

    spread()
    while None in after:
        slip = next(
            (i for i in range(n) if letters[i].contact == j and letters[i].kind == SLIP and after[i] is None),
            None,
        )
        if slip is not None:
            stick = next(
                (
                    k % n
                    for k in range(slip - 1, slip - n - 1, -1)
                    if letters[k % n].contact == j and letters[k % n].kind == STICK
                ),
                slip,
            )
            arriving = before[stick]
            after[slip] = -arriving if arriving in (-1, 1) else 1
        else:
            i = after.index(None)
            touched = letters[i].kind == HIT and (letters[i].contact, j) in alphabet.flips
            if touched and before[i] is not None:
                after[i] = before[i]
            else:
                own = any(letter.contact == j for letter in letters)
                after[i] = 1 if own or default is None else default[j]
        spread()
    for i, letter in enumerate(letters):
        mode, came, name = after[i], before[i] if before[i] is not None else after[i - 1], letter.text
        good = came == after[i - 1]
        if letter.contact == j:
            good = (
                good
                and {
                    TURN: came in (-1, 1) and mode == -came,  # type: ignore[operator]
                    STICK: came in (-1, 1) and mode == STUCK,
                    SLIP: came == STUCK and mode in (-1, 1),
                }[letter.kind]
            )
        elif letter.kind == HIT and alphabet.flips.get((letter.contact, j)) is not None:
            good = good and mode == alphabet.flips[letter.contact, j] and came == -(mode or 0)
        if not good:
            words = {-1: "sliding back", 0: "stuck", 1: "sliding on", None: "open"}
            hint = (
                f"; between two impacts on one wall there is a turn ({t}) or a stick ({s})"
                if letter.kind == HIT
                else ""
            )
            raise WordError(
                f"word {text!r} cannot be: before event {i + 1} ({name}) friction {contact.name!r} is "
                f"{words.get(after[i - 1])}, so {name} cannot come next{hint}"
            )
    return [int(mode) for mode in after]  # type: ignore[arg-type]
