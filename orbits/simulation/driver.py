"""Runs of the event-driven simulator, for every model alike."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from orbits.flows.page.stepper import Stepper
from orbits.flows.protocol import SimulationError, told
from orbits.machines.catalogue import stepper as machine
from orbits.machines.page.machine import Machine as Page
from orbits.machines.stepping import EVENTS_FULL, FAILED, MODE, PSI, RATE, TURNS, V_RATE, Machine, V, W
from orbits.simulation import page
from orbits.simulation.trajectory import Trajectory

FIRST, CHUNK = 256, 16384
MOST_EVENTS = 1_000_000
FOREVER = 1e6  # periods: only a motion that keeps off the walls lasts so long without events
_KEYS = {"phase": PSI, "w": W, "w_rate": RATE, "v": V, "v_rate": V_RATE}
_BODIES = ("q1", "q2", "q1_rate", "q2_rate")


def simulate(
    model: Any,
    start: Mapping[str, float] | np.ndarray | None = None,
    *,
    periods: float | None = None,
    time: float | None = None,
    events: int | None = None,
    **parameters: float,
) -> Any:
    """Simulate the machine from event to event.

    Parameters
    ----------
    model : Model or Machine
    start : mapping or ndarray, optional
        Of a built-in machine `phase` (radians), `w`, `w_rate`, and in the coupled model `v`, `v_rate` or `q1`, `q2`, `q1_rate`, `q2_rate`; of a page
        its states by name, and `phase` if it is forced. What is not given is 0. Or a state of a built-in machine, such as `Trajectory.end`.
    periods, time : float, optional
        How long: forcing periods, or the machine's time.
    events : int, optional
        Stop after so many events. Without it at most a million, so that a run always ends.
    **parameters
        Parameters that are no fields of the machine (`amplitude`), or that replace them.

    Returns
    -------
    Trajectory or PageTrajectory

    Raises
    ------
    SimulationError
        If the start cannot be, no length is given, or the laws do not continue the motion.
    """
    params = model.vector(parameters)
    page_ = isinstance(model, Page)
    if periods is None and time is None and events is None:
        raise SimulationError("neither periods, time nor events are given: say how long to simulate")
    if page_ and periods is not None and not model.forced:
        raise SimulationError("periods: a self-excited machine has no forcing to count; give time or events")
    for name, value in (("periods", periods), ("time", time), ("events", events)):
        if value is not None and not (math.isfinite(value) and value >= 0.0):
            raise SimulationError(f"{name} = {value}: give a number, 0 or above")
    most = MOST_EVENTS if events is None else events
    if page_:
        stepper = Stepper(model, params)
        stepper.start(*page.first_state(model, start))
        length = None if periods is None else 2.0 * math.pi * periods
        if length is None and time is not None:
            length = time * stepper.clock_rate
        return page.collect(stepper, math.inf if length is None else length, most)
    engine = machine(model.name)
    state = first_state(model, engine, params, start)
    if periods is None and time is not None:
        rate = float(params[model.parameter_names.index("frequency")]) / float(model.gauge("time", params))
        periods = time * rate / (2.0 * math.pi)
    return follow(model, engine, params, state, FOREVER if periods is None else periods, most)


def follow(
    model: Any,
    engine: Machine,
    params: np.ndarray,
    state: np.ndarray,
    periods: float,
    events: int = MOST_EVENTS,
) -> Trajectory:
    """The motion from a state, which is moved along; `SimulationError` if it leaves the range of numbers."""
    until = state[TURNS] + state[PSI] / (2.0 * math.pi) + periods
    begin = state.copy()
    codes, modes, rows, status = collect(engine, state, params, until, events)
    if status == FAILED:
        raise SimulationError(
            f"the motion of {model.name!r} left the range of numbers: give parameters and a start of moderate size"
        )
    if begin[MODE] == 0.0 and begin[W] not in engine.walls(params) and model.frictionless(params):
        begin[MODE] = (
            1.0  # off the walls nothing rests without friction, not even at the instant at which nothing pushes
        )
    return Trajectory(model, params, engine, begin, state, codes, modes, rows, status)


def first_state(
    model: Any, engine: Machine, params: np.ndarray, start: Mapping[str, float] | np.ndarray | None
) -> np.ndarray:
    """The state, shape (S,), that a start describes; `SimulationError` if it cannot be one."""
    state = np.zeros(engine.state)
    if isinstance(start, np.ndarray):
        if start.shape != state.shape:
            raise SimulationError(
                f"the start has shape {start.shape}: a state of {model.name!r} has {state.shape}"
            )
        state[:] = start
        _check(state, engine.walls(params))
        return state
    given = dict(start or {})
    allowed = [key for key, place in _KEYS.items() if place < engine.state]
    if engine.moving_cavity:
        allowed += _BODIES
        if any(key in given for key in _BODIES):
            q1, q2, q1_rate, q2_rate = (float(given.pop(key, 0.0)) for key in _BODIES)
            w, v = model.relative(q1, q2, params)
            w_rate, v_rate = model.relative(q1_rate, q2_rate, params)
            given = {"w": w, "w_rate": w_rate, "v": float(v), "v_rate": float(v_rate)} | given
    for key, value in told(given, allowed).items():
        state[_KEYS[key]] = value
    _check(state, engine.walls(params))
    engine.launch(state, params)
    return state


def _check(state: np.ndarray, walls: tuple[float, float]) -> None:
    if not np.all(np.isfinite(state)):
        raise SimulationError("the start is not finite: give numbers for phase, w and w_rate")
    left, right = walls
    if not right <= state[W] <= left:
        raise SimulationError(f"w = {state[W]:g} lies outside the cavity: give {right:g} <= w <= {left:g}")


def collect(
    engine: Machine, state: np.ndarray, params: np.ndarray, until: float, most: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray, int]:
    """Run on from `state` (changed in place) for at most `most` events; returns codes, modes, rows and the status."""
    parts = []
    status = EVENTS_FULL
    left = most
    while left > 0 and status == EVENTS_FULL:
        size = min(left, CHUNK if parts else FIRST)  # most runs are short
        codes, modes, rows = buffers(engine, size)
        count, status = engine.advance(state, params, until, codes, modes, rows)
        parts.append((codes[:count], modes[:count], rows[:count]))
        left -= count
    if not parts:
        return (*buffers(engine, 0), status)
    if len(parts) == 1:
        return (*parts[0], status)
    codes, modes, rows = (np.concatenate(column) for column in zip(*parts))
    return codes, modes, rows, status


def skip(
    engine: Machine,
    state: np.ndarray,
    params: np.ndarray,
    until: float,
    most: int,
    scratch: tuple[np.ndarray, np.ndarray, np.ndarray] | None = None,
) -> int:
    """Run on from `state` (changed in place) without keeping events; returns the status."""
    codes, modes, rows = scratch if scratch is not None else buffers(engine, 4096)
    status = EVENTS_FULL
    while most > 0 and status == EVENTS_FULL:
        count, status = engine.advance(state, params, until, codes, modes, rows)
        most -= count
    return status


def buffers(engine: Machine, size: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Empty event arrays for `size` events."""
    return np.empty(size, np.int8), np.empty(size, np.int8), np.empty((size, engine.row))
