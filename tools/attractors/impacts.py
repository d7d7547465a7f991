"""Compare cycles by their impacts, which both the package and the independent simulation compute."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

TWO_PI = 2.0 * np.pi
SAME = 2e-6  # largest difference of phases and velocities of impacts of one cycle


def impacts_of(orbit: Any) -> np.ndarray:
    """Return wall (1 left, -1 right), phase and B (velocity of the cavity minus that of the absorber) of every impact, shape (n, 3)."""
    if orbit.model.flow == "page":  # the absorber as a declared machine with the states w and w'
        of = dict(zip(orbit.model.parameter_names, orbit.params, strict=True))
        letters = [orbit.word.letter(i).text for i in range(len(orbit.word))]
        rows = [
            (
                1.0 if letter == "L" else -1.0,
                phase,
                of["amplitude"] * of["frequency"] * math.cos(phase) - rate,
            )
            for letter, (phase, _, rate) in zip(letters, orbit.nodes, strict=True)
            if letter in "LR"
        ]
        return np.array(rows).reshape(-1, 3)
    rows = [
        (1.0 if letter == "L" else -1.0, node[0], node[1])
        for letter, node in zip(orbit.word.events, orbit.nodes, strict=True)
        if letter in "LR"
    ]
    return np.array(rows).reshape(-1, 3)


def same(one: np.ndarray, other: np.ndarray, mirror: bool) -> bool:
    """Whether two lists of impacts belong to one cycle or, with `mirror`, to mirror images."""
    image = other * [-1.0, 1.0, -1.0] + [0.0, np.pi, 0.0]
    return _alike(one, other) or (mirror and _alike(one, image))


def _alike(one: np.ndarray, other: np.ndarray) -> bool:
    if len(one) != len(other):
        return False
    phases = np.abs((one[:, None, 1] - other[None, :, 1] + np.pi) % TWO_PI - np.pi)
    gaps = np.maximum(phases, np.abs(one[:, None, 2] - other[None, :, 2]))
    gaps[one[:, None, 0] != other[None, :, 0]] = np.inf
    nearest = gaps.argmin(axis=1)
    return bool(len(set(nearest)) == len(one) and gaps.min(axis=1).max(initial=0.0) < SAME)


def kind_of(periods: int, impacts: np.ndarray, piles: bool, mirror: bool) -> tuple:
    """Return the kind of a cycle: periods, whether impacts accumulate, and the cyclic order of walls. Cycles at different values may be of one kind."""
    walls = "" if piles else "".join("L" if x > 0 else "R" for x in impacts[:, 0])
    images = [walls, walls.translate(str.maketrans("LR", "RL"))] if mirror else [walls]
    return periods, piles, min(one[i:] + one[:i] for one in images for i in range(max(len(one), 1)))
