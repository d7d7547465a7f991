"""An orbit between its events: positions and velocities over time, in closed form."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

from orbits.compiling.decorators import specialise
from orbits.compiling.waiting import wait_for
from orbits.cycles.cycle import Cycle
from orbits.machines.catalogue import stepper
from orbits.machines.states import placed, state_of, states_of
from orbits.machines.stepping import RATE

PER_PERIOD = 200  # instants of a forcing period at which motions are compared
GRID = np.arange(41.0)  # places of a bracket in which a flight's slowest one is looked for


def flight(orbit: Cycle, segment: int, ahead: np.ndarray) -> np.ndarray:
    """w, w', v, v' at phases `ahead` (radians, shape (m,)) after event `segment`, in the mode that follows it; shape (m, 4)."""
    return _ahead(orbit, _begins(orbit, segment), np.ascontiguousarray(ahead, dtype=float))


def _begins(orbit: Cycle, segment: int) -> np.ndarray:
    word = orbit.word
    engine = stepper(orbit.model.name)
    return state_of(
        engine, orbit.params, int(word.codes[segment]), int(word.modes[segment]), orbit.nodes[segment]
    )


def _ahead(orbit: Cycle, state: np.ndarray, ahead: np.ndarray) -> np.ndarray:
    states, out = np.empty((len(ahead), len(state))), np.empty((len(ahead), 4))
    states[...] = state
    stepper(orbit.model.name).sample(states, orbit.params, ahead, out)
    return out


def sample(orbit: Cycle, points: int = 400) -> dict[str, np.ndarray]:
    """Positions and velocities over one period, events included with both their velocities.

    Parameters
    ----------
    orbit : Cycle
    points : int
        About how many points; at least two per segment.

    Returns
    -------
    dict of float arrays
        ``tau`` (dimensionless time from the first event), ``phase``, ``w``, ``w_rate``, ``v``, ``v_rate``, the absolute
        positions in units of b ``cavity`` (q1) and ``absorber`` (q2), and ``segment`` (index of the event before).
    """
    if not len(orbit.word):
        return _at_rest(orbit, points)
    durations = np.maximum(orbit.durations, 0.0)
    counts = np.maximum(2, np.rint(points * durations / (2.0 * np.pi * orbit.periods))).astype(int)
    ends = np.cumsum(counts)
    segment = np.repeat(np.arange(len(counts)), counts)
    ahead = (np.arange(ends[-1]) - (ends - counts)[segment]) * (durations / (counts - 1))[segment]
    ahead[ends - 1] = durations
    engine = stepper(orbit.model.name)
    states = states_of(engine, orbit.params, orbit.word.codes, orbit.word.mode_codes, orbit.nodes)
    out = np.empty((len(ahead), 4))
    engine.sample(states[segment], orbit.params, ahead, out)
    phase = orbit.nodes[segment, 0] + ahead
    w, w_rate, v, v_rate = out.T
    cavity, absorber = orbit.model.bodies(w, v, orbit.params)
    return {
        "tau": (phase - phase[0]) / orbit.parameters["frequency"],
        "phase": phase,
        "w": w,
        "w_rate": w_rate,
        "v": v,
        "v_rate": v_rate,
        "cavity": cavity,
        "absorber": absorber,
        "segment": segment,
    }


def positions(orbit: Cycle, instants: int = PER_PERIOD) -> np.ndarray:
    """w at so many equal phases of each forcing period, from phase zero on, shape (periods * instants,)."""
    count, length = instants * orbit.periods, len(orbit.nodes)
    if not length:
        return np.zeros(count)
    engine = stepper(orbit.model.name)
    left, right = engine.walls(orbit.params)
    starts, states = np.zeros((length, engine.state)), np.empty((count, engine.state))
    ahead, out = np.zeros(max(count, length)), np.empty((max(count, length), 4))
    nodes = np.ascontiguousarray(orbit.nodes, dtype=float)
    codes, modes, whole = orbit.word.codes, orbit.word.mode_codes, 2.0 * np.pi * orbit.periods
    tracer = _tracer(orbit.model.name)
    wait_for(orbit.model.name, tracer)
    tracer(codes, modes, nodes, orbit.params, float(left), float(right), whole, starts, states, ahead, out)
    return out[:count, 0]


@cache
def _tracer(name: str) -> Any:
    """What samples a motion of the machine called `name` at equal phases, compiled; numbers as `states_of` and `sample` give them."""
    sample = stepper(name).sample
    options = {"error_model": "numpy"}
    return specialise(_track, sample.py_func.__qualname__ + f"_{name}", options=options, between=sample)


def between(states, params, ahead, out):
    """Placeholder for a machine's `sample`."""
    raise TypeError("put in by `_tracer`")


def _track(codes, modes, nodes, params, left, right, whole, starts, states, ahead, out):
    """Sample a cycle of `whole` radians at equal phases into `out`; the other arrays are room, `ahead` has zeros."""
    count, length = states.shape[0], nodes.shape[0]
    step = whole / count
    if placed(codes, modes, nodes, left, right, starts):
        between(starts, params, ahead[:length], out[:length])
        for i in range(length):
            starts[i, RATE] = out[i, 3] - nodes[i, 1] if codes[i] < 2 else 0.0
    first, segment, before, begins = nodes[0, 0], 0, -1.0, 0.0
    for i in range(count):
        wanted = (i * step - first) % whole
        if wanted < before:
            segment, begins = 0, 0.0
        before = wanted
        while segment + 1 < length and max(begins, nodes[segment + 1, 0] - first) <= wanted:
            segment += 1
            begins = max(begins, nodes[segment, 0] - first)
        for j in range(states.shape[1]):
            states[i, j] = starts[segment, j]
        ahead[i] = wanted - begins
    between(states, params, ahead[:count], out[:count])


def _at_rest(orbit: Cycle, points: int) -> dict[str, np.ndarray]:
    """The same of the absorber that rides with its cavity."""
    phase = np.linspace(0.0, 2.0 * np.pi, points)
    omega, rest = orbit.parameters["frequency"], orbit.model.rest
    v, v_rate = rest.cavity_motion(orbit.params, np.linalg.solve(*rest.equations(orbit.params)), phase)
    nothing = np.zeros_like(phase)
    place, _ = orbit.model.bodies(nothing, v, orbit.params)
    return {
        "tau": phase / omega, "phase": phase, "w": nothing, "w_rate": nothing, "v": v, "v_rate": v_rate,
        "cavity": place, "absorber": place, "segment": np.zeros(points, int),
    }  # fmt: skip


def slowest(orbit: Cycle, segment: int) -> tuple[float, np.ndarray]:
    """Where s w' is smallest inside a flight: the phase ahead of its event, and (w, w', v, v') there."""
    length, mode, state = float(orbit.durations[segment]), orbit.word.modes[segment], _begins(orbit, segment)
    ahead = np.linspace(0.0, length, 402)[1:-1]
    speed = mode * _ahead(orbit, state, ahead)[:, 1]
    inner = np.flatnonzero((speed[1:-1] <= speed[:-2]) & (speed[1:-1] <= speed[2:])) + 1
    place = int(inner[speed[inner].argmin()] if inner.size else speed.argmin())
    low, high = float(ahead[max(place - 1, 0)]), float(ahead[min(place + 1, ahead.size - 1)])
    for _ in range(6):  # finer grids round the minimum: 1/20 of the bracket each time
        ahead = low + (high - low) / 40.0 * GRID
        place = int((mode * _ahead(orbit, state, ahead)[:, 1]).argmin())
        low, high = float(ahead[max(place - 1, 0)]), float(ahead[min(place + 1, 40)])
    where = 0.5 * (low + high)
    return where, _ahead(orbit, state, np.array([where]))[0]
