"""Between nodes, which continuation solves for, and the states and event rows of the compiled steppers."""

from __future__ import annotations

import numpy as np

from orbits.machines.stepping import MODE, PSI, RATE, TURNS, V_RATE, Machine, V, W

TWO_PI = 2.0 * np.pi


def state_of(engine: Machine, params: np.ndarray, code: int, mode: int, node: np.ndarray) -> np.ndarray:
    """The state, shape (S,), just after an event, from its node (Psi, B+ or w(, v, v'))."""
    state = np.zeros(engine.state)
    psi = float(node[0])
    turns = np.floor(psi / TWO_PI)
    psi -= turns * TWO_PI
    if psi >= TWO_PI or psi < 0.0:
        psi = 0.0
    state[PSI], state[TURNS], state[MODE] = psi, turns, mode
    if engine.state > V:
        state[V], state[V_RATE] = node[2], node[3]
    if code < 2:
        state[W] = engine.walls(params)[code]
        state[RATE] = _cavity_speed(engine, params, state[None, :])[0] - node[1]
    else:
        state[W] = node[1]
    return state


def nodes_of(
    engine: Machine, params: np.ndarray, codes: np.ndarray, modes: np.ndarray, rows: np.ndarray
) -> np.ndarray:
    """Nodes, shape (n, NODE), of events; phases are counted through (2 pi per turn)."""
    states = event_states(engine, modes, rows)
    nodes = np.empty((len(rows), 4 if engine.state > V else 2))
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
    if machine.state > V:
        states[:, V] = rows[:, 5]
        states[:, V_RATE] = rows[:, 6]
    return states
