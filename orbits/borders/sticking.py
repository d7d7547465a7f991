"""The border between the stuck absorber and stick-slip, from both sides."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from orbits.borders.distance import CLOSE
from orbits.borders.holding import parameter_unit
from orbits.orbit import Orbit
from orbits.protocol import CycleProblem, Seed
from orbits.settings import BORDERING, REPLAYING
from orbits.starts.find import StartError, find

if TYPE_CHECKING:
    from orbits.protocol import BorderPoint


def from_rest(problem: CycleProblem, point: BorderPoint) -> list[Seed]:
    """The stick-slip motion just beyond the slip of a stuck one: closed form, or what the simulator finds."""
    p = float(point.value)
    for distance in BORDERING.slipping:
        for side in (1.0, -1.0):
            q = p + side * distance * parameter_unit(problem, p)
            if Orbit.at_rest(problem.model, problem.values(q)).real:
                continue
            values = problem.model.named(problem.values(q))
            try:
                orbit = find(problem.model, "ss", 1, None, values)
            except (StartError, ValueError):
                continue
            other = problem.sibling(orbit.word, orbit.periods, orbit.symmetric)
            u, q = other.reduce(orbit.nodes), other.value(orbit.params)
            length = orbit.model.natural_units(orbit.params)[0]
            if (
                orbit.real
                and np.ptp(orbit.sample()["w"]) < CLOSE * length
                and orbit.replay() < REPLAYING.followed
            ):
                sign = np.zeros(other.dimension + 1)
                sign[-1] = side
                note = "the stuck absorber begins to slip: persistence, the word becomes ss"
                return [Seed(other, u, q, sign, "border", note, True)]
    return []


def to_rest(problem: CycleProblem, point: BorderPoint) -> list[Seed]:
    """The stuck motion on the other side of the border at which stick-slip ends, if that is what ends there."""
    if not problem.model.in_cavity or sorted(problem.word.events) != ["s", "s", "u", "u"]:
        return []
    p = float(point.value)
    unit = parameter_unit(problem, p)
    for side in (-1.0, 1.0):
        q = p + side * BORDERING.away[-1] * unit
        orbit = Orbit.at_rest(problem.model, problem.values(q))
        beyond = Orbit.at_rest(problem.model, problem.values(p - side * BORDERING.away[-1] * unit))
        if orbit.margin > 0.0 >= beyond.margin:  # next to nothing reads as zero
            other = problem.sibling(orbit.word, 1, orbit.symmetric)
            direction = np.zeros(other.dimension + 1)
            direction[-1] = side
            note = "the slips vanish: persistence, the absorber is stuck"
            return [Seed(other, other.reduce(orbit.nodes), q, direction, "border", note, True)]
    return []
