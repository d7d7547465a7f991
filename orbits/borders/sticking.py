"""The border between the stuck absorber and stick-slip, from both sides."""

from __future__ import annotations

from typing import Any

import numpy as np

from orbits.borders.distance import CLOSE
from orbits.problem import OrbitProblem
from orbits.protocol import Seed

FOLLOWED = 1e-6  # largest replay error of a seed


def from_rest(problem: Any, point: Any) -> list[Seed]:
    """The stick-slip motion just beyond the slip of a stuck one: closed form, or what the simulator finds."""
    from orbits.starts.find import StartError, find

    p = float(point.value)
    for distance in (1e-4, 1e-3):
        for side in (1.0, -1.0):
            q = p * (1.0 + side * distance)
            if problem.orbit(problem_response(problem, q), q).real:
                continue
            values = dict(
                zip(problem.model.parameter_names, (float(x) for x in problem.values(q)), strict=True)
            )
            try:
                orbit = find(problem.model, "ss", 1, None, values)
            except (StartError, ValueError):
                continue
            other = orbit.problem(problem.parameter)
            u, q = orbit.seed(other)
            if orbit.real and np.ptp(orbit.sample()["w"]) < CLOSE and orbit.replay() < FOLLOWED:
                sign = np.zeros(other.dimension + 1)
                sign[-1] = side
                note = "the stuck absorber begins to slip: persistence, the word becomes ss"
                return [Seed(other, u, q, sign, "border", note, True)]
    return []


def problem_response(problem: Any, p: float) -> np.ndarray:
    """Unknowns of the stuck motion at parameter value `p`."""
    return np.linalg.solve(*problem.model.rest.equations(problem.values(p)))


def to_rest(problem: OrbitProblem, point: Any) -> list[Seed]:
    """The stuck motion on the other side of the border at which stick-slip ends, if that is what ends there."""
    from orbits.cycles.stuck import StuckOrbit

    if sorted(problem.word.events) != ["s", "s", "u", "u"]:
        return []
    p = float(point.value)
    for side in (-1.0, 1.0):
        q = p * (1.0 + side * 1e-7)
        orbit = StuckOrbit.of(problem.model, problem.values(q))
        beyond = StuckOrbit.of(problem.model, problem.values(p * (1.0 - side * 1e-7)))
        if orbit.margin > 0.0 > beyond.margin:
            other = orbit.problem(problem.parameter)
            direction = np.zeros(other.dimension + 1)
            direction[-1] = side
            note = "the slips vanish: persistence, the absorber is stuck"
            return [Seed(other, orbit.u, q, direction, "border", note, True)]  # type: ignore[arg-type]
    return []
