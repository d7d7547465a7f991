"""One orbit of a declared machine, one form: modulo rotation, whole forcing periods, the mirror image and repetition."""

from __future__ import annotations

from collections.abc import Hashable

import numpy as np

from orbits.words.of_pages import PageWord

SAME = 1e-7  # nodes closer than this, relative to 1 + their size, are one node


def root(word: PageWord, periods: int, nodes: np.ndarray, forced: bool) -> tuple[PageWord, int, np.ndarray]:
    """The shortest orbit of which this one is a repetition: its word, periods and nodes."""
    if not len(word):
        return word, periods, nodes
    most = min(word.repetitions, periods) if forced else word.repetitions
    for times in range(most, 1, -1):
        if word.repetitions % times or (forced and periods % times):
            continue
        length = len(word) // times
        shifted = nodes[length:].copy()
        if forced:
            shifted[:, 0] -= 2.0 * np.pi * (periods // times)
        if np.max(np.abs(shifted - nodes[:-length])) < SAME * (1.0 + np.abs(nodes[:, 1:]).max()):
            return word.head(length), periods // times if forced else periods, nodes[:length]
    return word, periods, nodes


def is_symmetric(word: PageWord, periods: int, nodes: np.ndarray, forced: bool) -> bool:
    """Whether the orbit equals its mirror image after half its period."""
    if not (word.mirror_symmetric_halves and (periods % 2 == 1 or not forced)) or not len(word):
        return False
    half = len(word) // 2
    image = -nodes[:half]
    image[:, 0] = nodes[:half, 0] + (np.pi * periods if forced else 0.0)
    return bool(np.max(np.abs(image - nodes[half:])) < SAME * (1.0 + np.abs(nodes[:, 1:]).max()))


def canonical(word: PageWord, periods: int, nodes: np.ndarray, forced: bool) -> tuple[Hashable, np.ndarray]:
    """Key and vector of the orbit's canonical form.

    The vector lists cos and sin of the phase (or the duration) and the states of each node, in that one of the readings with the
    canonical word whose projection on a fixed direction is largest.
    """
    word, periods, nodes = root(word, periods, nodes, forced)
    if forced:
        flat = np.concatenate([np.cos(nodes[:, :1]), np.sin(nodes[:, :1]), nodes[:, 1:]], axis=1)
        turned = np.full(
            flat.shape[1], -1.0
        )  # half a forcing period on: cosine and sine change their signs, too
    else:
        flat = nodes
        turned = np.r_[1.0, np.full(nodes.shape[1] - 1, -1.0)]
    direction = np.sin(np.arange(1, flat.size + 1) * np.sqrt(2.0)) + 0.1
    best, best_score = flat.ravel(), -np.inf
    for mirrored, place in word.readings():
        vector = (np.roll(flat, -place, axis=0) * (turned if mirrored else 1.0)).ravel()
        score = float(direction @ vector)
        if score > best_score + 1e-12:
            best, best_score = vector, score
    target = word.canonical()
    return (target.events, target.modes, periods), best
