"""Two orbits as motions, whatever their words say: w at equal phases of the forcing."""

from __future__ import annotations

import math

import numpy as np

from orbits.cycles.sampling import PER_PERIOD
from orbits.cycles.solution import Solution

SAME = (
    1e-7  # motions whose w differs by less are one; two borders whose values agree to 1e-12 may be 5e-6 apart
)
CLOSE = 0.05  # largest difference in w between a border orbit and one that goes on from it, wherever that is measured
ALIKE = 1e-7  # motions that differ by less need not come any nearer
SHRINKS = 0.5  # by at least this factor a distance that tends to zero falls on the way to the border

COARSE = PER_PERIOD // 10  # every so many instants are compared first


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
    here, there = (
        orbit.track if orbit.periods == periods else np.tile(orbit.track, periods // orbit.periods)
        for orbit in (one, other)
    )
    free = one.word.impact_free or other.word.impact_free
    images = [here, -np.roll(here, -PER_PERIOD // 2)] if mirror else [here]
    best = np.inf
    turned = (PER_PERIOD * np.arange(one.periods)[:, None] + np.arange(0, len(here), COARSE)) % len(here)
    for image in images:
        rough = _largest(image[turned] - there[::COARSE], free)
        for shift in np.argsort(rough, kind="stable").tolist() if len(rough) > 1 else (0,):
            if rough[shift] >= best:
                break
            moved = np.roll(image, -PER_PERIOD * shift) if shift else image
            best = min(best, float(_largest(moved - there, free)))
    return best / one.model.natural_units(one.params)[0]


def _largest(gap: np.ndarray, free: bool) -> np.ndarray:
    return 0.5 * np.ptp(gap, axis=-1) if free else np.abs(gap).max(axis=-1)
