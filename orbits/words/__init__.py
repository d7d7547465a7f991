"""Words: cyclic lists of events of periodic motions, over the alphabet of any machine, and the names of their margins.

A periodic orbit P_l^k has a cyclic list of events, l of them impacts, over k forcing periods. This list is its word. Each
event and the flight after it have margins (listed in `Alphabet.watched`): the orbit is real if all are positive, and a border is a point where one
vanishes. Flows compute the values of margins; this module names them by the laws of the contacts.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from orbits.arguments import UNBOUNDED
from orbits.contacts import BORDERS, HIT, SLIP, STICK, STRENGTH, STROBE, TURN, Letter
from orbits.words.alphabet import SHAKEN, Alphabet, Watch, WordError, bracket, read, shaken

if TYPE_CHECKING:
    from orbits.contacts import Mode


def least_rotation(items: Sequence[Any]) -> int:
    """Smallest index at which the smallest rotation of a cyclic sequence begins; linear time."""
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


def power(items: Sequence[Any]) -> int:
    """Number of repetitions of its shortest root of which a sequence consists."""
    n = len(items)
    return next(n // r for r in range(1, n + 1) if n % r == 0 and items[r:] == items[: n - r])


@dataclass(frozen=True)
class Word:
    """A cyclic list of events with the mode after each of them.

    Make one with `Word.parse` or with the method `word` of a machine; the constructor does not check its arguments.

    Attributes
    ----------
    events : tuple of str
        Letters of the alphabet; for the shaken machines ``L R t s u``, where every ``s`` is followed by its ``u``.
    modes : tuple
        State of the contacts (holding, sliding direction, sticking) after each event: an int for the shaken machines (-1, 0 or +1), a tuple
        with one entry per contact for others. A word without events may have one mode.
    alphabet : Alphabet
    """

    events: tuple[str, ...]
    modes: tuple[Mode, ...]
    alphabet: Alphabet = field(default=SHAKEN, compare=False, repr=False)

    # ------------------------------------------------------------------ making
    @classmethod
    def parse(cls, text: str | Sequence[str] | Word, frictionless: bool = False) -> Word:
        """Read a word of the machines with a shaken cavity; see `orbits.words.alphabet.read`.

        Parameters
        ----------
        text : str, sequence of str or Word
            Events, with or without blanks (``"LR"``, ``"RLtL"``, ``"ss"``), or the impact maps G_LR, G_RL, G_LL, G_RR as
            blank-separated pairs (``"LR RL"``), each starting at the wall where the one before ended.
        frictionless : bool
            Read the word for a machine without friction, in which ``LL`` needs no turn.

        Raises
        ------
        WordError
            If the letters are unknown or the events cannot follow one another.
        """
        return cls.over(shaken(frictionless), text)

    @classmethod
    def over(
        cls,
        alphabet: Alphabet,
        text: str | Sequence[str] | Word,
        absent: frozenset[int] = frozenset(),
    ) -> Word:
        """Read a word over any alphabet; `absent` are frictions whose limit is zero. See `orbits.words.alphabet.read`."""
        if isinstance(text, Word):
            if alphabet.alone is None or text.alphabet.without == alphabet.without:
                return text
            text = text.text
        return cls(*read(text, alphabet, absent), alphabet)

    @classmethod
    def described(cls, data: Mapping[str, Any], alphabet: Alphabet | None = None) -> Word:
        """Return the word with this description (result of `describe`); default alphabet: that of the shaken machines."""
        modes = tuple(tuple(mode) if isinstance(mode, list) else mode for mode in data.get("modes", ()))
        # files of version 0.1 have no entry "events" for the absorber at rest
        return cls(tuple(data.get("events", "")), modes, alphabet or shaken(bool(data.get("frictionless"))))

    def like(self, events: Sequence[str], modes: Sequence[Mode]) -> Word:
        """Return a word with other events and modes over the same alphabet."""
        return _word(tuple(events), tuple(modes), self.alphabet)

    # ------------------------------------------------------------------ facts
    def __len__(self) -> int:
        return len(self.events)

    def __str__(self) -> str:
        return self.text

    @cached_property
    def text(self) -> str:
        """The word as written in studies; signs and modes (in brackets) are written only if the events do not determine them."""
        if not self.modes:
            return ""
        turns = bool(self.events) and all(self.letter(i).kind == TURN for i in range(len(self)))
        alphabet = self.alphabet
        for signed, noted in ((False, ()), (True, ())) if alphabet.alone is not None else (
            (False, ()), (True, ()), (True, (0,)),
        ):  # fmt: skip
            text = self._written(signed, noted)
            with suppress(WordError):
                reread = self.over(alphabet, text, alphabet.absent_in(self.modes[0]))
                places = range(len(self)) if turns and reread.events == self.events else (0,)
                if any(reread.rotate(k) == self for k in places):
                    return text  # the same cycle; with turns alone the reading may begin at a different event
        return (
            self._written(True)
            if alphabet.alone is not None
            else self._written(False, range(len(self.modes)))
        )

    def _written(self, signed: bool, noted: Sequence[int] = ()) -> str:
        """Write the word, with signs of slips if `signed` and with modes after the events `noted`."""
        if not self.events:
            return bracket(self.entries(0), self.alphabet) if noted else ""
        parts: list[str] = []
        n = len(self.events)
        joined = len(noted) < n
        for i, text in enumerate(self.events):
            letter, before, following = self.letter(i), self.letter(i - 1), self.letter(i + 1)
            own = letter.contact
            if joined and letter.kind == SLIP and i > 0 and before.kind == STICK and before.contact == own:
                continue
            mark = ""
            if signed and letter.kind == SLIP:
                mark = "+" if self.alphabet.entry(self.modes[i], own) > 0 else "-"
            elif signed and joined and letter.kind == STICK and following.kind == SLIP and i + 1 < n:
                mark = "+" if self.alphabet.entry(self.modes[i + 1], own) > 0 else "-"
            parts.append(text + mark + (bracket(self.entries(i), self.alphabet) if i in noted else ""))
        joint = " " if any(len(text) > 1 for text in self.events) else ""
        return joint.join(parts)

    def spelled(self, mirror: bool = True) -> str:
        """Return the word as printed.

        For the shaken machines all rotations of a word and (if `mirror`) its mirror image have one spelling: that of `canonical`, without signs
        if the letters determine the motion. Words of declared machines are printed as they are.
        """
        if self.alphabet.alone is None:
            return self.text
        return _spelled(self.canonical(mirror), mirror, self.alphabet)

    def describe(self) -> dict[str, Any]:
        """Return events and modes as a dict for JSON."""
        if self.alphabet.alone is None:
            return {"events": list(self.events), "modes": [list(mode) for mode in self.contact_modes]}
        return {
            "events": "".join(self.events),
            "modes": list(self.modes),
            "frictionless": self.frictionless,
        }

    @property
    def frictionless(self) -> bool:
        """Whether the machine is a shaken one without friction, so that only impacts are events."""
        return bool(self.alphabet.without)

    @cached_property
    def codes(self) -> np.ndarray:
        """Codes of the events' letters, shape (n,), int8."""
        return np.array([self.alphabet.codes[letter] for letter in self.events], dtype=np.int8)

    @cached_property
    def mode_codes(self) -> np.ndarray:
        """Mode after each event, shape (n,) or (n, contacts), int8."""
        return np.array(self.modes, dtype=np.int8)

    @cached_property
    def impact_free(self) -> bool:
        """Whether the word has no impacts."""
        return self.impacts == 0

    def letter(self, place: int) -> Letter:
        """Return the letter of an event; indices are cyclic."""
        return self.alphabet.letters[self.events[place % len(self.events)]]

    def mode(self, place: int) -> Mode:
        """Return the mode after an event; indices are cyclic."""
        return self.modes[place % len(self.modes)]

    def entries(self, place: int) -> tuple[int, ...]:
        """Return the entries of all contacts in the mode after an event."""
        return self.alphabet.entries(self.mode(place))

    @property
    def contact_modes(self) -> tuple[tuple[int, ...], ...]:
        """Entries of all contacts in the mode after each event."""
        return tuple(map(self.alphabet.entries, self.modes))

    @cached_property
    def impacts(self) -> int:
        """Number of impacts l."""
        letters = self.alphabet.letters
        return sum(letters[text].kind == HIT for text in self.events)

    # ------------------------------------------------------------------ transformations
    def rotate(self, places: int) -> Word:
        """Return the same cycle, beginning `places` events later."""
        if not self.events:
            return self
        k = places % len(self.events)
        return self.like(self.events[k:] + self.events[:k], self.modes[k:] + self.modes[:k])

    def mirror(self) -> Word:
        """Return the word of the mirror image."""
        return self._image

    @cached_property
    def _image(self) -> Word:
        images, mirrored = self.alphabet.images, self.alphabet.mirrored_mode
        return self.like([images[text] for text in self.events], [mirrored(mode) for mode in self.modes])

    def repeat(self, times: int) -> Word:
        """Return the word repeated `times` times."""
        if times < 1:
            raise WordError(f"times = {times}: a word can be repeated 1, 2, ... times")
        return self.like(self.events * times, self.modes * times if self.events else self.modes)

    def double(self) -> Word:
        """Return the word repeated twice, as after a period doubling."""
        return self.repeat(2)

    def head(self, length: int) -> Word:
        """Return the first `length` events; in general not a cycle, for example half of a symmetric one."""
        return self.like(self.events[:length], self.modes[:length] if self.events else self.modes)

    def with_image(self) -> Word:
        """Return the word followed by its mirror image, which completes half of a symmetric cycle."""
        if not self.events:
            return self
        image = self.mirror()
        return self.like(self.events + image.events, self.modes + image.modes)

    @cached_property
    def repetitions(self) -> int:
        """Number of repetitions of the primitive root in this word."""
        return power(list(zip(self.events, self.modes))) if self.events else 1

    def primitive_root(self) -> Word:
        """Return the shortest word of which this one is a repetition."""
        return self.head(len(self.events) // self.repetitions)

    def canonical(self, mirror: bool = True) -> Word:
        """Return the smallest of all rotations of the word and, if `mirror` and the machine has a mirror image, of its mirror image."""
        if not self.events and not self.modes:
            return self
        alphabet = self.alphabet
        return _canonical(self, mirror and alphabet.mirror is not None, alphabet)

    def _smallest_rotation(self) -> Word:
        """Return the smallest rotation by events, and among equal events by modes. (No slip is first, since its stick is smaller.)"""
        if not self.events:
            return self
        place, root = least_rotation(self.events), len(self.events) // power(self.events)
        modes = self.modes[place:] + self.modes[:place]
        blocks = [modes[i : i + root] for i in range(0, len(modes), root)]
        return self.rotate(place + root * least_rotation(blocks))

    def readings(self, mirror: bool = True) -> list[tuple[bool, int]]:
        """Return all pairs (mirrored, rotation) that transform this word to its canonical form."""
        alphabet = self.alphabet
        return _readings(self, mirror and alphabet.mirror is not None, alphabet)

    @cached_property
    def mirror_symmetric_halves(self) -> bool:
        """Whether the second half is the mirror image of the first, which a symmetric orbit requires."""
        if self.alphabet.mirror is None:
            return False
        n = len(self.events)
        if n == 0:
            return bool(self.modes) and self.mirror() == self
        return n % 2 == 0 and self.rotate(n // 2) == self.mirror()


@lru_cache(maxsize=4096)
def _word(events: tuple[str, ...], modes: tuple[Mode, ...], alphabet: Alphabet) -> Word:
    """Return a cached word, so that its cached properties are computed once."""
    return Word(events, modes, alphabet)


@lru_cache(maxsize=1024)
def _spelled(canonical: Word, mirror: bool, alphabet: Alphabet) -> str:
    plain = canonical._written(signed=False)
    with suppress(WordError):
        if Word.over(alphabet, plain).canonical(mirror) == canonical:
            return plain
    return canonical.text


@lru_cache(maxsize=1024)
def _canonical(word: Word, mirror: bool, alphabet: Alphabet) -> Word:
    images = (word, word.mirror()) if mirror else (word,)
    return min((w._smallest_rotation() for w in images), key=lambda w: (w.events, w.modes))


@lru_cache(maxsize=256)
def _readings(word: Word, mirror: bool, alphabet: Alphabet) -> list[tuple[bool, int]]:
    target = word.canonical(mirror)
    images = [(word, False), (word.mirror(), True)] if mirror else [(word, False)]
    return [
        (mirrored, k)
        for reading, mirrored in images
        for k in range(max(1, len(word)))
        if reading.rotate(k) == target
    ]


@dataclass(frozen=True)
class Margin:
    """One margin of an orbit.

    Attributes
    ----------
    kind : str
        Quantity that must be positive: ``flight`` (smallest relative speed inside the flight), ``wall`` (smallest distance from the walls),
        ``approach`` (impact speed), ``turn`` (excess of the force over friction), ``stick`` (reserve of friction when sticking begins),
        ``slip`` (rate at which the force exceeds friction), ``hold`` (time to the slip, or reserve of friction until then), ``push`` (force of a
        wall that holds), ``switch`` (distance from its surface inside a flight, or rate at a crossing) or ``duration`` (of the flight).
    segment : int
        Index of the event to which the margin belongs; a flight belongs to the event before it.
    value : float
        Positive on a real orbit.
    """

    kind: str
    segment: int
    value: float


def place_of(word: Word, index: int) -> tuple[int, int]:
    """Return the event to which margin `index` belongs (0 without events), and the index of its contact or one of `Watch`."""
    place, column = divmod(index, len(word.alphabet.columns))
    return place if len(word) else 0, word.alphabet.columns[column]


def margin_name(word: Word, index: int) -> str:
    """Return the kind of margin `index` of an orbit with this word; see `Margin`."""
    if not word.modes:
        return "stick"  # the stuck absorber has the reserve of friction as its only margin
    place, watch = place_of(word, index)
    if watch == Watch.DURATION:
        return "duration"
    if watch == Watch.STRENGTH:
        return STRENGTH[word.letter(place).kind if len(word) else STROBE]
    return word.alphabet.contacts[watch].watched(word.alphabet.entry(word.mode(place), watch))


def border_kind(word: Word, index: int) -> str:
    """Return the kind of border at which margin `index` vanishes."""
    name = margin_name(word, index)
    if name != "duration":
        return BORDERS[name]
    if not len(word):
        return "corner"
    place, _ = place_of(word, index)
    return word.alphabet.together(word.letter(place), word.letter(place + 1))


def approaches_of(word: Word, margins: np.ndarray) -> np.ndarray:
    """Return the margins of the impacts (their speeds) among all margins of a cycle or of half of it."""
    columns = word.alphabet.columns
    strengths = margins[columns.index(Watch.STRENGTH) :: len(columns)] if len(word) else margins[:0]
    return strengths[[word.letter(i).kind == HIT for i in range(strengths.size)]]


def margin_units(word: Word, units: tuple[float, float]) -> np.ndarray:
    """Return the unit of each margin, given the units (length, rate in 1/time); one entry 1.0 if all are 1."""
    length, rate = units
    sizes = {
        "flight": length * rate,
        "approach": length * rate,
        "wall": length,
        "turn": length * rate**2,
        "stick": length * rate**2,
        "slip": length * rate**3,
        "hold": 1.0 / rate,
        "duration": 1.0 / rate,
    }
    if not len(word) or (length == 1.0 and rate == 1.0):
        return np.ones(1)
    return np.array([sizes[margin_name(word, i)] for i in range(len(word.alphabet.columns) * len(word))])


def named_margins(word: Word, values: np.ndarray) -> list[Margin]:
    """Return the finite margins among `values` with their kinds and events."""
    return [
        Margin(margin_name(word, index), index // len(word.alphabet.columns), float(value))
        for index, value in enumerate(values)
        if np.isfinite(value)
    ]


def limits_of(multipliers: np.ndarray) -> np.ndarray:
    """Replace multipliers that grow without bound towards a border (as at a graze) by infinity with the same sign."""
    limits = np.array(multipliers, dtype=np.complex128)
    unbounded = np.abs(limits) >= 0.999 * UNBOUNDED
    for part in limits.view(np.float64).reshape(-1, 2).T:
        part[unbounded & (np.abs(part) > 1.0)] *= np.inf
    return limits
