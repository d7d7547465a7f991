"""Words: periodic motions as cyclic lists of events.

A periodic orbit P_l^k is a cyclic list of events, l of them impacts, over k forcing periods. That list is its word.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from heapq import heappop, heappush
from typing import Any

import numpy as np

from orbits.words.alphabet import CODES, IMPACTS, MIRRORED, NAMES


class WordError(ValueError):
    """A word whose events cannot follow one another."""


@dataclass(frozen=True)
class Word:
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
    def __len__(self) -> int:
        return len(self.events)

    def __str__(self) -> str:
        return self.text

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

    @property
    def impacts(self) -> int:
        """Number of impacts l."""
        return sum(letter in IMPACTS for letter in self.events)

    @property
    def impact_free(self) -> bool:
        """Whether no wall is hit: the mean position of such a motion is free."""
        return self.impacts == 0

    @cached_property
    def codes(self) -> np.ndarray:
        """Event codes, shape (n,), int8."""
        return np.array([CODES[letter] for letter in self.events], dtype=np.int8)

    @cached_property
    def mode_codes(self) -> np.ndarray:
        """Mode after each event, shape (n,), int8."""
        return np.array(self.modes, dtype=np.int8)

    # ------------------------------------------------------------------ transformations
    def rotate(self, places: int) -> Word:
        """The same cycle read from the event `places` further on."""
        if not self.events:
            return self
        k = places % len(self.events)
        return Word(self.events[k:] + self.events[:k], self.modes[k:] + self.modes[:k], self.frictionless)

    def mirror(self) -> Word:
        """The word of the mirror image: L and R, and the sliding directions, change places."""
        return Word(
            tuple(MIRRORED[letter] for letter in self.events),
            tuple(-mode for mode in self.modes),
            self.frictionless,
        )

    def repeat(self, times: int) -> Word:
        """The word written `times` times."""
        if times < 1:
            raise WordError(f"times = {times}: a word can be repeated 1, 2, ... times")
        return Word(self.events * times, self.modes * times, self.frictionless)

    def double(self) -> Word:
        """The word written twice, as after a period doubling."""
        return self.repeat(2)

    def head(self, length: int) -> Word:
        """The first `length` events; not a cycle of its own, but the half of a symmetric one."""
        return Word(self.events[:length], self.modes[:length], self.frictionless)

    @property
    def repetitions(self) -> int:
        """How often the primitive root is written in this word."""
        n = len(self.events)
        for length in range(1, n):
            if n % length == 0 and self.rotate(length) == self:
                return n // length
        return 1

    def primitive_root(self) -> Word:
        """The shortest word of which this one is a repetition."""
        return self.head(len(self.events) // self.repetitions)

    def canonical(self, mirror: bool = True) -> Word:
        """The smallest of all rotations of the word, and of its mirror image if that is a motion of the machine, too."""
        if not self.events:
            return self
        images = (self, self.mirror()) if mirror else (self,)
        return min((w._smallest_rotation() for w in images), key=lambda w: (w.events, w.modes))

    def _smallest_rotation(self) -> Word:
        """The smallest rotation by its events, of those with equal events by its modes; no slip begins a word."""
        place, root = least_rotation(self.events), len(self.events) // _power(self.events)
        modes = self.modes[place:] + self.modes[:place]
        blocks = [modes[i : i + root] for i in range(0, len(modes), root)]
        return self.rotate(place + root * least_rotation(blocks))

    def spelled(self, mirror: bool = True) -> str:
        """The word as people are told it: one spelling for one motion, from whichever event and in whichever mirror image.

        That of `canonical`, without signs where the letters alone mean this motion.
        """
        canonical = self.canonical(mirror)
        plain = canonical._written(signed=False)
        with suppress(WordError):
            if Word.parse(plain, self.frictionless).canonical(mirror) == canonical:
                return plain
        return canonical.text

    @property
    def mirror_symmetric_halves(self) -> bool:
        """Whether the second half is the mirror image of the first: the word a symmetric orbit can have."""
        n = len(self.events)
        return n > 0 and n % 2 == 0 and self.rotate(n // 2) == self.mirror()


def least_rotation(items: Sequence[Any]) -> int:
    """Where the smallest rotation of a cyclic sequence begins; the first such place. Two pointers, linear time."""
    n, i, j, k = len(items), 0, 1, 0
    while i < n and j < n and k < n:
        a, b = items[(i + k) % n], items[(j + k) % n]
        if a == b:
            k += 1
            continue
        if a > b:
            i += k + 1
        else:
            j += k + 1
        j += i == j
        k = 0
    return min(i, j)


def _power(items: Sequence[Any]) -> int:
    """How often the shortest root is written in a sequence."""
    n = len(items)
    return next(n // r for r in range(1, n + 1) if n % r == 0 and items[r:] == items[: n - r])


def _are_chained_maps(tokens: Sequence[str]) -> bool:
    if not all(re.fullmatch("[LR]{2}", token) for token in tokens):
        return False
    return all(tokens[i][1] == tokens[(i + 1) % len(tokens)][0] for i in range(len(tokens)))


def _modes(
    events: Sequence[str], signs: Sequence[int | None], frictionless: bool, shown: str
) -> tuple[int, ...]:
    """The mode after each event; None where nothing fixes it becomes a reversal of the motion before the stick."""
    n = len(events)
    if n == 0:
        return ()
    after: list[int | None] = [{"L": -1, "R": 1, "s": 0}.get(letter) for letter in events]
    if frictionless:
        return tuple(int(mode or 0) for mode in after)
    for place, letter in enumerate(events):
        if letter == "u":
            after[place] = signs[place]
    for place in range(n):  # known modes go on over turns; before an impact the motion is towards its wall
        letter, before = events[place], (place - 1) % n
        if letter == "t":
            if after[place] is None and after[before] is not None:
                after[place] = -after[before]  # type: ignore[operator]
            if after[before] is None and after[place] is not None:
                after[before] = -after[place]  # type: ignore[operator]
        elif letter in IMPACTS and after[before] is None:
            after[before] = 1 if letter == "L" else -1
    _settle(events, after)
    if all(mode is None for mode in after):  # only turns: the first flight goes to the left
        after = [-1 if place % 2 else 1 for place in range(n)]
    modes = tuple(int(mode) for mode in after if mode is not None)
    if len(modes) != n:
        raise WordError(f"word {shown!r} leaves the direction of a slip open: write s+ or s-")
    _refuse_impossible(events, modes, shown)
    return modes


def _settle(events: Sequence[str], after: list[int | None]) -> None:
    """Let known modes go on over turns, and give slips that nothing fixes a direction, the first one first.

    It is against the motion that the stick before it ended, where that is known. Each mode is set once: linear time.
    """
    n = len(events)
    ready: list[int] = []  # slips that nothing fixes yet, behind a stick that ended a known motion
    known = [place for place in range(n) if after[place] is not None]

    def spread() -> None:
        while known:
            place = known.pop()
            mode, following, before = after[place], (place + 1) % n, (place - 1) % n
            assert mode is not None
            for neighbour, joined in ((following, events[following]), (before, events[place])):
                if joined == "t" and after[neighbour] is None:
                    after[neighbour] = -mode
                    known.append(neighbour)
            slip = (place + 2) % n
            if mode and events[slip] == "u" and after[slip] is None:
                heappush(ready, slip)

    spread()
    for place in range(n):
        while ready:
            slip = heappop(ready)
            if after[slip] is None:
                after[slip] = -after[(slip - 2) % n]  # type: ignore[operator]
                known.append(slip)
                spread()
        if events[place] == "u" and after[place] is None:
            after[place] = 1
            known.append(place)
            spread()


def _refuse_impossible(events: Sequence[str], modes: Sequence[int], shown: str) -> None:
    n = len(events)
    for place in range(n):
        following = (place + 1) % n
        mode, event = modes[place], events[following]
        possible = {-1: "Rts", 1: "Lts", 0: "u"}[mode]
        if event not in possible or (event == "t" and modes[following] != -mode):
            here, there = NAMES[events[place]], NAMES[event]
            hint = ""
            if events[place] == event and event in IMPACTS:
                hint = f"; between two impacts on one wall there is a turn ({event}t{event}) or a stick ({event}s{event})"
            heading = {-1: "moving to the right", 1: "moving to the left", 0: "stuck"}[mode]
            raise WordError(
                f"word {shown!r} cannot be: after the {here} ({events[place]}) the absorber is {heading}, "
                f"so {'a turn that leads to the next event' if event == 't' else 'the ' + there} ({event}) "
                f"cannot come next{hint}"
            )
