"""Between nodes, which continuation solves for, and the states and event rows of the compiled steppers."""

from __future__ import annotations

import math

import numpy as np

from orbits.compiling.decorators import stored_kernel
from orbits.machines.stepping import MODE, PSI, RATE, TURNS, V_RATE, Machine, V, W

TWO_PI = 2.0 * np.pi


def state_of(engine: Machine, params: np.ndarray, code: int, mode: int, node: np.ndarray) -> np.ndarray:
    """The state, shape (S,), just after an event, from its node (Psi, B+ or w(, v, v'))."""
    state = np.zeros(engine.state)
    turns = math.floor(node[0] / TWO_PI)
    psi = node[0] - turns * TWO_PI
    state[PSI] = psi if 0.0 <= psi < TWO_PI else 0.0
    state[TURNS], state[MODE], state[W] = turns, mode, node[1]
    if engine.moving_cavity:
        state[V], state[V_RATE] = node[2], node[3]
    if code < 2:
        state[W] = engine.walls(params)[code]
        state[RATE] = _cavity_speed(engine, params, state[None])[0] - node[1]
    return state


def states_of(
    engine: Machine, params: np.ndarray, codes: np.ndarray, modes: np.ndarray, nodes: np.ndarray
) -> np.ndarray:
    """The states, shape (n, S), just after events, from their nodes (Psi, B+ or w(, v, v'))."""
    left, right = engine.walls(params)
    states, speeds = np.zeros((len(nodes), engine.state)), np.zeros((len(nodes), 4))
    nodes = np.ascontiguousarray(nodes, dtype=float)
    if placed(codes, modes, nodes, float(left), float(right), states):
        engine.sample(states, params, speeds[:, 0].copy(), speeds)
        states[:, RATE] = np.where(codes < 2, speeds[:, 3] - nodes[:, 1], 0.0)
    return states


@stored_kernel
def placed(codes, modes, nodes, left, right, states):
    """Fill states (n, S) with all that nodes tell without the cavity's speed; whether there is an impact."""
    hits = False
    for i in range(nodes.shape[0]):
        turns = np.floor(nodes[i, 0] / TWO_PI)
        psi = nodes[i, 0] - turns * TWO_PI
        states[i, PSI] = psi if 0.0 <= psi < TWO_PI else 0.0
        states[i, TURNS], states[i, MODE], states[i, W] = turns, modes[i], nodes[i, 1]
        if states.shape[1] > V_RATE:
            states[i, V], states[i, V_RATE] = nodes[i, 2], nodes[i, 3]
        if codes[i] < 2:
            hits = True
            states[i, W] = left if codes[i] == 0 else right
    return hits


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
