"""The seam to heyoka: symbols in, compiled Taylor integrators out. The only file that imports it.

Whatever stands behind this seam has to offer: symbols with derivatives (`variable`, `derivative`), functions compiled for many
points at once (`Values`), flights with their sensitivities, one by one (`Flight`) or several at once (`Flights`), flights that report
every root of given functions (`Watch`), and flights that end at the first root (`Run`). heyoka finds all roots inside a step from the Taylor polynomials of
the functions (Biscani, Izzo, MNRAS 504 (2021) 2614), so that a double crossing is not missed.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from orbits.symbols import ELEMENTARY, Symbol


class EngineMissing(ImportError):
    """The integrator behind declared machines is not installed."""


@cache
def _heyoka() -> Any:
    try:
        import heyoka
    except ImportError as error:
        raise EngineMissing(
            "declared machines need heyoka, which is not installed: pip install 'contvines[machines]' (Linux), "
            "or conda install heyoka.py -c conda-forge (macOS, Windows)"
        ) from error
    heyoka.set_logger_level_error()  # a flow that runs away is reported by what it returns
    return heyoka


@cache
def _functions() -> dict[str, Callable]:
    heyoka = _heyoka()
    return {name: getattr(heyoka, name) for name in ELEMENTARY}


def variable(name: str) -> Symbol:
    """A symbol with a name."""
    return Symbol(_heyoka().expression(name), _functions())


def constant(value: float) -> Symbol:
    """A number as a symbol."""
    return Symbol(_heyoka().expression(float(value)), _functions())


def derivatives(values: Sequence[Symbol], by: Sequence[Symbol]) -> list[list[Symbol]]:
    """Partial derivatives, ``[i][j]`` of value i by variable j."""
    diff = _heyoka().diff
    functions = _functions()
    return [[Symbol(diff(v.expression, w.expression), functions) for w in by] for v in values]


def replaced(value: Symbol, numbers: dict[str, float]) -> Symbol:
    """The expression with numbers in place of some variables."""
    heyoka = _heyoka()
    places = {name: heyoka.expression(number) for name, number in numbers.items()}
    return Symbol(heyoka.subs(value.expression, places), _functions())


def variables_of(value: Symbol) -> set[str]:
    """Names of the variables that an expression contains."""
    return set(_heyoka().get_variables(value.expression))


@dataclass(frozen=True)
class Layout:
    """Which variables are states, which is the independent one, and which are numbers handed in at run time.

    Attributes
    ----------
    states : tuple of str
    clock : str
        The independent variable: the forcing phase, or time.
    numbers : tuple of str
        In the order of the vectors handed in: parameters, then signs.
    """

    states: tuple[str, ...]
    clock: str
    numbers: tuple[str, ...]

    def lowered(self, values: Sequence[Symbol]) -> list[Any]:
        """heyoka's expressions with time and runtime parameters in place of the clock and the numbers."""
        heyoka = _heyoka()
        places: dict[Any, Any] = {name: heyoka.par[i] for i, name in enumerate(self.numbers)}
        places[self.clock] = heyoka.time
        return [heyoka.subs(value.expression, places) for value in values]


class Values:
    """Functions of states, clock and numbers, compiled for many points at once."""

    def __init__(self, layout: Layout, values: Sequence[Symbol]) -> None:
        heyoka = _heyoka()
        self.count = len(values)
        variables = [heyoka.expression(name) for name in layout.states]
        self._function = heyoka.cfunc(layout.lowered(values), vars=variables)
        self._numbers = int(self._function.nparams)

    def __call__(self, states: np.ndarray, clock: np.ndarray, numbers: np.ndarray) -> np.ndarray:
        """Values, shape (m, count), at `states` (m, n), `clock` (m,), `numbers` (m, P)."""
        out = np.empty((self.count, len(states)))
        self._function(
            np.ascontiguousarray(states.T),
            pars=np.ascontiguousarray(numbers.T[: self._numbers]),
            time=np.ascontiguousarray(clock),
            outputs=out,
        )
        return out.T

    def one(self, state: np.ndarray, clock: float, numbers: np.ndarray) -> np.ndarray:
        """Values, shape (count,), at one point; a third of the time of a call for many."""
        return self._function(state, pars=numbers[: self._numbers], time=clock)


class Flight:
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
        heyoka = _heyoka()
        self.n = len(layout.states)
        variational = _variational(layout, rates, active)
        self._integrator = heyoka.taylor_adaptive(variational, [0.0] * self.n, compact_mode=self.n >= LARGE)
        self._numbers = len(self._integrator.pars)
        self._begin = np.array(self._integrator.state)
        self._done = heyoka.taylor_outcome.time_limit

    def __call__(
        self, state: np.ndarray, begin: float, end: float, numbers: np.ndarray, out: np.ndarray
    ) -> bool:
        """Write the final state and its derivatives, (n + n (n + active),), row by row; False if the flow blows up."""
        ta = self._integrator
        ta.time = begin
        ta.state[:] = self._begin
        ta.state[: self.n] = state
        ta.pars[:] = numbers[: self._numbers]
        outcome = ta.propagate_until(end, max_steps=MOST_STEPS)[0]
        out[:] = ta.state
        return outcome == self._done


class Flights:
    """The same for several flights at once, `LANES` of them side by side in the processor's vectors; each takes its own steps."""

    def __init__(self, layout: Layout, rates: Sequence[Symbol], active: tuple[int, ...]) -> None:
        heyoka = _heyoka()
        self.n = len(layout.states)
        variational = _variational(layout, rates, active)
        self._begin = np.zeros((self.n * (1 + self.n + len(active)), 1))
        self._begin[self.n :].reshape(self.n, -1)[:, : self.n] = np.eye(self.n)
        self._integrator = heyoka.taylor_adaptive_batch(
            variational.sys, np.repeat(self._begin, LANES, axis=1), compact_mode=self.n >= LARGE
        )
        self._numbers = len(self._integrator.pars)
        self._done = heyoka.taylor_outcome.time_limit

    def __call__(
        self, states: np.ndarray, begin: np.ndarray, end: np.ndarray, numbers: np.ndarray, out: np.ndarray
    ) -> bool:
        """Write a row per flight, as `Flight` does: states (m, n), begin and end (m,), numbers (m, P); False if one blows up."""
        ta, count = self._integrator, len(states)
        for first in range(0, count, LANES):
            lanes = np.minimum(
                np.arange(first, first + LANES), count - 1
            )  # the last one fills the lanes left over
            ta.set_time(begin[lanes])
            ta.state[:] = self._begin
            ta.state[: self.n] = states[lanes].T
            ta.pars[:] = numbers[lanes, : self._numbers].T
            ta.propagate_until(end[lanes], max_steps=MOST_STEPS)
            if any(result[0] != self._done for result in ta.propagate_res):
                return False
            out[first : first + LANES] = ta.state.T[: count - first]
        return True


class Watch:
    """A flow that reports every rise through zero of given functions on its way."""

    def __init__(self, layout: Layout, rates: Sequence[Symbol], functions: Sequence[Symbol]) -> None:
        heyoka = _heyoka()
        self._found: list[tuple[float, int, np.ndarray]] = []
        variables = [heyoka.expression(name) for name in layout.states]
        system = list(zip(variables, layout.lowered(rates)))
        found = self._found

        def note(place: int) -> Callable:
            def callback(ta: Any, clock: float, sign: int) -> None:
                ta.update_d_output(clock)
                found.append((clock, place, ta.d_output.copy()))

            return callback

        events = [
            heyoka.nt_event(f + NUDGE, note(i), direction=heyoka.event_direction.positive)
            for i, f in enumerate(layout.lowered(functions))
            if not _is_number(f)
        ]
        self._integrator = heyoka.taylor_adaptive(
            system,
            [0.0] * len(variables),
            nt_events=events,
            compact_mode=_large(system),
        )
        self._numbers = len(self._integrator.pars)
        self._done = heyoka.taylor_outcome.time_limit

    def __call__(
        self, state: np.ndarray, begin: float, end: float, numbers: np.ndarray
    ) -> list[tuple[float, int, np.ndarray]]:
        """(clock, which function, state) of every rise through zero between `begin` and `end`."""
        ta = self._integrator
        self._found.clear()
        ta.time = begin
        ta.state[:] = state
        ta.pars[:] = numbers[: self._numbers]
        ta.propagate_until(end, max_steps=MOST_STEPS)
        return list(self._found)

    def move(self, state: np.ndarray, begin: float, end: float, numbers: np.ndarray) -> None:
        """Move `state` on, in place, whatever the functions do."""
        self(state, begin, end, numbers)
        state[:] = self._integrator.state

    @property
    def final(self) -> np.ndarray:
        """The state at the end of the last flight."""
        return np.array(self._integrator.state)

    def path(self, state: np.ndarray, clocks: np.ndarray, numbers: np.ndarray) -> np.ndarray:
        """States, shape (m, n), at the increasing `clocks` (equal ones allowed), the first of which is where `state` is."""
        ta = self._integrator
        ta.time = float(clocks[0])
        ta.state[:] = state
        ta.pars[:] = numbers[: self._numbers]
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


class Run:
    """A flow that ends at the first fall through zero of one of its functions."""

    def __init__(self, layout: Layout, rates: Sequence[Symbol], functions: Sequence[Symbol]) -> None:
        heyoka = _heyoka()
        variables = [heyoka.expression(name) for name in layout.states]
        system = list(zip(variables, layout.lowered(rates)))
        lowered = layout.lowered(functions)
        self._places = [i for i, f in enumerate(lowered) if not _is_number(f)]
        events = [
            heyoka.t_event(lowered[i] + NUDGE, direction=heyoka.event_direction.negative)
            for i in self._places
        ]
        self._integrator = heyoka.taylor_adaptive(
            system,
            [0.0] * len(variables),
            t_events=events,
            compact_mode=_large(system),
        )
        self._numbers = len(self._integrator.pars)
        self._done, self._stopped = heyoka.taylor_outcome.time_limit, heyoka.taylor_outcome.step_limit

    def __call__(
        self, state: np.ndarray, begin: float, end: float, numbers: np.ndarray
    ) -> tuple[float, int | None]:
        """Move `state` on, in place; returns the clock and which function ended the flight.

        None: the end was reached; -1: the flow blew up.
        """
        ta = self._integrator
        ta.time = begin
        ta.state[:] = state
        ta.pars[:] = numbers[: self._numbers]
        ta.reset_cooldowns()
        while True:
            before = ta.time
            outcome = ta.propagate_until(end, max_steps=MOST_STEPS)[0]
            if outcome != self._stopped or ta.time - before < RUNAWAY:
                break
        state[:] = ta.state
        if outcome == self._done:
            return end, None
        code = -int(outcome.value) - 1
        if 0 <= code < len(self._places):
            return float(ta.time), self._places[code]
        return float(ta.time), -1


MOST_STEPS = 100_000  # of one flight: a flow that needs more runs away,
RUNAWAY = (
    1.0  # or, where it is followed to its next event, one that gets no further than so much clock in as many
)
NUDGE = 1e-200
"""Added to every event function: heyoka 7.13 loses the later roots in a step that begins exactly on one."""
LARGE = 12  # states from which compact code compiles much faster and runs nearly as fast


LANES = 4  # flights that are integrated side by side


def _variational(layout: Layout, rates: Sequence[Symbol], active: tuple[int, ...]) -> Any:
    """The flow with its first variations by the states and by some of the numbers."""
    heyoka = _heyoka()
    variables = [heyoka.expression(name) for name in layout.states]
    asked = variables + [heyoka.par[i] for i in active]
    return heyoka.var_ode_sys(list(zip(variables, layout.lowered(rates))), asked, order=1)


def _large(system: Sequence[Any]) -> bool:
    return len(system) >= LARGE


def _is_number(value: Any) -> bool:
    heyoka = _heyoka()
    timed = heyoka.cfunc(
        [value], vars=list(map(heyoka.expression, heyoka.get_variables(value))) or [heyoka.expression("x")]
    )
    return not heyoka.get_variables(value) and not heyoka.get_params(value) and not timed.is_time_dependent
