"""Two orbits as motions, whatever their words say: w at equal phases of the forcing."""

from __future__ import annotations

import math
from itertools import product

import numpy as np

from orbits.cycles.solution import Solution

SAME = 1e-5  # motions whose w differs by less are one
CLOSE = 0.05  # largest difference in w between a border orbit and one that goes on from it, wherever that is measured
ALIKE = 1e-7  # motions that differ by less need not come any nearer
SHRINKS = 0.5  # by at least this factor a distance that tends to zero falls on the way to the border

PER_PERIOD = 400  # instants in a forcing period
COARSE = 40  # every so many of them are compared first


def tends_to(border: Solution, near: Solution, further: Solution) -> bool:
    """Whether orbits tend to a border orbit, measured twice: `further` is the same orbit at some distance from `near`.

    An orbit that is only similar keeps its distance.
    """
    close = distance(border, near)
    return close < ALIKE or (close < CLOSE and close < SHRINKS * distance(border, further))


def distance(one: Solution, other: Solution, mirror: bool = False) -> float:
    """Largest difference in w at equal phases, modulo whole periods of the forcing, and the mirror image if asked for.

    In units of the machine's size. Where one of them hits no wall its mean position is free, and left out.
    """
    periods = math.lcm(one.periods, other.periods)
    grid = np.linspace(0.0, 2.0 * np.pi * periods, PER_PERIOD * periods, endpoint=False)
    there, here = position(other, grid), position(one, grid)
    free = one.word.impact_free or other.word.impact_free
    images = [here, -np.roll(here, -PER_PERIOD // 2)] if mirror else [here]
    best = np.inf
    for image, shift in product(images, range(one.periods)):
        moved = np.roll(image, -PER_PERIOD * shift)
        if _largest((moved - there)[::COARSE], free) < best:
            best = min(best, _largest(moved - there, free))
    return best / one.model.natural_units(one.params)[0]


def _largest(gap: np.ndarray, free: bool) -> float:
    return float(0.5 * np.ptp(gap)) if free else float(np.abs(gap).max())


def position(orbit: Solution, phase: np.ndarray) -> np.ndarray:
    """w at some phases of the forcing: cubics between instants at which w and w' are known."""
    path = orbit.path
    ahead = path["phase"] - path["phase"][0]
    wanted = (np.asarray(phase) - path["phase"][0]) % (2.0 * np.pi * orbit.periods)
    before = np.clip(np.searchsorted(ahead, wanted, side="right") - 1, 0, len(ahead) - 2)
    length = ahead[before + 1] - ahead[before]
    t = np.divide(wanted - ahead[before], length, out=np.zeros_like(wanted), where=length > 0.0)
    scale = length / orbit.parameters["frequency"]
    w, rate = path["w"], path["w_rate"]
    return (
        (1.0 + 2.0 * t) * (1.0 - t) ** 2 * w[before]
        + t * (1.0 - t) ** 2 * scale * rate[before]
        + t * t * (3.0 - 2.0 * t) * w[before + 1]
        + t * t * (t - 1.0) * scale * rate[before + 1]
    )
