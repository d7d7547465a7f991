"""One orbit, one form: modulo rotation of the word, whole forcing periods, the mirror image and repetition."""

from __future__ import annotations

from collections.abc import Hashable
from functools import cache

import numpy as np

from orbits.words import Word

SAME = 1e-7  # nodes closer than this are one node


def root_orbit(word: Word, periods: int, nodes: np.ndarray) -> tuple[Word, int, np.ndarray]:
    """The shortest orbit of which this one is a repetition: its word, periods and nodes (l, n)."""
    for times in range(min(word.repetitions, periods), 1, -1):
        if word.repetitions % times or periods % times:
            continue
        length = len(word) // times
        step = 2.0 * np.pi * (periods // times)
        shifted = nodes[length:].copy()
        shifted[:, 0] -= step
        if np.max(np.abs(shifted - nodes[:-length])) < SAME:
            return word.head(length), periods // times, nodes[:length]
    return word, periods, nodes


def is_symmetric(word: Word, periods: int, nodes: np.ndarray, tolerance: float = SAME) -> bool:
    """Whether the orbit equals its mirror image after half its period."""
    if not len(word):
        return True
    if not (word.mirror_symmetric_halves and periods % 2 == 1):
        return False
    half = len(word) // 2
    image = -nodes[:half]
    image[:, 0] = nodes[:half, 0] + np.pi * periods
    return bool(np.max(np.abs(image - nodes[half:])) < tolerance)


@cache
def _direction(size: int) -> np.ndarray:
    """A direction in which no two different orbits look alike by chance."""
    return np.sin(np.arange(1, size + 1) * np.sqrt(2.0)) + 0.1


def canonical(
    word: Word, periods: int, nodes: np.ndarray, mirror: bool = True
) -> tuple[Hashable, np.ndarray]:
    """Key (word and periods) and vector of the orbit's canonical form.

    The vector lists cos Psi, sin Psi and the other unknowns of each node, in that one of the rotations (and mirror
    images, where the machine has them) with the canonical word whose projection on a fixed direction is largest.
    """
    word, periods, nodes = root_orbit(word, periods, nodes)
    target = word.canonical(mirror)
    flat = np.concatenate([np.cos(nodes[:, :1]), np.sin(nodes[:, :1]), nodes[:, 1:]], axis=1)
    direction = _direction(flat.size)
    best, best_score = flat.ravel(), -np.inf
    for mirrored, place in word.readings(mirror):
        vector = (-1.0 if mirrored else 1.0) * np.roll(flat, -place, axis=0).ravel()
        score = float(direction @ vector)
        if score > best_score + 1e-12:
            best, best_score = vector, score
    return (target.events, target.modes, periods), best
