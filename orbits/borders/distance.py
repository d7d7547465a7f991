"""Two orbits as motions, whatever their words say: w at equal phases of the forcing."""

from __future__ import annotations

import math
from itertools import product

import numpy as np

from orbits.orbit import Orbit

SAME = 1e-5  # motions whose w differs by less are one


PER_PERIOD = 400  # instants in a forcing period
COARSE = 40  # every so many of them are compared first


def distance(one: Orbit, other: Orbit, mirror: bool = False) -> float:
    """Largest difference in w at equal phases, modulo whole periods of the forcing, and the mirror image if asked for."""
    periods = math.lcm(one.periods, other.periods)
    grid = np.linspace(0.0, 2.0 * np.pi * periods, PER_PERIOD * periods, endpoint=False)
    there, here = position(other, grid), position(one, grid)
    images = [here, -np.roll(here, -PER_PERIOD // 2)] if mirror else [here]
    best = np.inf
    for image, shift in product(images, range(one.periods)):
        moved = np.roll(image, -PER_PERIOD * shift)
        if np.abs(moved[::COARSE] - there[::COARSE]).max() < best:
            best = min(best, float(np.abs(moved - there).max()))
    return best


def position(orbit: Orbit, phase: np.ndarray) -> np.ndarray:
    """w at some phases of the forcing."""
    path = orbit.sample(4000 * orbit.periods)
    start = path["phase"][0]
    return np.interp((phase - start) % (2.0 * np.pi * orbit.periods), path["phase"] - start, path["w"])
