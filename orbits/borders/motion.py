"""Two orbits as motions, whatever their words say: w at equal phases of the forcing."""

from __future__ import annotations

import math
from itertools import product

import numpy as np

from orbits.orbit import Orbit

SAME = 1e-5  # motions whose w differs by less are one


def distance(one: Orbit, other: Orbit, mirror: bool = False) -> float:
    """Largest difference in w at equal phases, modulo whole periods of the forcing, and the mirror image if asked for."""
    periods = math.lcm(one.periods, other.periods)
    grid = np.linspace(0.0, 2.0 * np.pi * periods, 400 * periods, endpoint=False)
    there = position(other, grid)
    images = [(1.0, 0.0), (-1.0, np.pi)] if mirror else [(1.0, 0.0)]
    return min(
        float(np.abs(sign * position(one, grid + 2.0 * np.pi * shift + half) - there).max())
        for shift, (sign, half) in product(range(one.periods), images)
    )


def position(orbit: Orbit, phase: np.ndarray) -> np.ndarray:
    """w at some phases of the forcing."""
    path = orbit.sample(4000 * orbit.periods)
    start = path["phase"][0]
    return np.interp((phase - start) % (2.0 * np.pi * orbit.periods), path["phase"] - start, path["w"])
