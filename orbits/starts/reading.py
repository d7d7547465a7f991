"""Which reading of a word a guess belongs to: where the letters leave a direction open, and from which event it is read."""

from __future__ import annotations

from contextlib import suppress

import numpy as np

from orbits.words import Word, WordError


class DirectionError(ValueError):
    """A guess that moves against the directions that its word states."""


def directed(text: str | Word, reading: Word, nodes: np.ndarray) -> Word:
    """The word with the directions of the guess, where its letters leave them open.

    Parameters
    ----------
    text : str or Word
        As it was given.
    reading : Word
        The same, directions that nothing fixes taken by default.
    nodes : float array (L, n)
        The guess: (Psi, B+) at impacts and (Psi, w) elsewhere.

    Raises
    ------
    DirectionError
        If directions are stated, with ``s+`` or ``s-``, and the guess goes the other way.
    """
    if reading.frictionless:
        return reading
    places = np.array(
        [{"L": 1.0, "R": -1.0}.get(letter, w) for letter, w in zip(reading.events, nodes[:, 1])]
    )
    ways = np.sign(np.roll(places, -1) - places)
    found = max((reading, *_others(reading, ways)), key=lambda word: _agreement(word, ways))
    if found.modes == reading.modes or _agreement(found, ways) < np.count_nonzero(found.modes):
        return reading
    stated = not isinstance(text, str) or "+" in text or "-" in text or "−" in text
    if stated:
        raise DirectionError(
            f"guess moves the other way than the word {reading.text!r} says: its positions w belong to {found.text!r}; "
            "give that word, or the mirror image of the guess (w with the opposite sign, half a forcing period later)"
        )
    return found


def _agreement(word: Word, ways: np.ndarray) -> float:
    return float(np.dot(word.modes, ways))


def _others(reading: Word, ways: np.ndarray) -> list[Word]:
    """Words with the same letters whose flights go other ways."""
    found = [reading.mirror()] if reading.impact_free else []
    slips = [
        f"{letter}{'+' if way > 0.0 else '-'}" if letter == "u" and way else letter
        for letter, way in zip(reading.events, ways)
    ]
    with suppress(WordError):
        found.append(Word.parse("".join(slips)))
    return found


def readings(word: Word, mirror: bool) -> list[Word]:
    """The other rotations of a word, and those of its mirror image, each once."""
    images = (word, word.mirror()) if mirror else (word,)
    found: list[Word] = []
    for image in images:
        for place in range(len(word)):
            turned = image.rotate(place)
            if turned != word and turned not in found:
                found.append(turned)
    return found
