"""Words of the machines with a shaken cavity: periodic motions as cyclic lists of events.

A periodic orbit P_l^k is a cyclic list of events, l of them impacts, over k forcing periods. That list is its word.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any

import numpy as np

from orbits.contacts.dry_friction import STUCK, Beat, CannotFollow
from orbits.contacts.letters import HIT, SLIP, STICK, TURN
from orbits.words.alphabet import CODES, FLOOR, FRICTIONLESS, LEFT, SHAKEN, Alphabet
from orbits.words.cyclic import CyclicWord, WordError


@dataclass(frozen=True)
class Word(CyclicWord):
    """A cyclic list of events with the mode that follows each of them.

    Build one with `Word.parse`; the constructor trusts its arguments.

    Attributes
    ----------
    events : tuple of str
        Letters ``L R t s u``, one per event; every ``s`` is followed by its ``u``.
    modes : tuple of int
        The mode (-1, 0 or +1) of the segment that follows each event.
    frictionless : bool
        True for words of the machine without friction, where flights may reverse freely and only impacts are events.
    """

    events: tuple[str, ...]
    modes: tuple[int, ...]
    frictionless: bool = False

    @property
    def alphabet(self) -> Alphabet:
        """Two walls and the cavity's floor."""
        return FRICTIONLESS if self.frictionless else SHAKEN

    def like(self, events: Sequence[str], modes: Sequence[int]) -> Word:
        """A word of the same machine."""
        return _word(tuple(events), tuple(modes), self.frictionless)

    # ------------------------------------------------------------------ making
    @classmethod
    def parse(cls, text: str | Sequence[str] | Word, frictionless: bool = False) -> Word:
        """Read a word from events (``"LR"``, ``"RLtL"``, ``"ss"``) or from the impact maps (``"LR RL"``).

        Parameters
        ----------
        text : str, sequence of str or Word
            Events, with or without blanks; or the maps G_LR, G_RL, G_LL, G_RR as blank-separated pairs, each starting
            at the wall where the one before ended. ``s`` stands for ``s`` and the slip ``u`` after it; where the
            direction of a slip does not follow from the next impact or turn, write ``s+`` or ``s-``.
        frictionless : bool
            Read the word for a machine without friction: ``LL`` needs no turn then.

        Raises
        ------
        WordError
            If the letters are unknown or the events cannot follow one another.
        """
        if isinstance(text, Word):
            if text.frictionless == frictionless:
                return text
            text = text.text
        if not isinstance(text, str | Sequence):
            raise WordError(f"word = {text!r} is no word: give the events of a period as text, such as 'LR'")
        tokens = text.replace(",", " ").split() if isinstance(text, str) else [str(part) for part in text]
        tokens = [token.removeprefix("G_") for token in tokens]
        if len(tokens) > 1 and _are_chained_maps(tokens):
            joint = "" if frictionless else "t"
            letters = [token[0] + (joint if token[0] == token[1] else "") for token in tokens]
            return cls._from_letters("".join(letters), frictionless, text)
        return cls._from_letters("".join(tokens), frictionless, text)

    @classmethod
    def _from_letters(cls, joined: str, frictionless: bool, text: object) -> Word:
        shown = text if isinstance(text, str) else " ".join(text)  # type: ignore[arg-type]
        shown = shown if len(shown) <= 60 else f"{shown[:40]}..."
        joined = joined.replace("−", "-")
        if not re.fullmatch(r"(?:[LRt]|[su][+-]?)*", joined):
            bad = re.sub(r"[LRt]|[su][+-]?", "", joined)[:1]
            raise WordError(
                f"word {shown!r} has the letter {bad!r}: events are L and R (impacts), t (turn), s (stick, with its "
                "slip) and u (slip), a slip's direction is written s+ or s-"
            )
        if frictionless and re.search(r"[tsu]", joined):
            raise WordError(
                f"word {shown!r} has turns, sticks or slips, which are no events without friction: "
                "write impacts only, or give friction and gravity values above 0"
            )
        events: list[str] = []
        signs: list[int | None] = []
        items = re.findall(r"[LRtsu][+-]?", joined)
        for place, item in enumerate(items):
            letter, sign = item[0], {"+": 1, "-": -1}.get(item[1:])
            follower = items[(place + 1) % len(items)][0]
            if letter == "s" and follower != "u":
                events += ["s", "u"]
                signs += [None, sign]
            else:
                events.append(letter)
                signs.append(sign)
        for place, letter in enumerate(events):
            before = events[place - 1]
            if (letter == "u") != (before == "s"):
                raise WordError(
                    f"word {shown!r} has a slip that follows no stick: write s for a stick and its slip"
                )
        return cls(tuple(events), _modes(events, signs, frictionless, shown), frictionless)

    # ------------------------------------------------------------------ facts
    @cached_property
    def text(self) -> str:
        """The word as it is written in studies: sticks carry a sign only where it is needed."""
        plain = self._written(signed=False)
        try:
            if Word.parse(plain, self.frictionless).modes == self.modes:
                return plain
        except WordError:
            pass
        return self._written(signed=True)

    def _written(self, signed: bool) -> str:
        parts = []
        n = len(self.events)
        for place, letter in enumerate(self.events):
            if letter == "s" and place + 1 < n:
                mark = "+" if self.modes[(place + 1) % n] > 0 else "-"
                parts.append("s" + (mark if signed else ""))
            elif letter == "u" and place > 0:
                continue
            elif letter == "u":
                parts.append("u" + (("+" if self.modes[place] > 0 else "-") if signed else ""))
            else:
                parts.append(letter)
        return "".join(parts)

    def describe(self) -> dict[str, Any]:
        """Events and modes, ready for JSON."""
        return {
            "events": "".join(self.events),
            "modes": list(self.modes),
            "frictionless": self.frictionless,
        }

    def spelled(self, mirror: bool = True) -> str:
        """The word as people are told it: one spelling for one motion, from whichever event and in whichever mirror image.

        That of `canonical`, without signs where the letters alone mean this motion.
        """
        return _spelled(self.canonical(mirror), mirror)

    @cached_property
    def codes(self) -> np.ndarray:
        """Event codes, shape (n,), int8."""
        return np.array([CODES[letter] for letter in self.events], dtype=np.int8)

    @cached_property
    def mode_codes(self) -> np.ndarray:
        """Mode after each event, shape (n,), int8."""
        return np.array(self.modes, dtype=np.int8)


@lru_cache(maxsize=4096)
def _word(events: tuple[str, ...], modes: tuple[int, ...], frictionless: bool) -> Word:
    """A word, the same one every time: what is worked out of it is kept."""
    return Word(events, modes, frictionless)


@lru_cache(maxsize=1024)
def _spelled(canonical: Word, mirror: bool) -> str:
    plain = canonical._written(signed=False)
    with suppress(WordError):
        if Word.parse(plain, canonical.frictionless).canonical(mirror) == canonical:
            return plain
    return canonical.text


def _are_chained_maps(tokens: Sequence[str]) -> bool:
    if not all(re.fullmatch("[LR]{2}", token) for token in tokens):
        return False
    return all(tokens[i][1] == tokens[(i + 1) % len(tokens)][0] for i in range(len(tokens)))


def _modes(
    events: Sequence[str], signs: Sequence[int | None], frictionless: bool, shown: str
) -> tuple[int, ...]:
    """The mode after each event: the direction of sliding on the floor."""
    letters = [SHAKEN.letters[text] for text in events]
    flips = SHAKEN.flips
    after = [flips[letter.contact, FLOOR] if letter.kind == HIT else None for letter in letters]
    if frictionless:
        return tuple(int(mode or 0) for mode in after)
    beats = [
        Beat(letter.kind, sign if letter.kind == SLIP else mode)
        for letter, sign, mode in zip(letters, signs, after)
    ]
    try:
        return tuple(SHAKEN.contacts[FLOOR].directions(beats))
    except CannotFollow as error:
        raise WordError(_impossible(events, beats, error, shown)) from None


WORDS = {TURN: "turn", STICK: "stick", SLIP: "slip"}


def _impossible(events: Sequence[str], beats: Sequence[Beat], error: CannotFollow, shown: str) -> str:
    place = error.beat
    before, event = events[place - 1], events[place]
    hint = ""
    if before == event and beats[place].kind == HIT:
        hint = f"; between two impacts on one wall there is a turn ({event}t{event}) or a stick ({event}s{event})"
    heading = {-1: "moving to the right", 1: "moving to the left", STUCK: "stuck"}[error.came or 0]
    called = "a turn that leads to the next event" if event == "t" else f"the {_called(event)}"
    return (
        f"word {shown!r} cannot be: after the {_called(before)} ({before}) the absorber is {heading}, "
        f"so {called} ({event}) cannot come next{hint}"
    )


def _called(text: str) -> str:
    letter = SHAKEN.letters[text]
    if letter.kind == HIT:
        return f"impact on the {'left' if letter.contact == LEFT else 'right'} wall"
    return WORDS[letter.kind]
