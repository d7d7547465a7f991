"""A forced machine whose frequency changes linearly: its phase becomes a function of time, and time one of its states."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import fields, replace
from typing import TYPE_CHECKING

import numpy as np

from orbits.machines.page.machine import Machine
from orbits.machines.page.page import Named, PageError, States
from orbits.machines.page.patterns import Contact

if TYPE_CHECKING:
    from orbits.symbols import Symbol

CLOCK = "run_up_time"
"""Name of the additional state: time, in seconds if the machine has units."""


def run_up(machine: Machine, params: np.ndarray, begin: float, time: float) -> Machine:
    """Return the machine while its frequency goes from `begin` to its own value, with phi'' constant; it is self-excited, with time as a state.

    Parameters
    ----------
    machine : Machine
        A forced machine.
    params : float array (P,)
    begin : float
        The frequency at the start, in the unit of the machine's own.
    time : float
        Duration of the run-up.

    Raises
    ------
    PageError
        If the machine is not forced, or time or frequency are impossible.
    """
    name = machine.phase_rate
    if name is None:
        raise PageError(f"{machine.name!r} is not forced: it has no frequency that could run up")
    if not (time > 0.0 and np.isfinite(time) and begin >= 0.0):
        raise PageError(
            f"a run-up from {begin:g} in {time:g}: expected a frequency of 0 or above and a time above 0"
        )
    last = float(machine.phase_speed(params))
    first = begin * machine.equations.factors.get(name, 1.0)
    count = len(machine.states)

    def wrapped(function: Callable) -> Callable:
        """Return a function of the machine file with phase and frequency at the time in the state."""
        if not callable(function):
            return function

        def formula(state: States, phase: Symbol, p: Named, *contact: Named) -> Symbol:
            clock = state[count]
            frequency = first + (last - first) / time * clock
            values = {key: value for key, value in vars(p).items() if key != "_what"} | {name: frequency}
            turned = (first + 0.5 * (last - first) / time * clock) * clock
            return function(States(machine.states, state[:count]), turned, Named("p", values), *contact)

        return formula

    motion: Callable = wrapped(machine.equations.formulas_of_motion)
    energy = machine.energy
    return Machine(
        name=f"{machine.name}_running_up",
        states=(*machine.states, CLOCK),
        parameters=machine.named(params),
        motion=lambda state, phase, p, contact: (*motion(state, phase, p, contact), 1.0),
        contacts=[_contact(contact, wrapped) for contact in machine.contacts],
        units=machine.given_units,
        energy=None if energy is None else wrapped(energy),
    )


def _contact(contact: Contact, wrapped: Callable) -> Contact:
    """Return the same contact with its functions wrapped, including those of a push."""
    parts = {part.name: getattr(contact, part.name) for part in fields(contact)}
    return replace(
        contact,
        **{
            name: {key: wrapped(one) for key, one in part.items()}
            if isinstance(part, Mapping)
            else wrapped(part)
            for name, part in parts.items()
        },
    )


def phase_at_end(machine: Machine, params: np.ndarray, begin: float, time: float) -> float:
    """Return the phase at the end of a run-up: the mean frequency times the time."""
    assert machine.phase_rate is not None
    first = begin * machine.equations.factors.get(machine.phase_rate, 1.0)
    return 0.5 * (first + float(machine.phase_speed(params))) * time
