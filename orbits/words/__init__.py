"""Words: periodic motions as cyclic lists of events, over the alphabet of any machine, and the margins of their events.

A periodic orbit P_l^k is a cyclic list of events, l of them impacts, over k forcing periods. That list is its word. Some numbers watch each
event and the flight after it (`Alphabet.watched` says what): where all are positive the orbit is real, and where one vanishes is a border.
Flows compute them; here they have their names, as the laws of the contacts say.
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


def power(items: Sequence[Any]) -> int:
    """How often the shortest root is written in a sequence."""
    n = len(items)
    return next(n // r for r in range(1, n + 1) if n % r == 0 and items[r:] == items[: n - r])


@dataclass(frozen=True)
class Word:
    """A cyclic list of events with the mode that follows each of them.

    Build one with `Word.parse` or a machine's `word`; the constructor trusts its arguments.

    Attributes
    ----------
    events : tuple of str
        Letters of the alphabet; of the shaken machines ``L R t s u``, where every ``s`` is followed by its ``u``.
    modes : tuple
        What is in contact, and how it slides, after each event: an int of the shaken machines (-1, 0 or +1), a tuple with an
        entry per contact of others. A word without events may have one mode.
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
            Read the word for a machine without friction: ``LL`` needs no turn then.

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
        """Read a word over any alphabet; see `orbits.words.alphabet.read`."""
        if isinstance(text, Word):
            if alphabet.alone is None or text.alphabet.without == alphabet.without:
                return text
            text = text.text
        return cls(*read(text, alphabet, absent), alphabet)

    @classmethod
    def described(cls, about: Mapping[str, Any], alphabet: Alphabet | None = None) -> Word:
        """The word that `describe` describes; without an alphabet, one of the shaken machines."""
        modes = tuple(tuple(mode) if isinstance(mode, list) else mode for mode in about.get("modes", ()))
        # files of version 0.1 keep no events for the absorber at rest
        return cls(tuple(about.get("events", "")), modes, alphabet or shaken(bool(about.get("frictionless"))))

    def like(self, events: Sequence[str], modes: Sequence[Mode]) -> Word:
        """A word over the same alphabet."""
        return _word(tuple(events), tuple(modes), self.alphabet)

    # ------------------------------------------------------------------ facts
    def __len__(self) -> int:
        return len(self.events)

    def __str__(self) -> str:
        return self.text

    @cached_property
    def text(self) -> str:
        """As it is written in studies: signs and modes (in brackets) appear only where the events leave them open."""
        if not self.modes:
            return ""
        turns = bool(self.events) and all(self.letter(i).kind == TURN for i in range(len(self)))
        alphabet = self.alphabet
        for signed, noted in ((False, ()), (True, ())) if alphabet.alone is not None else (
            (False, ()), (True, ()), (True, (0,)),
        ):  # fmt: skip
            text = self._written(signed, noted)
            with suppress(WordError):
                again = self.over(alphabet, text, alphabet.absent_in(self.modes[0]))
                places = range(len(self)) if turns and again.events == self.events else (0,)
                if any(again.rotate(k) == self for k in places):
                    return text  # the same cycle, even where the text leaves open from which event it is read
        return (
            self._written(True)
            if alphabet.alone is not None
            else self._written(False, range(len(self.modes)))
        )

    def _written(self, signed: bool, noted: Sequence[int] = ()) -> str:
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
        """The word as printed: of the shaken machines one spelling for one motion, from whichever event and in whichever mirror image.

        That of `canonical`, without signs where the letters alone mean this motion. Words of declared machines stand as they are read.
        """
        if self.alphabet.alone is None:
            return self.text
        return _spelled(self.canonical(mirror), mirror, self.alphabet)

    def describe(self) -> dict[str, Any]:
        """Events and modes, ready for JSON."""
        if self.alphabet.alone is None:
            return {"events": list(self.events), "modes": [list(mode) for mode in self.contact_modes]}
        return {
            "events": "".join(self.events),
            "modes": list(self.modes),
            "frictionless": self.frictionless,
        }

    @property
    def frictionless(self) -> bool:
        """Whether flights of a shaken machine may reverse freely, so that only impacts are events."""
        return bool(self.alphabet.without)

    @cached_property
    def codes(self) -> np.ndarray:
        """Numbers of the events' letters, shape (n,), int8."""
        return np.array([self.alphabet.codes[letter] for letter in self.events], dtype=np.int8)

    @cached_property
    def mode_codes(self) -> np.ndarray:
        """Mode after each event, shape (n,) or (n, contacts), int8."""
        return np.array(self.modes, dtype=np.int8)

    @cached_property
    def impact_free(self) -> bool:
        """Whether no wall is hit."""
        return self.impacts == 0

    def letter(self, place: int) -> Letter:
        """The letter of an event."""
        return self.alphabet.letters[self.events[place % len(self.events)]]

    def mode(self, place: int) -> Mode:
        """The mode after an event."""
        return self.modes[place % len(self.modes)]

    def entries(self, place: int) -> tuple[int, ...]:
        """What every contact does after an event."""
        return self.alphabet.entries(self.mode(place))

    @property
    def contact_modes(self) -> tuple[tuple[int, ...], ...]:
        """What every contact does after each event."""
        return tuple(map(self.alphabet.entries, self.modes))

    @cached_property
    def impacts(self) -> int:
        """Number of impacts l."""
        letters = self.alphabet.letters
        return sum(letters[text].kind == HIT for text in self.events)

    # ------------------------------------------------------------------ transformations
    def rotate(self, places: int) -> Word:
        """The same cycle read from the event `places` further on."""
        if not self.events:
            return self
        k = places % len(self.events)
        return self.like(self.events[k:] + self.events[:k], self.modes[k:] + self.modes[:k])

    def mirror(self) -> Word:
        """The word of the mirror image."""
        return self._image

    @cached_property
    def _image(self) -> Word:
        images, mirrored = self.alphabet.images, self.alphabet.mirrored_mode
        return self.like([images[text] for text in self.events], [mirrored(mode) for mode in self.modes])

    def repeat(self, times: int) -> Word:
        """The word written `times` times."""
        if times < 1:
            raise WordError(f"times = {times}: a word can be repeated 1, 2, ... times")
        return self.like(self.events * times, self.modes * times if self.events else self.modes)

    def double(self) -> Word:
        """The word written twice, as after a period doubling."""
        return self.repeat(2)

    def head(self, length: int) -> Word:
        """The first `length` events; not a cycle of its own, but the half of a symmetric one."""
        return self.like(self.events[:length], self.modes[:length] if self.events else self.modes)

    def with_image(self) -> Word:
        """The word and, after it, its mirror image: the whole of a symmetric cycle from its half."""
        if not self.events:
            return self
        image = self.mirror()
        return self.like(self.events + image.events, self.modes + image.modes)

    @cached_property
    def repetitions(self) -> int:
        """How often the primitive root is written in this word."""
        return power(list(zip(self.events, self.modes))) if self.events else 1

    def primitive_root(self) -> Word:
        """The shortest word of which this one is a repetition."""
        return self.head(len(self.events) // self.repetitions)

    def canonical(self, mirror: bool = True) -> Word:
        """The smallest of all rotations of the word, and of its mirror image if that is a motion of the machine, too."""
        if not self.events and not self.modes:
            return self
        alphabet = self.alphabet
        return _canonical(self, mirror and alphabet.mirror is not None, alphabet)

    def _smallest_rotation(self) -> Word:
        """The smallest rotation by its events, of those with equal events by its modes; no slip begins a word."""
        if not self.events:
            return self
        place, root = least_rotation(self.events), len(self.events) // power(self.events)
        modes = self.modes[place:] + self.modes[:place]
        blocks = [modes[i : i + root] for i in range(0, len(modes), root)]
        return self.rotate(place + root * least_rotation(blocks))

    def readings(self, mirror: bool = True) -> list[tuple[bool, int]]:
        """(mirrored, rotation) of every way in which this word reads as its canonical form."""
        alphabet = self.alphabet
        return _readings(self, mirror and alphabet.mirror is not None, alphabet)

    @cached_property
    def mirror_symmetric_halves(self) -> bool:
        """Whether the second half is the mirror image of the first: the word a symmetric orbit can have."""
        if self.alphabet.mirror is None:
            return False
        n = len(self.events)
        if n == 0:
            return bool(self.modes) and self.mirror() == self
        return n % 2 == 0 and self.rotate(n // 2) == self.mirror()


@lru_cache(maxsize=4096)
def _word(events: tuple[str, ...], modes: tuple[Mode, ...], alphabet: Alphabet) -> Word:
    """A word, the same one every time: what is worked out of it is kept."""
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
        What is watched: ``flight`` (smallest relative speed inside it), ``wall`` (distance kept from the walls),
        ``approach`` (impact speed), ``turn`` (excess of the shaking over friction), ``stick`` (reserve of friction),
        ``slip`` (rate at which friction gives way), ``hold`` (time to the slip, or reserve until then), ``push`` (of a wall that holds),
        ``switch`` (distance from its surface, or rate there) or ``duration``.
    segment : int
        Index of the event it belongs to; a flight is counted with the event before it.
    value : float
        Positive when the orbit is real.
    """

    kind: str
    segment: int
    value: float


def place_of(word: Word, index: int) -> tuple[int, int]:
    """The event to which margin `index` belongs (without events the first node), and what it watches: a contact, or one of `Watch`."""
    place, column = divmod(index, len(word.alphabet.columns))
    return place if len(word) else 0, word.alphabet.columns[column]


def margin_name(word: Word, index: int) -> str:
    """What margin `index` of an orbit with this word watches; see `Margin`."""
    if not word.modes:
        return "stick"  # at rest: the reserve of friction
    place, watch = place_of(word, index)
    if watch == Watch.DURATION:
        return "duration"
    if watch == Watch.STRENGTH:
        return STRENGTH[word.letter(place).kind if len(word) else STROBE]
    return word.alphabet.contacts[watch].watched(word.alphabet.entry(word.mode(place), watch))


def border_kind(word: Word, index: int) -> str:
    """The kind of border that is met where margin `index` vanishes."""
    name = margin_name(word, index)
    if name != "duration":
        return BORDERS[name]
    if not len(word):
        return "corner"
    place, _ = place_of(word, index)
    return word.alphabet.together(word.letter(place), word.letter(place + 1))


def approaches_of(word: Word, margins: np.ndarray) -> np.ndarray:
    """The margins of the impacts, their speeds, from those of all events of a cycle, or of half of them."""
    columns = word.alphabet.columns
    own = margins[columns.index(Watch.STRENGTH) :: len(columns)] if len(word) else margins[:0]
    return own[[word.letter(i).kind == HIT for i in range(own.size)]]


def margin_units(word: Word, units: tuple[float, float]) -> np.ndarray:
    """What margins of one are in a length and a rate, an entry per margin, or one for all."""
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
    """The finite margins among `values` with their names."""
    return [
        Margin(margin_name(word, index), index // len(word.alphabet.columns), float(value))
        for index, value in enumerate(values)
        if np.isfinite(value)
    ]


def limits_of(multipliers: np.ndarray) -> np.ndarray:
    """One-sided limits of multipliers at a border: infinite, of their sign, where they grow without bound, as at a graze."""
    limits = np.array(multipliers, dtype=np.complex128)
    grown = np.abs(limits) >= 0.999 * UNBOUNDED
    for part in limits.view(np.float64).reshape(-1, 2).T:
        part[grown & (np.abs(part) > 1.0)] *= np.inf
    return limits
