"""Event-driven stepper of a cavity: `orbits.machines.cavity.simulation` with this machine's numbers (compiled).

The signatures are those of :mod:`orbits.machines.stepping`.
"""

from __future__ import annotations

from orbits.compiling import digits as _digits
from orbits.compiling.decorators import stored_with
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
SOURCES = (_numbers, _law, _legs, _motion, _simulation, _digits)


@stored_with(*SOURCES)
def launch(state, params):
    """Set the mode of a start; contract, item 2."""
    launch_with(law(params), state)


@stored_with(*SOURCES, nogil=True)
def advance(state, params, until, codes, modes, rows):
    """Run from event to event; contract, item 3."""
    return advance_with(law(params), state, until, codes, modes, rows)


@stored_with(*SOURCES, nogil=True)
def sample(states, params, ahead, out):
    """w, w', v, v' at given phases after given states; contract, item 4."""
    sample_with(law(params), states, ahead, out)


@stored_with(*SOURCES, nogil=True)
def works(states, params, ahead, out):
    """Work of the shaking, of the damper (none) and of friction inside pieces of segments; contract, item 5."""
    works_with(law(params), states, ahead, out)


@stored_with(*SOURCES, nogil=True)
def energies(states, params, out):
    """Energy that these works change; contract, item 5."""
    energies_with(law(params), states, out)
