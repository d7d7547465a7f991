"""The machines by the names that studies use."""

from __future__ import annotations

import copyreg
import importlib
from functools import cache
from typing import TYPE_CHECKING

from contvines.shared.near_names import did_you_mean
from orbits.machines.base import Model
from orbits.machines.names import NAMES, PAGES, PLACES
from orbits.machines.native_stepper import stepper_functions
from orbits.machines.parameters import ParameterError
from orbits.machines.stepping import Machine
from orbits.machines.varying import Varying

if TYPE_CHECKING:
    from collections.abc import Callable

    from orbits.machines.native_stepper import NativeStepper
    from orbits.machines.reference.machine import Reference


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
    own = chosen.field_names()
    settings = {entry.name: entry.example for entry in chosen.table if entry.name in own}
    given = {entry.name: entry.example for entry in chosen.table if entry.name not in own}
    return chosen(**settings), given


@cache
def stepper(name: str) -> Machine:
    """The stepper of the model called `name`; see :mod:`orbits.machines.stepping`."""
    return _machine(name, stepper_functions(name))


def reference_stepper(name: str) -> Machine:
    """The same in plain Python, which the native core is compared with."""
    from orbits.machines.reference.machine import reference

    return _machine(name, reference(name))


def _machine(name: str, functions: NativeStepper | Reference) -> Machine:
    chosen = model_class(name)
    moving = chosen.moving_cavity
    return Machine(
        name,
        8 if moving else 6,
        7 if moving else 5,
        functions.launch,
        functions.advance,
        functions.sample,
        functions.works,
        functions.energies,
        chosen.walls,
        moving,
    )


def _by_name(machine: Machine) -> tuple[Callable[[str], Machine], tuple[str]]:
    return stepper, (machine.name,)


copyreg.pickle(Machine, _by_name)  # its functions are looked up again
