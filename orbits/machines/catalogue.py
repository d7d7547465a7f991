"""The machines by the names that studies use: a line each."""

from __future__ import annotations

import importlib
from collections.abc import Mapping
from typing import Any

from orbits.machines.base import Model
from orbits.machines.parameters import ParameterError

PLACES = {
    "absorber": ("orbits.machines.absorber.machine", "Absorber"),
    "cavity": ("orbits.machines.cavity.machine", "Cavity"),
    "coupled": ("orbits.machines.coupled.machine", "Coupled"),
}
"""Module and class of each machine."""
NAMES = tuple(PLACES)


def model_class(name: str) -> type[Model]:
    """The machine called `name` in studies.

    Raises
    ------
    ParameterError
        If there is none.
    """
    if name not in PLACES:
        raise ParameterError(f"model name = {name!r} is unknown; choose one of {', '.join(NAMES)}")
    module, place = PLACES[name]
    return getattr(importlib.import_module(module), place)


def build(settings: Mapping[str, Any]) -> Model:
    """The machine with these settings, `name` among them (see `Model.settings`)."""
    values = dict(settings)
    if values.pop("units", None):
        from orbits.machines.physical import physical

        return physical(str(values.pop("name")), values, bool(values.pop("unusual", False)))
    return model_class(str(values.pop("name")))(**values)


def usual(name: str) -> tuple[Model, dict[str, float]]:
    """A machine with usual values, and those of the parameters that are given with each orbit."""
    chosen = model_class(name)
    own = chosen.field_names()
    settings = {entry.name: entry.example for entry in chosen.table if entry.name in own}
    given = {entry.name: entry.example for entry in chosen.table if entry.name not in own}
    return chosen(**settings), given
