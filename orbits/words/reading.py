"""Words as they are written: letters, signs where a direction does not follow, modes in brackets where the events leave them open."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from orbits.contacts.dry_friction import ABSENT, STUCK, Beat, CannotFollow, FrictionLaw
from orbits.contacts.letters import HIT, NAMES, SLIP, STICK, Letter, NotAlternating
from orbits.contacts.wall import FREE, WallLaw
from orbits.words.alphabet import Alphabet

SHOWN = 60  # letters of a word in a message
MARKS = {-1: "-", 0: "0", 1: "+", ABSENT: "f"}
DOING = {-1: "sliding back", STUCK: "stuck", 1: "sliding on", None: "open"}


class WordError(ValueError):
    """A word whose events cannot follow one another."""


def bracket(mode: Sequence[int], alphabet: Alphabet) -> str:
    """A mode as it is written after an event."""
    shown = [
        MARKS[value] if not isinstance(contact, WallLaw) else ("h" if value else "")
        for value, contact in zip(mode, alphabet.contacts)
    ]
    return f"[{''.join(shown)}]"


def read(
    text: str | Sequence[str],
    alphabet: Alphabet,
    absent: frozenset[int] = frozenset(),
) -> tuple[tuple[str, ...], tuple[Any, ...]]:
    """Events and modes of a word.

    Parameters
    ----------
    text : str or sequence of str
        Letters, with or without blanks. A stick may stand for itself and the slip after it; a slip's direction is written
        ``s+`` or ``s-`` where it does not follow; ``[+0]`` after an event gives the modes of frictions and switches in the
        order of the contacts. Of a shaken machine also the impact maps, as blank-separated pairs (``LR RL``).
    alphabet : Alphabet
    absent : set of int
        Frictions whose limit is zero.

    Raises
    ------
    WordError
        If a letter is unknown or the events cannot follow one another.
    """
    if not isinstance(text, str | Sequence):
        raise WordError(f"word = {text!r} is no word: give the events of a period as text, such as 'LR'")
    source = (text if isinstance(text, str) else " ".join(map(str, text))).replace("−", "-")
    shown = repr(source if len(source) <= SHOWN else f"{source[:40]}...")
    if alphabet.alone is not None:
        source = _from_maps(source, alphabet)
    items, alone = _items(source, alphabet, shown)
    if not items:
        if alphabet.alone is not None:
            return (), ()
        return (), (_mode_of(alone, alphabet, shown) if alone else _open(alphabet, absent),)
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
    fixed = {i: _mode_of(note, alphabet, shown) for i, note in enumerate(notes) if note}
    return tuple(text for text, _ in expanded), _modes(expanded, alphabet, absent, fixed, shown)


def _from_maps(source: str, alphabet: Alphabet) -> str:
    """Events from the maps between impacts, such as ``G_LR G_RL``, each of which starts at the wall where the one before ended."""
    tokens = [token.removeprefix("G_") for token in source.replace(",", " ").split()]
    maps = len(tokens) > 1 and all(re.fullmatch("[LR]{2}", token) for token in tokens)
    if not maps or any(one[1] != other[0] for one, other in zip(tokens, tokens[1:] + tokens[:1])):
        return " ".join(tokens)
    joint = "" if alphabet.without else "t"
    return "".join(token[0] + (joint if token[0] == token[1] else "") for token in tokens)


def _items(
    source: str, alphabet: Alphabet, shown: str
) -> tuple[list[tuple[str, str | None, str | None]], str]:
    """Letters with their signs and modes; and a mode that stands alone."""
    letters = alphabet.letters
    tokens = "|".join(map(re.escape, sorted(letters, key=len, reverse=True))) or "(?!)"
    pattern = re.compile(rf"\s*(?:({tokens})([+-]?)(\[[^\]]*\])?|(\[[^\]]*\]))\s*")
    place, items, alone = 0, [], ""
    source = source.strip()
    while place < len(source):
        match = pattern.match(source, place)
        if match is None:
            known = ", ".join(f"{text} ({NAMES[letter.kind]})" for text, letter in letters.items())
            raise WordError(
                f"word {shown} has the letter {source[place]!r}: this machine has {known or 'no events'}; the direction of a slip "
                "is written as a sign, + or -, after it or after its stick"
            )
        if match[1] is None:
            alone = match[4]
        else:
            if match[2] and letters[match[1]].kind not in (STICK, SLIP):
                raise WordError(f"word {shown}: only a stick or a slip takes a sign, not {match[1]!r}")
            items.append((match[1], match[2] or None, match[3]))
        place = match.end()
    return items, alone


def _slips_later(items: Sequence[Any], place: int, letters: Mapping[str, Letter]) -> bool:
    """Whether the next event of a stick's friction is a slip that is written out."""
    own = letters[items[place][0]].contact
    for step in range(1, len(items)):
        other = letters[items[(place + step) % len(items)][0]]
        if other.contact == own:
            return other.kind == SLIP
    return False


def _mode_of(note: str, alphabet: Alphabet, shown: str) -> tuple[int, ...]:
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
            f"word {shown}: {note} must give one of + - 0 for every friction and + or - for every switch, in their order"
        )
    return tuple(mode)


def _open(alphabet: Alphabet, absent: frozenset[int]) -> tuple[int, ...]:
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
    shown: str,
) -> tuple[Any, ...]:
    """The mode after each event; what nothing fixes becomes a reversal at a slip, else the law's usual one."""
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
                    f"word {shown}: friction {contact.name!r} is zero here, and its turns, sticks and slips are no events without "
                    "friction: write the other events only, or give friction (and gravity) values above 0"
                )
            flips = [alphabet.flips.get((letter.contact, j)) for letter in letters]
            columns.append([ABSENT if j in absent else int(sign or 0) for sign in flips])
        elif isinstance(contact, FrictionLaw):
            columns.append(_directions(j, letters, signs, alphabet, noted, shown))
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
                    f"word {shown}: the crossings of switch {contact.name!r} must alternate, "
                    f"{contact.letters[0]} and {contact.letters[1]}{between}"
                ) from None
    return tuple(columns[0]) if alphabet.alone is not None else tuple(zip(*columns))


def _directions(
    j: int,
    letters: Sequence[Letter],
    signs: Sequence[int | None],
    alphabet: Alphabet,
    noted: Mapping[int, int],
    shown: str,
) -> list[int]:
    """The mode of friction j after each event: its law says it for the events that it notices, between them it stays."""
    friction: FrictionLaw = alphabet.contacts[j]
    places = [i for i, letter in enumerate(letters) if alphabet.touches(letter, j)]
    if not places:
        return [next(iter(noted.values()), 1)] * len(letters)
    beats = [
        Beat(letters[i].kind, alphabet.flips[letters[i].contact, j] if letters[i].kind == HIT else signs[i])
        for i in places
    ]
    last = np.searchsorted(places, range(len(letters)), side="right") - 1  # -1: the last one, cyclically
    known = {int(last[i]) % len(places): mode for i, mode in noted.items()}
    try:
        modes = friction.directions(beats, known)
    except CannotFollow as error:
        place = places[error.beat]
        letter, before = letters[place], letters[places[error.beat - 1]]
        turn, stick, slip = friction.letters
        hint = ""
        if letter.kind == SLIP:
            hint = f"; a slip that follows no stick is none: write {stick} for a stick and its slip"
        elif letter.kind == HIT and letter.contact == before.contact:
            hint = f"; between two impacts on one wall there is a turn ({letter.text}{turn}{letter.text}) or a stick ({letter.text}{stick}{letter.text})"
        raise WordError(
            f"word {shown} cannot be: after {before.text} friction {friction.name!r} is {DOING[error.came]}, "
            f"so event {place + 1}, {letter.text} ({NAMES[letter.kind]}), cannot come next{hint}"
        ) from None
    return [modes[k] for k in last]
