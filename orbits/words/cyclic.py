"""Cyclic words over any alphabet: what rotations, mirror images, repetitions and roots of a periodic motion's word are."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from functools import cached_property, lru_cache
from typing import Any, Self

from orbits.contacts.letters import HIT, Letter
from orbits.words.alphabet import Alphabet


class WordError(ValueError):
    """A word whose events cannot follow one another."""


class CyclicWord(ABC):
    """A cyclic list of events with the mode that follows each of them.

    Attributes
    ----------
    events : tuple of str
    modes : tuple
        As the alphabet writes them; a word without events may have one mode.
    alphabet : Alphabet
    """

    events: tuple[str, ...]
    modes: tuple[Any, ...]
    alphabet: Alphabet

    @abstractmethod
    def like(self, events: Sequence[str], modes: Sequence[Any]) -> Self:
        """A word over the same alphabet."""

    # ------------------------------------------------------------------ facts
    def __len__(self) -> int:
        return len(self.events)

    def __str__(self) -> str:
        return self.text

    @property
    @abstractmethod
    def text(self) -> str:
        """As it is written in studies."""

    def spelled(self, mirror: bool = True) -> str:
        """The word as people are told it; any reading of it may be told as it stands."""
        return self.text

    @cached_property
    def impact_free(self) -> bool:
        """Whether no wall is hit."""
        return self.impacts == 0

    def describe(self) -> dict[str, Any]:
        """Events and modes, ready for JSON."""
        return {"events": list(self.events), "modes": [list(mode) for mode in self.modes]}

    def letter(self, place: int) -> Letter:
        """The letter of an event."""
        return self.alphabet.letters[self.events[place % len(self.events)]]

    def mode(self, place: int) -> Any:
        """The mode after an event."""
        return self.modes[place % len(self.modes)]

    @cached_property
    def impacts(self) -> int:
        """Number of impacts l."""
        letters = self.alphabet.letters
        return sum(letters[text].kind == HIT for text in self.events)

    # ------------------------------------------------------------------ transformations
    def rotate(self, places: int) -> Self:
        """The same cycle read from the event `places` further on."""
        if not self.events:
            return self
        k = places % len(self.events)
        return self.like(self.events[k:] + self.events[:k], self.modes[k:] + self.modes[:k])

    def mirror(self) -> Self:
        """The word of the mirror image."""
        return self._image

    @cached_property
    def _image(self) -> Self:
        images, mirrored = self.alphabet.images, self.alphabet.mirrored_mode
        return self.like([images[text] for text in self.events], [mirrored(mode) for mode in self.modes])

    def repeat(self, times: int) -> Self:
        """The word written `times` times."""
        if times < 1:
            raise WordError(f"times = {times}: a word can be repeated 1, 2, ... times")
        return self.like(self.events * times, self.modes * times if self.events else self.modes)

    def double(self) -> Self:
        """The word written twice, as after a period doubling."""
        return self.repeat(2)

    def head(self, length: int) -> Self:
        """The first `length` events; not a cycle of its own, but the half of a symmetric one."""
        return self.like(self.events[:length], self.modes[:length] if self.events else self.modes)

    def with_image(self) -> Self:
        """The word and, after it, its mirror image: the whole of a symmetric cycle from its half."""
        image = self.mirror()
        return self.like(self.events + image.events, self.modes + image.modes)

    @cached_property
    def repetitions(self) -> int:
        """How often the primitive root is written in this word."""
        return power(list(zip(self.events, self.modes))) if self.events else 1

    def primitive_root(self) -> Self:
        """The shortest word of which this one is a repetition."""
        return self.head(len(self.events) // self.repetitions)

    def canonical(self, mirror: bool = True) -> Self:
        """The smallest of all rotations of the word, and of its mirror image if that is a motion of the machine, too."""
        if not self.events and not self.modes:
            return self
        alphabet = self.alphabet
        return _canonical(self, mirror and alphabet.mirror is not None, alphabet)

    def _smallest_rotation(self) -> Self:
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


@lru_cache(maxsize=1024)
def _canonical(word: Any, mirror: bool, alphabet: Alphabet) -> Any:
    images = (word, word.mirror()) if mirror else (word,)
    return min((w._smallest_rotation() for w in images), key=lambda w: (w.events, w.modes))


@lru_cache(maxsize=256)
def _readings(word: Any, mirror: bool, alphabet: Alphabet) -> list[tuple[bool, int]]:
    target = word.canonical(mirror)
    images = [(word, False), (word.mirror(), True)] if mirror else [(word, False)]
    return [
        (mirrored, k)
        for reading, mirrored in images
        for k in range(max(1, len(word)))
        if reading.rotate(k) == target
    ]


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
