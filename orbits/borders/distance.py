"""Two orbits as motions, whatever their words say: w at equal phases of the forcing."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from orbits.cycles.solution import Solution
from orbits.flows.native.sampling import PER_PERIOD

SAME = (
    1e-7  # motions whose w differs by less are one; two borders whose values agree to 1e-12 may be 5e-6 apart
)
CLOSE = 0.05  # largest difference in w between a border orbit and one that goes on from it, wherever that is measured
ALIKE = 1e-7  # motions that differ by less need not come any nearer
SHRINKS = 0.5  # by at least this factor a distance that tends to zero falls on the way to the border

COARSE = 10  # every so many instants are compared first
INSTANTS = (
    PER_PERIOD // 5
)  # of a period by which motions near a border are compared, where they differ all along


def tends_to(border: Solution, near: Solution, further: Solution) -> bool:
    """Whether orbits tend to a border orbit, measured twice: `further` is the same orbit at some distance from `near`.

    An orbit that is only similar keeps its distance. All are read at the same phases.
    """
    return tends(gap(border, near), lambda: gap(border, further))


def tends(close: float, further: Callable[[], float]) -> bool:
    """The same from their distances; the larger one is asked for where it matters."""
    return close < ALIKE or (close < CLOSE and close < SHRINKS * further())


def gap(border: Solution, near: Solution) -> float:
    """The distance of orbits of one branch, or of a branch and its border, which need not be moved: from fewer instants."""
    if border.periods != near.periods:
        return distance(border, near)
    free = border.word.impact_free or near.word.impact_free
    unit = border.model.natural_units(border.params)[0]
    return float(_largest(border.positions(INSTANTS) - near.positions(INSTANTS), free)) / unit


def distance(one: Solution, other: Solution, mirror: bool = False, instants: int = PER_PERIOD) -> float:
    """Largest difference in w at so many equal phases of each period, modulo whole periods, and the mirror image if asked for.

    In units of the machine's size. Where one of them hits no wall its mean position is free, and left out.
    """
    free = one.word.impact_free or other.word.impact_free
    unit = one.model.natural_units(one.params)[0]
    if one.periods == other.periods == 1 and not mirror:
        return float(_largest(one.positions(instants) - other.positions(instants), free)) / unit
    periods = math.lcm(one.periods, other.periods)
    here, there = (
        orbit.positions(instants)
        if orbit.periods == periods
        else np.tile(orbit.positions(instants), periods // orbit.periods)
        for orbit in (one, other)
    )
    images = [here]
    if mirror:
        images.append(2.0 * float(one.model.middle(one.params)) - np.roll(here, -instants // 2))
    best = np.inf
    turned = (instants * np.arange(one.periods)[:, None] + np.arange(0, len(here), COARSE)) % len(here)
    for image in images:
        rough = _largest(image[turned] - there[::COARSE], free)
        for shift in np.argsort(rough, kind="stable").tolist() if len(rough) > 1 else (0,):
            if rough[shift] >= best:
                break
            moved = np.roll(image, -instants * shift) if shift else image
            best = min(best, float(_largest(moved - there, free)))
    return best / unit


def _largest(gap: np.ndarray, free: bool) -> np.ndarray:
    return 0.5 * np.ptp(gap, axis=-1) if free else np.abs(gap).max(axis=-1)
