"""An orbit between its events: positions and velocities over time, in closed form."""

from __future__ import annotations

import numpy as np

from contvines.core.library import NOTHING, NUMBER, POINTER, WHOLE, address, function
from orbits.flows.protocol import Motion
from orbits.machines.base import Model
from orbits.machines.native_stepper import bytes_of, floats, number, stepper

GRID = np.arange(41.0)  # places of a bracket in which a flight's slowest one is looked for


def flight(motion: Motion[Model], segment: int, ahead: np.ndarray) -> np.ndarray:
    """w, w', v, v' at phases `ahead` (radians, shape (m,)) after event `segment`, in the mode that follows it; shape (m, 4)."""
    return _ahead(motion, _begins(motion, segment), np.ascontiguousarray(ahead, dtype=float))


def _begins(motion: Motion[Model], segment: int) -> np.ndarray:
    word = motion.word
    engine = stepper(motion.model.name)
    return engine.state_of(
        motion.params, int(word.codes[segment]), int(word.mode_codes[segment]), motion.nodes[segment]
    )


def _ahead(motion: Motion[Model], state: np.ndarray, ahead: np.ndarray) -> np.ndarray:
    states, out = np.empty((len(ahead), len(state))), np.empty((len(ahead), 4))
    states[...] = state
    stepper(motion.model.name).sample(states, motion.params, ahead, out)
    return out


def sample(motion: Motion[Model], points: int = 400) -> dict[str, np.ndarray]:
    """Positions and velocities over one period, events included with both their velocities.

    Parameters
    ----------
    motion : Motion[Model]
    points : int
        About how many points; at least two per segment.

    Returns
    -------
    dict of float arrays
        ``tau`` (dimensionless time from the first event), ``phase``, ``w``, ``w_rate``, ``v``, ``v_rate``, the absolute
        positions in units of b ``cavity`` (q1) and ``absorber`` (q2), and ``segment`` (index of the event before).
    """
    if not len(motion.word):
        return _at_rest(motion, points)
    durations = np.maximum(motion.durations, 0.0)
    counts = np.maximum(2, np.rint(points * durations / (2.0 * np.pi * motion.periods))).astype(int)
    ends = np.cumsum(counts)
    segment = np.repeat(np.arange(len(counts)), counts)
    ahead = (np.arange(ends[-1]) - (ends - counts)[segment]) * (durations / (counts - 1))[segment]
    ahead[ends - 1] = durations
    engine = stepper(motion.model.name)
    states = engine.states_of(motion.params, motion.word.codes, motion.word.mode_codes, motion.nodes)
    out = np.empty((len(ahead), 4))
    engine.sample(states[segment], motion.params, ahead, out)
    phase = motion.nodes[segment, 0] + ahead
    w, w_rate, v, v_rate = out.T
    cavity, absorber = motion.model.bodies(w, v, motion.params)
    return {
        "tau": (phase - phase[0]) / motion.parameters["frequency"],
        "phase": phase,
        "w": w,
        "w_rate": w_rate,
        "v": v,
        "v_rate": v_rate,
        "cavity": cavity,
        "absorber": absorber,
        "segment": segment,
    }


def positions(motion: Motion[Model], instants: int) -> np.ndarray:
    """w at so many equal phases of each forcing period, from phase zero on, shape (periods * instants,)."""
    count = instants * motion.periods
    if not len(motion.nodes):
        return np.zeros(count)
    engine, params, length = stepper(motion.model.name), motion.params, 2.0 * np.pi * motion.periods
    codes, modes, nodes = motion.word.codes, motion.word.mode_codes, motion.nodes
    machine = number(engine.name)
    if machine is not None:
        left, right = engine.walls(params)
        codes, modes, nodes, params, w = (
            bytes_of(codes),
            bytes_of(modes),
            floats(nodes),
            floats(params),
            np.empty(count),
        )
        work = function(
            "simulation_positions", NOTHING, WHOLE, POINTER, WHOLE, POINTER, POINTER, POINTER, NUMBER, NUMBER, NUMBER, WHOLE, POINTER
        )  # fmt: skip
        events = address(codes), address(modes), address(nodes)
        work(machine, address(params), len(codes), *events, left, right, length, count, address(w))
        return w
    begins = np.maximum.accumulate(nodes[:, 0] - nodes[0, 0])
    wanted = (np.arange(count) * (length / count) - nodes[0, 0]) % length
    segment = np.searchsorted(begins, wanted, side="right") - 1
    states, out = engine.states_of(params, codes, modes, nodes), np.empty((count, 4))
    engine.sample(states[segment], params, wanted - begins[segment], out)
    return out[:, 0]


def _at_rest(motion: Motion[Model], points: int) -> dict[str, np.ndarray]:
    """The same of the absorber that rides with its cavity."""
    phase = np.linspace(0.0, 2.0 * np.pi, points)
    omega, rest = motion.parameters["frequency"], motion.model.rest
    v, v_rate = rest.cavity_motion(motion.params, rest.solved(motion.params), phase)
    nothing = np.zeros_like(phase)
    place, _ = motion.model.bodies(nothing, v, motion.params)
    return {
        "tau": phase / omega, "phase": phase, "w": nothing, "w_rate": nothing, "v": v, "v_rate": v_rate,
        "cavity": place, "absorber": place, "segment": np.zeros(points, int),
    }  # fmt: skip


def points(motion: Motion[Model]) -> np.ndarray:
    """w, w' (, v, v') just after the events, shape (L, d)."""
    engine, word = stepper(motion.model.name), motion.word
    states = engine.states_of(motion.params, word.codes, word.mode_codes, motion.nodes)
    return states[:, list(engine.places)]


def slowest(motion: Motion[Model], segment: int) -> tuple[float, np.ndarray]:
    """Where s w' is smallest inside a flight: the phase ahead of its event, and (w, w', v, v') there."""
    length, mode, state = (
        float(motion.durations[segment]),
        float(motion.word.mode_codes[segment]),
        _begins(motion, segment),
    )
    ahead = np.linspace(0.0, length, 402)[1:-1]
    speed = mode * _ahead(motion, state, ahead)[:, 1]
    inner = np.flatnonzero((speed[1:-1] <= speed[:-2]) & (speed[1:-1] <= speed[2:])) + 1
    place = int(inner[speed[inner].argmin()] if inner.size else speed.argmin())
    low, high = float(ahead[max(place - 1, 0)]), float(ahead[min(place + 1, ahead.size - 1)])
    for _ in range(6):  # finer grids round the minimum: 1/20 of the bracket each time
        ahead = low + (high - low) / 40.0 * GRID
        place = int((mode * _ahead(motion, state, ahead)[:, 1]).argmin())
        low, high = float(ahead[max(place - 1, 0)]), float(ahead[min(place + 1, 40)])
    where = 0.5 * (low + high)
    return where, _ahead(motion, state, np.array([where]))[0]
