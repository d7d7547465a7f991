"""Periodic motions of vibro-impact absorbers: words, impact maps, margins, simulation, theory."""

from __future__ import annotations

import importlib
from typing import Any

_PLACES = {
    "Absorber": "orbits.machines.absorber",
    "Cavity": "orbits.machines.cavity",
    "Coupled": "orbits.machines.coupled",
    "DryFriction": "orbits.contacts.dry_friction",
    "Machine": "orbits.machines.page.machine",
    "Scales": "orbits.design.scales",
    "Orbit": "orbits.orbit",
    "OrbitProblem": "orbits.problem",
    "ParameterError": "orbits.machines.parameters",
    "Switch": "orbits.contacts.switch",
    "Wall": "orbits.contacts.wall",
    "Word": "orbits.words",
    "coupled_two": "orbits.machines.coupled_two",
    "structure": "orbits.machines.structure.structure",
    "WordError": "orbits.words",
}
_ROOMS = ("attractors", "design", "machines", "multiple_scales", "simulation", "symbols", "theory", "words")
__all__ = sorted([*_PLACES, *_ROOMS])


def __getattr__(name: str) -> Any:
    if name in _PLACES:
        return getattr(importlib.import_module(_PLACES[name]), name)
    if name in _ROOMS:
        return importlib.import_module(f"orbits.{name}")
    from contvines.shared.near_names import did_you_mean

    raise AttributeError(f"orbits has no {name!r}{did_you_mean(name, __all__)}; it has {', '.join(__all__)}")


def __dir__() -> list[str]:
    return __all__
