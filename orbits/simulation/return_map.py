"""Once round a periodic orbit by simulation: the return map from one of its events to itself.

Nothing here knows the equations that continuation solves, so it can check them. Derivatives
are central differences of the simulated map.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from orbits.machines.states import nodes_of, state_of
from orbits.machines.stepping import (
    FAILED,
    HOLD,
    RATE,
    TIME_REACHED,
    TURNS,
    Machine,
    W,
)
from orbits.simulation.driver import buffers
from orbits.simulation.native_trajectory import LETTERS, TWO_PI

ROUNDING = 1e-15  # of a simulated node
ENOUGH = 2e-10  # estimated error of a derivative that asks for no smaller step


class Round(NamedTuple):
    """Events after the first node, up to and including its return.

    nodes : shape (n, NODE), phases counted from the first node's; message : "" or what went otherwise than listed.
    """

    nodes: np.ndarray
    message: str


def go_round(
    engine: Machine,
    params: np.ndarray,
    codes: np.ndarray,
    modes: np.ndarray,
    node: np.ndarray,
    times: int = 1,
    events: int | None = None,
) -> Round:
    """Start exactly at the first event of a cycle and simulate it `times` times, or so many events only.

    Parameters
    ----------
    codes, modes : ndarray, shape (n,)
        The cycle's events and the modes after them.
    node : ndarray, shape (NODE,)
        The first node.

    Returns
    -------
    Round
        `nodes` has shape (times * n, NODE): events 1 ... n-1, the return to event 0, and so on.
    """
    wanted = times * len(codes) if events is None else events
    state = state_of(engine, params, int(codes[0]), int(modes[0]), node)
    left, right = engine.walls(params)
    if not right <= state[W] <= left:
        return Round(np.empty((0, len(node))), f"the first node lies outside the cavity (w = {state[W]:g})")
    base = state[TURNS]
    state[TURNS] = 0.0
    if codes[0] < 2 and state[RATE] * modes[0] <= 0.0:
        return Round(np.empty((0, len(node))), "the first impact does not send the absorber off the wall")
    seen, after, rows = buffers(engine, wanted)
    count, status = engine.advance(state, params, 1e7, seen, after, rows)
    seen, after, rows = seen[:count], after[:count], rows[:count]
    nodes = nodes_of(engine, params, seen, after, rows)
    nodes[:, 0] += TWO_PI * base
    listed, listed_modes = (np.concatenate([of[1:], of[:1]] * times) for of in (codes, modes))
    wrong = (seen != listed[:count]) | ((after != listed_modes[:count]) & (seen != HOLD))
    if wrong.any():
        i = int(np.argmax(wrong))
        return Round(nodes[: i + 1], _difference(i, listed[i], listed_modes[i], seen[i], after[i]))
    if count < wanted:
        why = {FAILED: "the motion is not finite", TIME_REACHED: "no event came"}.get(
            status, "the motion came to rest"
        )
        return Round(nodes, f"after {count} events {why}, where {LETTERS[listed[count]]} was listed")
    return Round(nodes, "")


def _difference(place: int, listed: int, listed_mode: int, seen: int, mode: int) -> str:
    if listed == seen:
        return f"event {place + 1} ({LETTERS[seen]}) leads into mode {mode:+d}, listed was {listed_mode:+d}"
    return f"event {place + 1} is {LETTERS[seen]}, listed was {LETTERS[listed]}"


def monodromy(
    engine: Machine,
    params: np.ndarray,
    codes: np.ndarray,
    modes: np.ndarray,
    node: np.ndarray,
    step: float = 1e-5,
) -> np.ndarray | None:
    """Derivative of the return map at the first node, shape (NODE, NODE), by central differences, extrapolated once.

    Next to an impact of small speed the map is strongly curved: the step is shortened there.

    None if some displaced start goes through other events, however small the step.
    """
    n = len(node)
    result = np.empty((n, n))
    for j in range(n):
        best = np.inf
        for size in (step, 0.1 * step, 0.01 * step, 1e-3 * step):
            coarse = _slope(engine, params, codes, modes, node, j, size)
            fine = None if coarse is None else _slope(engine, params, codes, modes, node, j, 0.5 * size)
            if coarse is None or fine is None:
                continue
            error = float(np.abs(fine - coarse).max()) ** 2 + ROUNDING / size
            if error < best:
                best, result[:, j] = error, (4.0 * fine - coarse) / 3.0
            if error < ENOUGH:
                break
        if best == np.inf:
            return None
    return result


def _slope(
    engine: Machine,
    params: np.ndarray,
    codes: np.ndarray,
    modes: np.ndarray,
    node: np.ndarray,
    j: int,
    size: float,
) -> np.ndarray | None:
    """Central difference of the return in entry `j` of the first node."""
    ends = []
    for sign in (1.0, -1.0):
        moved = np.array(node, dtype=float)
        moved[j] += sign * size
        there = go_round(engine, params, codes, modes, moved)
        if there.message:
            return None
        ends.append(there.nodes[-1])
    return (ends[0] - ends[1]) / (2.0 * size)


def cyclic_distance(a: np.ndarray, b: np.ndarray) -> float:
    """Largest difference of two node arrays, phases modulo 2 pi."""
    gap = a - b
    gap[:, 0] -= TWO_PI * np.round(gap[:, 0] / TWO_PI)
    return float(np.abs(gap).max()) if gap.size else 0.0
