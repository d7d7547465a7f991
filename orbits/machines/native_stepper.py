"""The contract of :mod:`orbits.machines.stepping` fulfilled by the native core (`native/simulation.hpp`)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from contvines.core.library import NOTHING, NUMBER, POINTER, WHOLE, address, function, native
from orbits.machines.names import NATIVE
from orbits.machines.stepping import PAUSED, TURNS
from orbits.settings import STEPPING

if TYPE_CHECKING:
    from collections.abc import Callable

    from orbits.machines.reference.machine import Reference


def number(name: str) -> int | None:
    """The number of a machine in the native core; None if its reference computes."""
    return NATIVE.index(name) if native() and name in NATIVE else None


def floats(array: np.ndarray) -> np.ndarray:
    """An array that native code can read: C-contiguous, float64."""
    return np.ascontiguousarray(array, dtype=np.float64)


def bytes_of(array: np.ndarray) -> np.ndarray:
    """Codes or modes that native code can read."""
    return np.ascontiguousarray(array, dtype=np.int8)


def written(array: np.ndarray) -> int:
    """Address of an array that native code writes.

    Raises
    ------
    TypeError
        If it is not C-contiguous.
    """
    if not array.flags.c_contiguous:
        raise TypeError(f"an array with strides {array.strides} cannot be written by the native core")
    return address(array)


class NativeStepper:
    """Launch, advance, sample, works, shapes and energies of one machine.

    Parameters
    ----------
    machine : int
        Its number in the native core.
    """

    def __init__(self, machine: int) -> None:
        self.number = machine
        self._launch = function("simulation_launch", NOTHING, WHOLE, POINTER, POINTER)
        self._advance = function(
            "simulation_advance", WHOLE, WHOLE, POINTER, POINTER, NUMBER, POINTER, POINTER, POINTER, WHOLE
        )
        states = (WHOLE, WHOLE, POINTER, POINTER)
        self._shapes = function("simulation_shapes", NOTHING, *states, POINTER, POINTER)
        self._sample = function("simulation_sample", NOTHING, *states, POINTER, POINTER)
        self._works = function("simulation_works", NOTHING, *states, POINTER, POINTER)
        self._energies = function("simulation_energies", NOTHING, *states, POINTER)

    def launch(self, state: np.ndarray, params: np.ndarray) -> None:
        """Reduce the phase and set the mode of a start; contract, item 2."""
        params = floats(params)
        self._launch(self.number, written(state), address(params))

    def advance(
        self,
        state: np.ndarray,
        params: np.ndarray,
        until: float,
        codes: np.ndarray,
        modes: np.ndarray,
        rows: np.ndarray,
    ) -> tuple[int, int]:
        """Run from event to event; contract, item 3. Between slices of a long run an interrupt is seen."""
        params = floats(params)
        until = min(float(until), float(state[TURNS]) + STEPPING.forever)
        count, status, room = 0, PAUSED, len(codes)
        here, numbers = written(state), address(params)
        at_codes, at_modes, at_rows = written(codes), written(modes), written(rows)
        width = rows.itemsize * rows.shape[1]
        while status == PAUSED:
            made = self._advance(
                self.number,
                here,
                numbers,
                until,
                at_codes + count,
                at_modes + count,
                at_rows + count * width,
                room - count,
            )
            more, status = divmod(made, 8)
            count += more
        return count, status

    def sample(self, states: np.ndarray, params: np.ndarray, ahead: np.ndarray, out: np.ndarray) -> None:
        """w, w', v, v' at given phases after given states; contract, item 4."""
        self._each(self._sample, states, params, ahead, out)

    def works(self, states: np.ndarray, params: np.ndarray, ahead: np.ndarray, out: np.ndarray) -> None:
        """Works inside pieces of segments; contract, item 5."""
        self._each(self._works, states, params, ahead, out)

    def shapes(self, states: np.ndarray, params: np.ndarray, lengths: np.ndarray, out: np.ndarray) -> None:
        """See `orbits.machines.reference.motion.shapes`."""
        self._each(self._shapes, states, params, lengths, out)

    def energies(self, states: np.ndarray, params: np.ndarray, out: np.ndarray) -> None:
        """Energies of states; contract, item 5."""
        states, params = floats(states), floats(params)
        self._energies(self.number, len(states), address(states), address(params), written(out))

    def _each(
        self, work: Callable, states: np.ndarray, params: np.ndarray, ahead: np.ndarray, out: np.ndarray
    ) -> None:
        states, params, ahead = floats(states), floats(params), floats(ahead)
        work(self.number, len(states), address(states), address(params), address(ahead), written(out))


def stepper_functions(name: str) -> NativeStepper | Reference:
    """The functions of the contract for the machine called `name`: the native core's, or those of its reference in plain Python."""
    machine = number(name)
    if machine is not None:
        return NativeStepper(machine)
    from orbits.machines.reference.machine import reference

    return reference(name)
