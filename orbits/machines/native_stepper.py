"""The stepper of :mod:`orbits.machines.stepping` in the native core (`native/simulation.hpp`)."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

from contvines.core.library import NOTHING, NUMBER, POINTER, WHOLE, address, function, native
from orbits.machines.names import NATIVE, model_class
from orbits.machines.stepping import PAUSED, TURNS, Stepper
from orbits.settings import STEPPING


def number(name: str) -> int | None:
    """Return the number of a machine in the native core; None if its reference is used."""
    return NATIVE.index(name) if native() and name in NATIVE else None


def floats(array: np.ndarray) -> np.ndarray:
    """Return an array that native code can read: C-contiguous, float64."""
    return np.ascontiguousarray(array, dtype=np.float64)


def bytes_of(array: np.ndarray) -> np.ndarray:
    """Return codes or modes as native code can read them."""
    return np.ascontiguousarray(array, dtype=np.int8)


def written(array: np.ndarray) -> int:
    """Return the address of an array that native code writes.

    Raises
    ------
    TypeError
        If it is not C-contiguous.
    """
    if not array.flags.c_contiguous:
        raise TypeError(f"an array with strides {array.strides} cannot be written by the native core")
    return address(array)


class NativeStepper(Stepper):
    """The stepper in the native core; `number` is the machine's number there."""

    def __init__(self, name: str, number: int) -> None:
        self._model = model_class(name)
        super().__init__(name, self._model.moving_cavity)
        self.number = number
        self._launch = function("simulation_launch", NOTHING, WHOLE, POINTER, POINTER)
        self._advance = function(
            "simulation_advance", WHOLE, WHOLE, POINTER, POINTER, NUMBER, POINTER, POINTER, POINTER, WHOLE
        )
        states = (WHOLE, WHOLE, POINTER, POINTER)
        self._shapes = function("simulation_shapes", NOTHING, *states, POINTER, POINTER)
        self._sample = function("simulation_sample", NOTHING, *states, POINTER, POINTER)
        self._works = function("simulation_works", NOTHING, *states, POINTER, POINTER)
        self._energies = function("simulation_energies", NOTHING, *states, POINTER)
        self._states = function(
            "simulation_states", NOTHING, WHOLE, POINTER, WHOLE, POINTER, POINTER, POINTER, NUMBER, NUMBER, POINTER
        )  # fmt: skip

    def __reduce__(self) -> tuple[Any, ...]:
        return stepper, (self.name,)

    def walls(self, params: np.ndarray) -> tuple[Any, Any]:
        return self._model.walls(params)

    def launch(self, state: np.ndarray, params: np.ndarray) -> None:
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
        """Move from event to event; item 3 of `orbits.machines.stepping`. Interrupts take effect between slices of a long run."""
        params = floats(params)
        until = min(float(until), float(state[TURNS]) + STEPPING.forever)
        count, status, room = 0, PAUSED, len(codes)
        place, numbers = written(state), address(params)
        at_codes, at_modes, at_rows = written(codes), written(modes), written(rows)
        width = rows.itemsize * rows.shape[1]
        while status == PAUSED:
            places = at_codes + count, at_modes + count, at_rows + count * width
            packed = self._advance(self.number, place, numbers, until, *places, room - count)
            more, status = divmod(packed, 8)
            count += more
        return count, status

    def sample(self, states: np.ndarray, params: np.ndarray, ahead: np.ndarray, out: np.ndarray) -> None:
        self._each(self._sample, states, params, ahead, out)

    def works(self, states: np.ndarray, params: np.ndarray, ahead: np.ndarray, out: np.ndarray) -> None:
        self._each(self._works, states, params, ahead, out)

    def shapes(self, states: np.ndarray, params: np.ndarray, ahead: np.ndarray, out: np.ndarray) -> None:
        self._each(self._shapes, states, params, ahead, out)

    def energies(self, states: np.ndarray, params: np.ndarray, out: np.ndarray) -> None:
        states, params = floats(states), floats(params)
        self._energies(self.number, len(states), address(states), address(params), written(out))

    def _each(
        self, work: Callable, states: np.ndarray, params: np.ndarray, ahead: np.ndarray, out: np.ndarray
    ) -> None:
        states, params, ahead = floats(states), floats(params), floats(ahead)
        work(self.number, len(states), address(states), address(params), address(ahead), written(out))

    def states_of(
        self, params: np.ndarray, codes: np.ndarray, modes: np.ndarray, nodes: np.ndarray
    ) -> np.ndarray:
        states = np.zeros((len(nodes), self.state))
        codes, modes, nodes, params = bytes_of(codes), bytes_of(modes), floats(nodes), floats(params)
        events = address(codes), address(modes), address(nodes)
        self._states(self.number, address(params), len(nodes), *events, *self.walls(params), address(states))
        return states


@cache
def stepper(name: str) -> Stepper:
    """Return the stepper of the machine called `name`: in the native core, or its reference in plain Python."""
    machine = number(name)
    if machine is not None:
        return NativeStepper(name, machine)
    from orbits.machines.reference.machine import reference

    return reference(name)
