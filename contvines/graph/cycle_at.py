"""A small cycle near a Hopf point."""

from __future__ import annotations

import numpy as np

from ..bifurcation.switching import departures
from ..branches.special_point import SpecialPoint
from ..continuation.engine import Engine
from ..continuation.settings import Settings

HALVINGS = 4  # of the amplitude, until a cycle is found


def cycle_at(point: SpecialPoint) -> object:
    """One of the small cycles that are born at a Hopf point.

    Raises
    ------
    ValueError
        If the problem has no cycles, or none is found.
    """
    children = point.attached.offspring("hopf", point.u, point.value, point.tangent, 1j)
    settings = Settings()
    width = 1.0 + abs(point.value)
    for child in children:
        engine = Engine(child.problem, (point.value - width, point.value + width), settings)
        direction = engine.unit(np.asarray(child.tangent, dtype=float))
        amplitude = settings.amplitude
        for _ in range(HALVINGS):
            nothing = np.zeros(engine.n + 1)
            found = departures(engine, child.u, point.value, nothing, amplitude, True, [direction])
            if found:
                return child.problem.orbit(found[0].ahead.u, found[0].ahead.p)
            amplitude *= 0.5
    raise ValueError(
        f"{point.label}: no cycle is found there; only Hopf points of a contvines.FlowProblem have cycles"
    )
