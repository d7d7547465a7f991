"""One orbit, one form: modulo rotation of the word, whole forcing periods, the mirror image and repetition.

Nodes are those of a cycle, shape (l, n): the phase and the states at each event, of a self-excited machine (``forced`` False) the
duration before it and the states.
"""

from __future__ import annotations

from collections.abc import Hashable
from functools import cache

import numpy as np

from orbits.settings import EVENTS, SIMULATING
from orbits.words.word import Word


def size_of_one(nodes: np.ndarray) -> float:
    """Distance below which nodes (L, n + 1) are one, of a machine whose states have any size."""
    return SIMULATING.one * (1.0 + float(np.abs(nodes[:, 1:]).max(initial=0.0)))


def root_orbit(
    word: Word, periods: int, nodes: np.ndarray, *, forced: bool = True, same: float = SIMULATING.one
) -> tuple[Word, int, np.ndarray]:
    """The shortest orbit of which this one is a repetition: its word, periods and nodes (l, n), without events one per forcing period."""
    repetitions = word.repetitions if len(word) else len(nodes)
    for times in range(min(repetitions, periods) if forced else repetitions, 1, -1):
        if repetitions % times or (forced and periods % times):
            continue
        length = len(nodes) // times
        shifted = nodes[length:].copy()
        if forced:
            shifted[:, 0] -= 2.0 * np.pi * (periods // times)
        if np.abs(shifted - nodes[:-length]).max() < same:
            return word.head(length), periods // times if forced else periods, nodes[:length]
    return word, periods, nodes


def is_symmetric(
    word: Word,
    periods: int,
    nodes: np.ndarray,
    same: float = SIMULATING.one,
    *,
    forced: bool = True,
    image: np.ndarray | None = None,
) -> bool:
    """Whether the orbit equals its mirror image after half its period.

    `image` are the nodes mirrored, at the same phases; by default all states have the opposite sign.
    """
    if not len(word):
        return not len(nodes)  # at rest; a forced motion without events: `orbits.cycles.cycle`
    if not (word.mirror_symmetric_halves and (periods % 2 == 1 or not forced)):
        return False
    half = len(word) // 2
    image = (-nodes if image is None else image)[:half].copy()
    image[:, 0] = nodes[:half, 0] + (np.pi * periods if forced else 0.0)
    return bool(np.max(np.abs(image - nodes[half:])) < same)


@cache
def _direction(size: int) -> np.ndarray:
    """A direction in which no two different orbits look alike by chance; twice, so that its rotations are parts of it."""
    return np.tile(np.sin(np.arange(1, size + 1) * np.sqrt(2.0)) + 0.1, 2)


def canonical(
    word: Word,
    periods: int,
    nodes: np.ndarray,
    mirror: bool = True,
    *,
    forced: bool = True,
    same: float = SIMULATING.one,
) -> tuple[Hashable, np.ndarray]:
    """Key (word and periods) and vector of the orbit's canonical form.

    The vector lists cosine and sine of the phase (or the duration) and the other unknowns of each node, in that one of the rotations
    (and mirror images, where the machine has them) with the canonical word whose projection on a fixed direction is largest.
    """
    word, periods, nodes = root_orbit(word, periods, nodes, forced=forced, same=same)
    target = word.canonical(mirror)
    image: float | np.ndarray = -1.0  # half a forcing period on cosine and sine change their signs, too
    if forced:
        flat = np.empty((len(nodes), nodes.shape[1] + 1))
        np.cos(nodes[:, 0], out=flat[:, 0])
        np.sin(nodes[:, 0], out=flat[:, 1])
        flat[:, 2:] = nodes[:, 1:]
    else:
        flat, image = nodes, np.r_[1.0, np.full(nodes.shape[1] - 1, -1.0)]
    readings = word.readings(mirror)
    if not len(word):
        readings = [(mirrored, k) for mirrored, _ in readings for k in range(len(nodes))]
    best, best_score = readings[0], -np.inf
    if len(readings) > 1:
        size, images = flat.size, (flat.ravel(), (image * flat).ravel())
        direction = _direction(size)
        for reading in readings:
            turn = size - reading[1] * flat.shape[1]
            score = float(direction[turn : turn + size] @ images[reading[0]])
            if score > best_score + EVENTS.zero:
                best, best_score = reading, score
    mirrored, place = best
    turned = np.concatenate([flat[place:], flat[:place]]) if place else flat
    return (target.events, target.modes, periods), (image * turned if mirrored else turned).ravel()
