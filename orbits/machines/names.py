"""The machines by the names that studies use."""

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
"""Machines of the native core, in the order of native/machines.hpp; others compute with their reference."""
STRUCTURE = "structure"
"""What studies call a machine of matrices (`orbits.machines.structure`)."""
PAGES = {"coupled_two": "orbits.machines.coupled_two"}
"""Machines that come with the package, whose flow is integrated; the module holds the machine by its name."""


def model_class(name: str) -> type[Model]:
    """The machine called `name` in studies.

    Raises
    ------
    ParameterError
        If there is none.
    """
    if name not in PLACES:
        known = (*NAMES, *PAGES)
        raise ParameterError(
            f"name = {name!r}: there is no such machine{did_you_mean(name, known)}; choose one of {', '.join(known)}"
        )
    module, place = PLACES[name]
    return getattr(importlib.import_module(module), place)


def page_machine(name: str) -> Varying:
    """The machine of `PAGES` called `name`."""
    return getattr(importlib.import_module(PAGES[name]), name)


def usual(name: str) -> tuple[Model, dict[str, float]]:
    """A machine with usual values, and those of the parameters that are given with each orbit."""
    chosen = model_class(name)
    values = {entry.name: entry.example for entry in chosen.table}
    own = {key: values.pop(key) for key in chosen.field_names() if key in values}
    return chosen(**own), values
