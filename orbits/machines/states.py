"""Between nodes, which continuation solves for, and the states and event rows of the steppers."""

from __future__ import annotations

import numpy as np

from contvines.core.library import NOTHING, NUMBER, POINTER, WHOLE, address, function
from orbits.machines.native_stepper import bytes_of, floats, number
from orbits.machines.stepping import MODE, PSI, RATE, TURNS, V_RATE, Machine, V, W

TWO_PI = 2.0 * np.pi


def states_of(
    engine: Machine, params: np.ndarray, codes: np.ndarray, modes: np.ndarray, nodes: np.ndarray
) -> np.ndarray:
    """The states, shape (n, S), just after events, from their nodes (Psi, B+ or w(, v, v'))."""
    left, right = engine.walls(params)
    states = np.zeros((len(nodes), engine.state))
    machine = number(engine.name)
    if machine is not None:
        codes, modes, nodes, params = bytes_of(codes), bytes_of(modes), floats(nodes), floats(params)
        work = function(
            "simulation_states", NOTHING, WHOLE, POINTER, WHOLE, POINTER, POINTER, POINTER, NUMBER, NUMBER, POINTER
        )  # fmt: skip
        events = address(codes), address(modes), address(nodes)
        work(machine, address(params), len(nodes), *events, left, right, address(states))
        return states
    turns = np.floor(nodes[:, 0] / TWO_PI)
    psi = nodes[:, 0] - turns * TWO_PI
    states[:, PSI] = np.where((psi >= 0.0) & (psi < TWO_PI), psi, 0.0)
    states[:, TURNS], states[:, MODE] = turns, modes
    states[:, V:] = nodes[:, 2:]
    impact = codes < 2
    states[:, W] = np.where(impact, np.where(codes == 0, left, right), nodes[:, 1])
    states[:, RATE] = np.where(impact, _cavity_speed(engine, params, states) - nodes[:, 1], 0.0)
    return states


def state_of(engine: Machine, params: np.ndarray, code: int, mode: int, node: np.ndarray) -> np.ndarray:
    """The same after one event, shape (S,)."""
    return states_of(engine, params, np.array([code]), np.array([mode]), node[None])[0]


def nodes_of(
    engine: Machine, params: np.ndarray, codes: np.ndarray, modes: np.ndarray, rows: np.ndarray
) -> np.ndarray:
    """Nodes, shape (n, NODE), of events; phases are counted through (2 pi per turn)."""
    states = event_states(engine, modes, rows)
    nodes = np.empty((len(rows), engine.node))
    nodes[:, 0] = states[:, PSI] + TWO_PI * states[:, TURNS]
    impact = codes < 2
    nodes[:, 1] = np.where(impact, _cavity_speed(engine, params, states) - states[:, RATE], states[:, W])
    nodes[:, 2:] = rows[:, 5 : 5 + nodes.shape[1] - 2]
    return nodes


def _cavity_speed(engine: Machine, params: np.ndarray, states: np.ndarray) -> np.ndarray:
    out = np.empty((len(states), 4))
    engine.sample(states, params, np.zeros(len(states)), out)
    return out[:, 3]


def event_states(machine: Machine, modes: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """States after events, shape (n, S), from their rows."""
    states = np.zeros((len(rows), machine.state))
    states[:, PSI] = rows[:, 0]
    states[:, TURNS] = rows[:, 1]
    states[:, W] = rows[:, 2]
    states[:, RATE] = rows[:, 4]
    states[:, MODE] = modes
    if machine.moving_cavity:
        states[:, V] = rows[:, 5]
        states[:, V_RATE] = rows[:, 6]
    return states
