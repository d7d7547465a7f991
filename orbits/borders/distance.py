"""Two orbits as motions, whatever their words say: what no impulse moves, at equal phases of the forcing."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from orbits.orbit import Orbit
from orbits.settings import BORDERING

PER_PERIOD = 200  # instants of a forcing period at which motions are compared
CLOSE = 0.05  # largest difference in position between a border orbit and one that goes on from it, wherever that is measured
SHRINKS = 0.5  # by at least this factor a distance that tends to zero falls on the way to the border

COARSE = 10  # every so many instants are compared first
INSTANTS = (
    PER_PERIOD // 5
)  # of a period by which motions near a border are compared, where they differ all along


def tends(close: float, further: Callable[[], float]) -> bool:
    """Whether an orbit tends to a border orbit, from its distance measured twice: the larger one, of the same orbit further away, is asked for
    where it matters. An orbit that is only similar keeps its distance.
    """
    return close < BORDERING.together or (close < CLOSE and close < SHRINKS * further())


def gap(border: Orbit, near: Orbit) -> float:
    """The distance of orbits of one branch, or of a branch and its border, which need not be moved: from fewer instants."""
    if border.periods != near.periods or not border.forced:
        return distance(border, near)
    unit = border.model.natural_units(border.params)[0]
    apart = border.positions(INSTANTS) - near.positions(INSTANTS)
    return float(_largest(apart, _free(border, near))) / unit


def distance(one: Orbit, other: Orbit, mirror: bool = False, instants: int = PER_PERIOD) -> float:
    """Largest difference of positions at so many equal phases of each period, modulo whole periods, and the mirror image if asked for.

    In units of the machine's size. Where one of them may be shifted as a whole (it hits no wall) its mean position is free, and left out.
    Of self-excited motions, which have no phase in common: of periods and extremes, relative to 1 + these.
    """
    if not one.forced:
        images = [one, one.mirror()] if mirror else [one]
        return min(_unlike(image, other) for image in images)
    free = _free(one, other)
    unit = one.model.natural_units(one.params)[0]
    if one.periods == other.periods == 1 and not mirror:
        return float(_largest(one.positions(instants) - other.positions(instants), free)) / unit
    periods = math.lcm(one.periods, other.periods)
    here, there = (
        orbit.positions(instants)
        if orbit.periods == periods
        else np.tile(orbit.positions(instants), (periods // orbit.periods, 1))
        for orbit in (one, other)
    )
    images = [here]
    if mirror:
        images.append(2.0 * float(one.model.middle(one.params)) - np.roll(here, -instants // 2, axis=0))
    best = np.inf
    turned = (instants * np.arange(one.periods)[:, None] + np.arange(0, len(here), COARSE)) % len(here)
    for image in images:
        rough = _largest(image[turned] - there[::COARSE], free)
        for shift in np.argsort(rough, kind="stable").tolist() if len(rough) > 1 else (0,):
            if rough[shift] >= best:
                break
            moved = np.roll(image, -instants * shift, axis=0) if shift else image
            best = min(best, float(_largest(moved - there, free)))
    return best / unit


def _free(one: Orbit, other: Orbit) -> np.ndarray:
    """Which positions may be shifted as a whole."""
    loose = {*one.flow.loose(one.model, one.word), *other.flow.loose(other.model, other.word)}
    return np.array([entry in loose for entry in one.flow.position_entries(one.model)])


def _largest(gap: np.ndarray, free: np.ndarray) -> np.ndarray:
    """Largest entry of a gap (..., instants, c); of those that are free half their range counts."""
    if not free.any():
        return np.abs(gap).max(axis=(-2, -1))
    return np.where(free, 0.5 * np.ptp(gap, axis=-2), np.abs(gap).max(axis=-2)).max(axis=-1)


def _unlike(one: Orbit, other: Orbit) -> float:
    """How much periods and extremes (of positions that may be shifted: how far they go) differ."""
    names = [f"{side}_{state}" for state in one.model.node_names[1:] for side in ("max", "min")]
    free = {
        one.model.node_names[entry]
        for entry in (*one.flow.loose(one.model, one.word), *other.flow.loose(other.model, other.word))
    }
    rows = []
    for orbit in (one, other):
        found = orbit.measures(*names, "period")
        for state in free:
            found[f"max_{state}"] -= found[f"min_{state}"]
            found[f"min_{state}"] = 0.0
        rows.append(np.array(list(found.values())))
    a, b = rows
    return float(np.abs(a - b).max() / (1.0 + np.abs(a).max()))
