"""Doors that lead up: what users ask of a thing, and what is built on it.

``machine.orbit(...)``, ``attractor.orbit``, ``orbit.problem()`` or ``orbit.plot()`` lead to rooms that know the thing, and that it
must not know. They are named here, resolved when a door is opened, and nowhere else does anything reach up.
"""

from __future__ import annotations

import importlib
from typing import Any

PLACES = {
    "Orbit": "orbits.orbit:Orbit",
    "OrbitProblem": "orbits.problem:OrbitProblem",
    "Population": "orbits.population:Population",
    "find": "orbits.starts.find:find",
    "of_branch": "orbits.proofs.subjects:of_branch",
    "of_orbit": "orbits.proofs.subjects:of_orbit",
    "of_point": "orbits.proofs.subjects:of_point",
    "portrait": "orbits.plots.portrait:portrait",
    "portrait_of_page": "orbits.plots.declared:portrait",
    "scene": "orbits.plots.scene:scene",
    "scene_of_page": "orbits.plots.declared:scene",
    "witness_of_page": "orbits.machines.declared.attractor:witness",
}


def above(name: str) -> Any:
    """The function or class behind a door."""
    module, _, place = PLACES[name].partition(":")
    return getattr(importlib.import_module(module), place)
