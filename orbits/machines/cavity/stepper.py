"""Event-driven stepper of a cavity: `orbits.machines.cavity.simulation` with a machine's numbers (compiled).

The signatures are those of :mod:`orbits.machines.stepping`.
"""

from __future__ import annotations

from collections.abc import Callable
from types import ModuleType
from typing import Any

from orbits.compiling import digits as _digits
from orbits.compiling.decorators import digest_of, specialise
from orbits.machines.cavity import law as _law
from orbits.machines.cavity import legs as _legs
from orbits.machines.cavity import motion as _motion
from orbits.machines.cavity import numbers as _numbers
from orbits.machines.cavity import simulation as _simulation
from orbits.machines.cavity.legs import launch_with
from orbits.machines.cavity.motion import energies_with, sample_with, works_with
from orbits.machines.cavity.numbers import law
from orbits.machines.cavity.simulation import advance_with

STATE = 6
ROW = 5


def _launch(state, params):
    """Set the mode of a start; contract, item 2."""
    launch_with(law(params), state)


def _advance(state, params, until, codes, modes, rows):
    """Run from event to event; contract, item 3."""
    return advance_with(law(params), state, until, codes, modes, rows)


def _sample(states, params, ahead, out):
    """w, w', v, v' at given phases after given states; contract, item 4."""
    sample_with(law(params), states, ahead, out)


def _works(states, params, ahead, out):
    """Work of the shaking, of the damper (none) and of friction inside pieces of segments; contract, item 5."""
    works_with(law(params), states, ahead, out)


def _energies(states, params, out):
    """Energy that these works change; contract, item 5."""
    energies_with(law(params), states, out)


def stepper_with(law: Callable[..., Any], source: ModuleType) -> tuple[Any, Any, Any, Any, Any]:
    """The five functions of the contract for a machine whose equations of motion are a cavity's.

    Parameters
    ----------
    law : callable
        Compiled; the numbers of the equations of motion (`orbits.machines.cavity.law.Law`) from the parameters.
    source : module
        That defines it.

    Returns
    -------
    launch, advance, sample, works, energies
    """
    digest = digest_of(source, _law, _legs, _motion, _simulation, _digits)
    options = {"error_model": "numpy", "nogil": True}
    launch, advance, sample, works, energies = (
        specialise(function, digest, options=options, law=law)
        for function in (_launch, _advance, _sample, _works, _energies)
    )
    return launch, advance, sample, works, energies


launch, advance, sample, works, energies = stepper_with(law, _numbers)
