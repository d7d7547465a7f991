"""The problems of larger and smaller words that a problem's solutions are related to: by mirror image, doubling and repetition.

The same for every machine: closed form or declared, forced or self-excited.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, cached_property
from typing import Self

import numpy as np

from orbits.protocol import Embedding, Symmetry
from orbits.words.word import Word


class Relatives:
    """Images, larger and smaller problems of the problem of a word.

    Attributes
    ----------
    word, periods, length, symmetric : the word, forcing periods of the whole cycle, unknown nodes, whether on half the word
    forced : bool
        Else the period is unknown, and the first entry of a node is a duration, not a phase.
    mirrored : bool
        Whether the machine has a mirror image.
    shift : float
        Phase from the first node to the one after the last.
    """

    word: Word
    periods: int
    length: int
    symmetric: bool
    forced: bool
    mirrored: bool
    shift: float

    @property
    def image_offset(self) -> Callable[[float], np.ndarray] | None:
        """What a mirrored solution's unknowns have beside the opposite signs, at parameter value p; None where there is nothing."""
        return None

    def expand(self, u: np.ndarray, p: float | np.ndarray | None = None) -> np.ndarray:
        """Nodes of the whole cycle, from the unknowns."""
        raise TypeError("a problem says how unknowns and nodes go together")

    def reduce(self, nodes: np.ndarray) -> np.ndarray:
        """Unknowns, from the nodes of the whole cycle."""
        raise TypeError("a problem says how unknowns and nodes go together")

    def sibling(self, word: Word, periods: int, symmetric: bool, params: np.ndarray | None = None) -> Self:
        """The problem of another word of the same machine against the same parameter."""
        raise TypeError("a problem says how it is made for another word")

    @property
    def symmetries(self) -> tuple[Symmetry, ...]:
        """Images of a solution of the full word: the mirror some places on, and a doubled word's shift by its half."""
        return self._images

    @cached_property
    def _images(self) -> tuple[Symmetry, ...]:
        if self.symmetric or not self.word.modes:
            return ()
        found = []
        for places in self._mirror_places() if self.mirrored else ():
            found.append(self._mirrored_on(places))
        repetitions = self.word.repetitions if len(self.word) else self.length
        if repetitions % 2 == 0 and (not self.forced or self.periods % 2 == 0):
            periods = self.periods // 2 if self.forced else 1
            root = self._root(self.word.head(len(self.word) // 2), periods, symmetric=False)
            found.append(Symmetry("period-doubling", lambda u: self._rotated(u, self.length // 2, 1.0), root))
        return tuple(found)

    def _root(
        self, word: Word, periods: int, symmetric: bool
    ) -> Callable[[np.ndarray], tuple[Self, np.ndarray]]:
        """Takes a solution that is its own image to the problem of a shorter word, made when it is first asked for, and there."""
        made = cache(lambda: self.sibling(word, periods, symmetric))
        return lambda u: (made(), made().reduce(self.expand(u)))

    def _mirrored_on(self, places: int) -> Symmetry:
        periods = 2 * self.periods * places // self.length if self.forced else 1
        root = self._root(self.word.head(2 * places), periods, symmetric=True)
        return Symmetry(
            "symmetry-breaking", lambda u: self._rotated(u, places, -1.0), root, offset=self.image_offset
        )

    def _mirror_places(self) -> list[int]:
        """Rotations that make the word its mirror image, an odd number of half forcing periods on, the least first.

        A word that repeats a shorter one has several: its motions may be symmetric as a whole, or repeat a symmetric motion.
        """
        mirror, n = self.word.mirror(), self.length
        found = []
        for places in range(1, n // 2 + 1):
            if n % (2 * places):
                continue
            times = n // (2 * places)
            if self.forced and (self.periods % times or (self.periods // times) % 2 == 0):
                continue
            if self.word.rotate(places) == mirror:
                found.append(places)
        return found

    def _rotated(self, u: np.ndarray, places: int, sign: float) -> np.ndarray:
        """Nodes some places on, at the same phase again, their states times `sign`."""
        nodes = self.expand(u)
        image = np.concatenate([nodes[places:], nodes[:places]])
        image[:, 1:] *= sign
        if self.forced:
            turn = self.shift * places / self.length
            image[: self.length - places, 0] -= turn
            image[self.length - places :, 0] += self.shift - turn
        return self.reduce(image)

    def offspring(
        self, kind: str, u: np.ndarray, p: float, tangent: np.ndarray, multiplier: complex
    ) -> list[Embedding]:
        """The larger problem whose branch point a symmetry breaking or period doubling is, with the point in it."""
        along = np.asarray(tangent[:-1])
        if kind == "symmetry-breaking" and self.symmetric:
            full = self.sibling(self.word, self.periods, symmetric=False)
            image = -along.reshape(self.length, -1)
            image[:, 0] *= -1.0
            direction = np.concatenate([along, image.ravel(), tangent[-1:]])
            return [Embedding(full, full.reduce(self.expand(u, p)), direction, kind)]
        if kind == "period-doubling" and not self.symmetric and self.word.modes:
            periods = 2 * self.periods if self.forced else 1
            double = self.sibling(self.word.double(), periods, symmetric=False)
            nodes = self.expand(u, p)
            second = nodes.copy()
            second[:, 0] += self.shift
            direction = np.concatenate([along, along, tangent[-1:]])
            return [Embedding(double, double.reduce(np.concatenate([nodes, second])), direction, kind)]
        if kind == "branch-point":
            return [Embedding(self, np.array(u), np.array(tangent), kind)]
        return []
