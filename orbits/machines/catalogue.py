"""The machines by the names that studies use: a line each."""

from __future__ import annotations

import copyreg
import importlib
from functools import cache
from typing import Any

from contvines.shared.near_names import did_you_mean
from orbits.machines.base import Model
from orbits.machines.native_stepper import stepper_functions
from orbits.machines.parameters import ParameterError
from orbits.machines.stepping import Machine

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
        raise ParameterError(
            f"model name = {name!r} is unknown{did_you_mean(name, NAMES)}; choose one of {', '.join(NAMES)}"
        )
    module, place = PLACES[name]
    return getattr(importlib.import_module(module), place)


def usual(name: str) -> tuple[Model, dict[str, float]]:
    """A machine with usual values, and those of the parameters that are given with each orbit."""
    chosen = model_class(name)
    own = chosen.field_names()
    settings = {entry.name: entry.example for entry in chosen.table if entry.name in own}
    given = {entry.name: entry.example for entry in chosen.table if entry.name not in own}
    return chosen(**settings), given


@cache
def stepper(name: str) -> Machine:
    """The stepper of the model called `name`; see :mod:`orbits.machines.stepping`."""
    reference = model_class(name).stepper()
    return _machine(name, reference, stepper_functions(name, reference))


def reference_stepper(name: str) -> Machine:
    """The same in plain Python, which the native core is compared with."""
    reference = model_class(name).stepper()
    return _machine(name, reference, reference)


def _machine(name: str, reference: Any, functions: Any) -> Machine:
    chosen = model_class(name)
    return Machine(
        name,
        reference.STATE,
        reference.ROW,
        functions.launch,
        functions.advance,
        functions.sample,
        functions.works,
        functions.energies,
        chosen.walls,
        chosen.moving_cavity,
    )


def _by_name(machine: Machine) -> tuple[Any, tuple[str]]:
    return stepper, (machine.name,)


copyreg.pickle(Machine, _by_name)  # its functions are looked up again
