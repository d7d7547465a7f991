"""Runs of the event-driven simulator, for every model alike."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from contvines.shared.near_names import did_you_mean
from orbits.flows.protocol import SimulationError
from orbits.machines.catalogue import stepper as machine
from orbits.machines.stepping import EVENTS_FULL, FAILED, MODE, PSI, RATE, TURNS, V_RATE, Machine, V, W
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
    events: int | None = None,
    **parameters: float,
) -> Trajectory:
    """Simulate the machine from event to event.

    Parameters
    ----------
    model : Model
        The machine.
    start : mapping or ndarray, optional
        `phase` (radians), `w`, `w_rate`, and in the coupled model `v`, `v_rate` or `q1`, `q2`, `q1_rate`, `q2_rate`;
        what is not given is 0. Or a state, such as `Trajectory.end`.
    periods : float, optional
        Forcing periods to simulate.
    events : int, optional
        Stop after so many events. Without it at most a million, so that a run always ends.
    **parameters
        Parameters that are no fields of the machine (`amplitude`), or that replace them.

    Returns
    -------
    Trajectory

    Raises
    ------
    SimulationError
        If the start lies outside the cavity or is not finite, or neither periods nor events are given.
    """
    params = model.vector(parameters)
    if periods is None and events is None:
        raise SimulationError("neither periods nor events are given: say how long to simulate")
    if periods is not None and not (math.isfinite(periods) and periods >= 0.0):
        raise SimulationError(f"periods = {periods}: give a number of forcing periods, 0 or above")
    if events is not None and events < 0:
        raise SimulationError(f"events = {events}: give a number of events, 0 or above")
    engine = machine(model.name)
    state = first_state(model, engine, params, start)
    length = FOREVER if periods is None else periods
    return follow(model, engine, params, state, length, MOST_EVENTS if events is None else events)


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
    for key, value in given.items():
        if key not in allowed:
            raise SimulationError(
                f"start has no entry {key!r}{did_you_mean(key, allowed)}; it may have {', '.join(allowed)}"
            )
        state[_KEYS[key]] = float(value)
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
