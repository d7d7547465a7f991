"""Names of the machines in studies."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING

from contvines.shared.near_names import did_you_mean
from orbits.machines.parameters import ParameterError

if TYPE_CHECKING:
    from orbits.machines.base import Model
    from orbits.machines.varying import Varying

PLACES = {
    "absorber": ("orbits.machines.absorber", "Absorber"),
    "cavity": ("orbits.machines.cavity", "Cavity"),
    "coupled": ("orbits.machines.coupled", "Coupled"),
}
"""Module and class of each machine."""
NAMES = tuple(PLACES)
NATIVE = ("absorber", "cavity", "coupled")
"""Machines of the native core, in the order of native/machines.hpp; others use their reference."""
STRUCTURE = "structure"
"""Name in studies of a machine given by matrices (`orbits.machines.structure`)."""
PAGES = {"coupled_two": "orbits.machines.coupled_two"}
"""Declared machines of the package: name of the machine, and the module that holds it under this name."""


def model_class(name: str) -> type[Model]:
    """Return the class of the machine called `name` in studies.

    Raises
    ------
    ParameterError
        If there is no machine of this name.
    """
    if name not in PLACES:
        names = (*NAMES, *PAGES)
        raise ParameterError(
            f"name = {name!r}: there is no such machine{did_you_mean(name, names)}; choose one of {', '.join(names)}"
        )
    module, place = PLACES[name]
    return getattr(importlib.import_module(module), place)


def page_machine(name: str) -> Varying:
    """Return the machine of `PAGES` called `name`."""
    return getattr(importlib.import_module(PAGES[name]), name)


def usual(name: str) -> tuple[Model, dict[str, float]]:
    """Return a machine with usual values, and values of the parameters that belong to each orbit."""
    chosen = model_class(name)
    values = {entry.name: entry.example for entry in chosen.table}
    fields = {key: values.pop(key) for key in chosen.field_names() if key in values}
    return chosen(**fields), values
