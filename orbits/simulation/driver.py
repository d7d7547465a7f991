"""Runs of the steppers of built-in machines: what they begin with, events kept or not."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from orbits.flows.protocol import SimulationError, checked_start
from orbits.machines.stepping import EVENTS_FULL, PSI, RATE, V_RATE, Stepper, V, W

if TYPE_CHECKING:
    from orbits.machines.base import Model

FIRST, CHUNK = 256, 16384
MOST_EVENTS = 1_000_000
_KEYS = {"phase": PSI, "w": W, "w_rate": RATE, "v": V, "v_rate": V_RATE}
_BODIES = ("q1", "q2", "q1_rate", "q2_rate")


def first_state(
    model: Model, engine: Stepper, params: np.ndarray, start: Mapping[str, float] | np.ndarray | None
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
    for key, value in checked_start(given, allowed).items():
        state[_KEYS[key]] = value
    _check(state, engine.walls(params))
    engine.launch(state, params)
    return state


def _check(state: np.ndarray, walls: tuple[float, float]) -> None:
    if not np.all(np.isfinite(state)):
        raise SimulationError("the start is not finite: give numbers for phase, w and w_rate")
    left, right = walls
    rounding = 16.0 * np.finfo(float).eps * (left - right)  # of a motion that begins at a wall
    if not right - rounding <= state[W] <= left + rounding:
        raise SimulationError(f"w = {state[W]:g} lies outside the cavity: give {right:g} <= w <= {left:g}")
    state[W] = min(max(state[W], right), left)


def collect(
    engine: Stepper, state: np.ndarray, params: np.ndarray, until: float, most: int
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
    engine: Stepper,
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


def buffers(engine: Stepper, size: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Empty event arrays for `size` events."""
    return np.empty(size, np.int8), np.empty(size, np.int8), np.empty((size, engine.row))
