"""Words of declared machines: any set of contacts, modes in brackets where the events leave them open."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from orbits.contacts.dry_friction import ABSENT, STUCK, Beat, CannotFollow, FrictionLaw
from orbits.contacts.letters import HIT, SLIP, STICK, TURN, Letter
from orbits.contacts.switch import NotAlternating, SwitchLaw
from orbits.contacts.wall import FREE, WallLaw
from orbits.words.alphabet import Alphabet
from orbits.words.cyclic import CyclicWord, WordError


@dataclass(frozen=True)
class PageWord(CyclicWord):
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

    def like(self, events: Sequence[str], modes: Sequence[tuple[int, ...]]) -> PageWord:
        """A word of the same machine."""
        return PageWord(tuple(events), tuple(modes), self.alphabet)

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


def _bracket(mode: Sequence[int], alphabet: Alphabet) -> str:
    marks = {-1: "-", 0: "0", 1: "+", 2: "f"}
    shown = [
        marks[value] if not isinstance(contact, WallLaw) else ("h" if value else "")
        for value, contact in zip(mode, alphabet.contacts)
    ]
    return f"[{''.join(shown)}]"


def _absent(mode: Sequence[int]) -> frozenset[int]:
    return frozenset(j for j, value in enumerate(mode) if value == ABSENT)


# ---------------------------------------------------------------------- reading
def parse(
    text: str, alphabet: Alphabet, absent: frozenset[int] = frozenset(), default: Sequence[int] | None = None
) -> PageWord:
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
    if not isinstance(text, str):
        raise WordError(f"word = {text!r} is no word: give the events of a period as text")
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
        return PageWord((), (mode,), alphabet)
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
    return PageWord(tuple(t for t, _ in expanded), modes, alphabet)


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
        if isinstance(contact, WallLaw):
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
        if isinstance(contact, WallLaw):
            mode.append(FREE)
        elif j in absent:
            mode.append(ABSENT)
        elif default is not None:
            mode.append(default[j])
        else:
            mode.append(STUCK if isinstance(contact, FrictionLaw) else 1)
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
        noted = {i: mode[j] for i, mode in (fixed or {}).items()}
        usual = 1 if default is None else default[j]
        if isinstance(contact, WallLaw):
            columns.append([FREE] * len(items))
        elif j in absent:
            if any(letter.contact == j for letter in letters):
                raise WordError(
                    f"word {text!r}: friction {contact.name!r} is zero here, so its turns, sticks and slips are no events"
                )
            columns.append([ABSENT] * len(items))
        elif isinstance(contact, SwitchLaw):
            hits = {
                i: alphabet.flips[letter.contact, j]
                for i, letter in enumerate(letters)
                if (letter.contact, j) in alphabet.flips
            }
            try:
                columns.append(contact.signs(letters, j, noted, usual, hits))
            except NotAlternating:
                between = "; impacts may change its sign between them" if hits else ""
                raise WordError(
                    f"word {text!r}: the crossings of switch {contact.name!r} must alternate, "
                    f"{contact.letters[0]} and {contact.letters[1]}{between}"
                ) from None
        else:
            columns.append(_directions(j, letters, signs, alphabet, noted, usual, text))
    return tuple(zip(*columns))


def _directions(
    j: int,
    letters: Sequence[Letter],
    signs: Sequence[int | None],
    alphabet: Alphabet,
    noted: Mapping[int, int],
    usual: int,
    text: str,
) -> list[int]:
    """The mode of friction j after each event: its law says it for the events that it notices, between them it stays."""
    friction: FrictionLaw = alphabet.contacts[j]
    places = [i for i, letter in enumerate(letters) if alphabet.touches(letter, j)]
    if not places:
        return [next(iter(noted.values()), usual)] * len(letters)
    own = any(letters[i].contact == j for i in places)
    beats = [
        Beat(letters[i].kind, alphabet.flips[letters[i].contact, j] if letters[i].kind == HIT else signs[i])
        for i in places
    ]
    last = [
        sum(place <= i for place in places) - 1 for i in range(len(letters))
    ]  # -1: the last one, cyclically
    known = {last[i] % len(places): mode for i, mode in noted.items()}
    try:
        modes = friction.directions(beats, known, 1 if own else usual)
    except CannotFollow as error:
        place = places[error.beat]
        doing = {-1: "sliding back", 0: "stuck", 1: "sliding on"}.get(error.came, "open")  # type: ignore[arg-type]
        turn, stick, _ = friction.letters
        hint = (
            f"; between two impacts on one wall there is a turn ({turn}) or a stick ({stick})"
            if letters[place].kind == HIT
            else ""
        )
        name = letters[place].text
        raise WordError(
            f"word {text!r} cannot be: before event {place + 1} ({name}) friction {friction.name!r} is {doing}, "
            f"so {name} cannot come next{hint}"
        ) from None
    return [modes[k] for k in last]
