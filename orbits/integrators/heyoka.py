"""Integration of declared machines by heyoka's compiled Taylor integrators; the only file that imports heyoka.

heyoka finds all roots inside a step from the Taylor polynomials of the functions (Biscani, Izzo, MNRAS 504 (2021) 2614), so that no
double crossing is missed. A flight takes one to three steps: batch integrators save no time there, and are used only for flights with
derivatives.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from functools import cache, cached_property
from importlib import import_module
from typing import TYPE_CHECKING, Any

import numpy as np

from orbits.arguments import COMPLEX_STEP
from orbits.integrators import expressions
from orbits.integrators.expressions import Layout, in_order, rebuilt, variables_of
from orbits.integrators.protocol import Crossing
from orbits.symbols import Symbol

if TYPE_CHECKING:
    from types import ModuleType

LANES = 4  # flights that are integrated together
FEW = 2  # largest number of points for which plain Python is faster than a call of compiled code


@cache
def _heyoka() -> ModuleType:
    heyoka = import_module("heyoka")
    heyoka.set_logger_level_error()  # a divergent flow is reported by the return value
    return heyoka


def lowered(layout: Layout, values: Sequence[Symbol]) -> list[Any]:
    """Return heyoka's expressions, with its time and runtime parameters in place of the clock and the numbers."""
    heyoka = _heyoka()
    names = {name: heyoka.par[i] for i, name in enumerate(layout.numbers)} | {layout.clock: heyoka.time}
    expressions: dict[int, Any] = {}
    for node in in_order(values):
        if node.operation == "variable":
            expressions[id(node)] = names.get(node.operands[0]) or heyoka.expression(node.operands[0])
        elif node.operation == "number":
            expressions[id(node)] = heyoka.expression(node.operands[0])
        else:
            parts = [expressions[id(x)] for x in node.operands]
            expressions[id(node)] = (
                rebuilt(node, parts) if len(parts) == 2 else getattr(heyoka, node.operation)(*parts)
            )
    return [expressions[id(value)] for value in values]


def _variables(layout: Layout) -> list[Any]:
    return [_heyoka().expression(name) for name in layout.states]


class Values(expressions.Values):
    """Functions of states, clock and numbers, compiled for many points at once."""

    @cached_property
    def _compiled(self) -> Any:
        return _heyoka().cfunc(lowered(self.layout, self.values), vars=_variables(self.layout))

    def __call__(self, states: np.ndarray, clock: np.ndarray, numbers: np.ndarray) -> np.ndarray:
        """Return values, shape (m, count), at `states` (m, n), `clock` (m,), `numbers` (m, P)."""
        if len(states) <= FEW:
            return np.array([self.one(*row) for row in zip(states, clock, numbers)])
        out = np.empty((self.count, len(states)))
        self._compiled(
            np.ascontiguousarray(states.T),
            pars=np.ascontiguousarray(numbers.T[: int(self._compiled.nparams)]),
            time=np.ascontiguousarray(clock),
            outputs=out,
        )
        return out.T


class _Variations(ABC):
    """A flow with its derivatives by the initial state and by some of the numbers.

    Parameters
    ----------
    layout : Layout
    rates : sequence of Symbol
        Derivatives of the states by the clock.
    active : tuple of int
        Indices of the numbers by which to differentiate.
    """

    def __init__(self, layout: Layout, rates: Sequence[Symbol], active: tuple[int, ...]) -> None:
        heyoka, variables = _heyoka(), _variables(layout)
        arguments = variables + [heyoka.par[i] for i in active]
        system = heyoka.var_ode_sys(list(zip(variables, lowered(layout, rates))), arguments, order=1)
        self.n = n = len(variables)
        self._begin = np.concatenate([np.zeros(n), np.eye(n, n + len(active)).ravel()])
        self._integrator = self._build(system, {"compact_mode": len(system.sys) >= MANY})
        self._numbers = len(self._integrator.pars)
        self._done = heyoka.taylor_outcome.time_limit

    @abstractmethod
    def _build(self, system: Any, options: dict[str, bool]) -> Any: ...


class Flight(_Variations):
    """A flow with its derivatives, one flight at a time."""

    def _build(self, system: Any, options: dict[str, bool]) -> Any:
        return _heyoka().taylor_adaptive(system, [0.0] * self.n, **options)

    def __call__(
        self, state: np.ndarray, begin: float, end: float, numbers: np.ndarray, out: np.ndarray
    ) -> bool:
        """Write the final state and its derivatives, (n + n (n + active),), row by row; return False if the flow diverges."""
        ta = self._integrator
        ta.time = begin
        ta.state[:] = self._begin
        ta.state[: self.n] = state
        ta.pars[:] = numbers[: self._numbers]
        outcome = ta.propagate_until(end, max_steps=MOST_STEPS)[0]
        out[:] = ta.state
        return outcome == self._done


class Flights(_Variations):
    """A flow with its derivatives, `LANES` flights at a time in the processor's vectors; each flight has its own steps."""

    def _build(self, system: Any, options: dict[str, bool]) -> Any:
        return _heyoka().taylor_adaptive_batch(system.sys, np.tile(self._begin[:, None], LANES), **options)

    def __call__(
        self, states: np.ndarray, begin: np.ndarray, end: np.ndarray, numbers: np.ndarray, out: np.ndarray
    ) -> bool:
        """Write a row per flight, as `Flight` does: states (m, n), begin and end (m,), numbers (m, P); return False if one diverges."""
        ta, count = self._integrator, len(states)
        for first in range(0, count, LANES):
            lanes = np.minimum(
                np.arange(first, first + LANES), count - 1
            )  # repeat the last flight in unused lanes
            ta.set_time(begin[lanes])
            ta.state[:] = self._begin[:, None]
            ta.state[: self.n] = states[lanes].T
            ta.pars[:] = numbers[lanes, : self._numbers].T
            ta.propagate_until(end[lanes], max_steps=MOST_STEPS)
            if any(result[0] != self._done for result in ta.propagate_res):
                return False
            out[first : first + LANES] = ta.state.T[: count - first]
        return True


class _Events(ABC):
    """A flow with functions whose zeros are events of heyoka's integrator.

    The functions are shifted by a tiny constant: heyoka 7.13 misses later roots in a step that begins exactly on a root.
    """

    kind: str  # `t_events` end a flight, `nt_events` do not

    def __init__(self, layout: Layout, rates: Sequence[Symbol], functions: Sequence[Symbol]) -> None:
        heyoka = _heyoka()
        system = list(zip(_variables(layout), lowered(layout, rates)))
        self._places = [i for i, f in enumerate(functions) if variables_of(f)]
        found = lowered(layout, [functions[i] for i in self._places])
        events = [self._event(i, f + COMPLEX_STEP) for i, f in zip(self._places, found)]
        self._integrator = heyoka.taylor_adaptive(
            system, [0.0] * len(system), compact_mode=len(system) >= LARGE, **{self.kind: events}
        )
        self._state, self._pars = (
            self._integrator.state,
            self._integrator.pars,
        )  # views of the integrator's arrays
        self._numbers = len(self._pars)
        self._done, self._stopped = heyoka.taylor_outcome.time_limit, heyoka.taylor_outcome.step_limit

    @abstractmethod
    def _event(self, place: int, function: Any) -> Any: ...

    def _put(self, state: np.ndarray, clock: float, numbers: np.ndarray) -> Any:
        """Return the integrator, set to a state."""
        ta = self._integrator
        ta.time = clock
        self._state[:] = state
        self._pars[:] = numbers[: self._numbers]
        return ta


class Watch(_Events):
    """A flow that reports every rise of given functions through zero."""

    kind = "nt_events"

    def __init__(self, layout: Layout, rates: Sequence[Symbol], functions: Sequence[Symbol]) -> None:
        self._found: list[Crossing] = []
        super().__init__(layout, rates, functions)

    def _event(self, place: int, function: Any) -> Any:
        heyoka, found = _heyoka(), self._found

        def note(ta: Any, clock: float, sign: int) -> None:
            ta.update_d_output(clock)
            found.append((clock, place, ta.d_output.copy()))

        return heyoka.nt_event(function, note, direction=heyoka.event_direction.positive)

    def __call__(self, state: np.ndarray, begin: float, end: float, numbers: np.ndarray) -> list[Crossing]:
        """Return (clock, index of the function, state) of every rise through zero between `begin` and `end`."""
        self._found.clear()
        self._put(state, begin, numbers).propagate_until(end, max_steps=MOST_STEPS)
        return list(self._found)

    def move(self, state: np.ndarray, begin: float, end: float, numbers: np.ndarray) -> None:
        """Move `state` on, in place, without regard to the functions."""
        self(state, begin, end, numbers)
        state[:] = self._state

    @property
    def final(self) -> np.ndarray:
        """The state at the end of the last flight."""
        return np.array(self._state)

    def path(self, state: np.ndarray, clocks: np.ndarray, numbers: np.ndarray) -> np.ndarray:
        """Return states, shape (m, n), at the increasing `clocks` (equal ones allowed); `state` is that at the first clock."""
        ta = self._put(state, float(clocks[0]), numbers)
        grid, back = np.unique(np.maximum.accumulate(clocks), return_inverse=True)
        if len(grid) == 1:
            return np.tile(state, (len(clocks), 1))
        rows = np.full((len(grid), len(state)), np.nan)
        done, ahead = 0, grid
        while done < len(grid):
            before = ta.time
            found = np.asarray(ta.propagate_grid(ahead, max_steps=MOST_STEPS)[-1])
            new = found[len(ahead) - (len(grid) - done) :]
            rows[done : done + len(new)] = new
            done += len(new)
            if ta.time - before < RUNAWAY:
                break
            ahead = np.concatenate([[ta.time], grid[done:]])
        return rows[back]


class Run(_Events):
    """A flow that ends at the first fall of one of its functions through zero."""

    kind = "t_events"

    def _event(self, place: int, function: Any) -> Any:
        heyoka = _heyoka()
        return heyoka.t_event(function, direction=heyoka.event_direction.negative)

    def __call__(
        self, state: np.ndarray, begin: float, end: float, numbers: np.ndarray
    ) -> tuple[float, int | None]:
        """Move `state` on, in place.

        Returns
        -------
        clock : float
        place : int or None
            Index of the function that ended the flight; None if the end was reached, -1 if the flow diverged.
        """
        ta = self._put(state, begin, numbers)
        if self._places:
            ta.reset_cooldowns()
        while True:
            before = ta.time
            outcome = ta.propagate_until(end, max_steps=MOST_STEPS)[0]
            if outcome != self._stopped or ta.time - before < RUNAWAY:
                break
        state[:] = self._state
        if outcome == self._done:
            return end, None
        code = -int(outcome.value) - 1
        if 0 <= code < len(self._places):
            return float(ta.time), self._places[code]
        return float(ta.time), -1


MOST_STEPS = 100_000  # largest number of steps of one flight; a flow that needs more diverges,
RUNAWAY = (
    1.0  # or, in a run to its next event, a flow that advances the clock by less than this in as many steps
)
LARGE = 12  # number of states from which compact code compiles much faster and runs nearly as fast
MANY = 40  # the same for equations of states with derivatives: six states compile in 0.5 s in place of 3 s, and run half as fast
