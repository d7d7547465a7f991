"""Periodic motions of vibro-impact absorbers: words, impact maps, margins, simulation, theory."""

from __future__ import annotations

import importlib
from typing import Any

_PLACES = {
    "Absorber": "orbits.models.absorber",
    "Coupled": "orbits.models.coupled",
    "Scales": "orbits.models.scales",
    "Orbit": "orbits.orbit",
    "OrbitProblem": "orbits.problem",
    "ParameterError": "orbits.models.base",
    "Word": "orbits.words",
    "WordError": "orbits.words",
}
__all__ = sorted(_PLACES)


def __getattr__(name: str) -> Any:
    if name in _PLACES:
        return getattr(importlib.import_module(_PLACES[name]), name)
    raise AttributeError(f"module 'orbits' has no attribute {name!r}")


def __dir__() -> list[str]:
    return __all__
