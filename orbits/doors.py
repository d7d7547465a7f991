"""Doors that lead up: what users ask of a thing, and what is built on it.

``machine.orbit(...)``, ``attractor.orbit``, ``orbit.problem()`` or ``orbit.plot()`` lead to rooms that know the thing, and that it
must not know. They are named here, resolved when a door is opened, and nowhere else does anything reach up.
"""

from __future__ import annotations

import importlib
from typing import Any

PLACES = {
    "Orbit": "orbits.orbit",
    "OrbitProblem": "orbits.problem",
    "cross": "orbits.borders.crossing",
    "find": "orbits.starts.find",
    "of_branch": "orbits.proofs.subjects",
    "of_orbit": "orbits.proofs.subjects",
    "of_point": "orbits.proofs.subjects",
    "portrait": "orbits.plots.portrait",
    "scene": "orbits.plots.scene",
}


def above(name: str) -> Any:
    """The function or class behind a door."""
    return getattr(importlib.import_module(PLACES[name]), name)
