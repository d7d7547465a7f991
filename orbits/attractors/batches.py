"""Many motions at once, compiled: each is run until its state recurs from one forcing phase to the next."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from functools import cache
from typing import Any

import numpy as np

from orbits.compiling.decorators import specialise
from orbits.compiling.waiting import wait_for
from orbits.machines.stepping import EVENTS_FULL, FAILED, HOLD, MODE, RATE, REST, V, W
from orbits.simulation.driver import machine

SETTLED, AT_REST, LOST, WANDERING = 1, 2, 3, 0
"""What became of a motion: it recurs, is at rest for ever, left the range of numbers, or does none of these yet."""

BLOCK = 512  # motions that one thread takes at a time
BUFFER = 1024  # events kept between two looks


# filled in per machine by `specialise`: its stepper, the length of its states and of its event rows
launch: Any = None
advance: Any = None
width: Any = None
rows_width: Any = None


def _settle(states, params, transient, longest, tolerance, periods, impacts, holds, gaps, outcome):
    """Run every motion that is still wandering until it recurs, rests or is lost."""
    codes = np.empty(BUFFER, np.int8)
    modes = np.empty(BUFFER, np.int8)
    rows = np.empty((BUFFER, rows_width))
    first = np.empty(width)
    for i in range(states.shape[0]):
        state = states[i]
        if outcome[i] != WANDERING:
            continue
        if state[4] < 0.5:
            launch(state, params)
        start = np.floor(state[4] + state[0] / (2.0 * np.pi) + 0.5)
        until = start + transient
        status = EVENTS_FULL
        while status == EVENTS_FULL:
            _, status = advance(state, params, until, codes, modes, rows)
        if status == REST:
            outcome[i] = AT_REST
            continue
        if status == FAILED:
            outcome[i] = LOST
            continue
        for c in range(width):  # numba compiles the sentence of a wrong shape with every whole assignment
            first[c] = state[c]
        hits, held, gaps[i] = 0, 0, np.inf
        for k in range(1, longest + 1):
            status = EVENTS_FULL
            while status == EVENTS_FULL:
                count, status = advance(state, params, until + k, codes, modes, rows)
                for j in range(count):
                    if codes[j] < 2:
                        hits += 1
                    elif codes[j] == HOLD:
                        held += 1
            if status == REST:
                outcome[i] = AT_REST
                break
            if status == FAILED:
                outcome[i] = LOST
                break
            gap = abs(state[W] - first[W])
            gap = max(gap, abs(state[RATE] - first[RATE]))
            gap = max(gap, abs(state[MODE] - first[MODE]))
            for c in range(V, width):
                gap = max(gap, abs(state[c] - first[c]))
            if gap < gaps[i]:
                gaps[i] = gap
            if gap < tolerance:
                periods[i], impacts[i], holds[i], outcome[i] = k, hits, held, SETTLED
                break


def _growth(state, params, left, right, count, distance, logs):
    """Follow a motion and a neighbour between the walls, drawn back to it once a forcing period."""
    codes = np.empty(BUFFER, np.int8)
    modes = np.empty(BUFFER, np.int8)
    rows = np.empty((BUFFER, rows_width))
    other = state.copy()
    other[W] -= distance * np.sign(other[W])
    other[RATE] += distance * 0.5
    launch(other, params)
    now = np.floor(state[4] + state[0] / (2.0 * np.pi) + 0.5)
    for k in range(count):
        for one in (state, other):
            status = EVENTS_FULL
            while status == EVENTS_FULL:
                _, status = advance(one, params, now + k + 1.0, codes, modes, rows)
        apart = (other[W] - state[W]) ** 2 + (other[RATE] - state[RATE]) ** 2
        for c in range(V, width):
            apart += (other[c] - state[c]) ** 2
        apart = np.sqrt(apart)
        if apart == 0.0:
            apart = 1e-3 * distance  # a stick has lost the difference: give it one again
            logs[k] = np.log(1e-3)
            other[RATE] = state[RATE] + distance
        else:
            logs[k] = np.log(apart / distance)
            ratio = distance / apart
            other[W] = state[W] + ratio * (other[W] - state[W])
            other[RATE] = state[RATE] + ratio * (other[RATE] - state[RATE])
            for c in range(V, width):
                other[c] = state[c] + ratio * (other[c] - state[c])
        other[0], other[4], other[5] = state[0], state[4], state[5]
        other[W] = min(max(other[W], right), left)
        launch(other, params)


@cache
def _with_stepper(function: Any, name: str) -> Any:
    engine = machine(name)
    stamp = f"{name}_{engine.advance.py_func.__qualname__.rpartition('_')[2]}"  # the digest of the stepper's sources
    return specialise(
        function,
        stamp,
        options={"error_model": "numpy", "nogil": True},
        advance=engine.advance,
        launch=engine.launch,
        width=engine.state,
        rows_width=engine.row,
    )


def settle_kernel(name: str) -> Any:
    """The compiled loop over motions of the machine called `name`."""
    kernel = _with_stepper(_settle, name)
    wait_for(name, kernel)
    return kernel


def lyapunov_kernel(name: str) -> Any:
    """The compiled loop that follows a motion and a neighbour of the machine called `name`."""
    return _with_stepper(_growth, name)


def settle_all(
    name: str,
    states: np.ndarray,
    params: np.ndarray,
    *,
    transients: tuple[float, ...],
    longest: int,
    tolerance: float,
    workers: int,
) -> dict[str, np.ndarray]:
    """Run all motions until they recur, for one transient after the other; `states` (n, S) is moved along.

    The result of each motion depends on its start alone, so that it is the same for any number of workers.

    Returns
    -------
    dict of arrays (n,)
        ``outcome``, ``periods``, ``impacts`` and ``holds`` of one recurrence, ``gaps`` (least distance of a return).
    """
    n = len(states)
    found = {
        "periods": np.zeros(n, np.int64),
        "impacts": np.zeros(n, np.int64),
        "holds": np.zeros(n, np.int64),
        "gaps": np.full(n, np.inf),
        "outcome": np.zeros(n, np.int64),
    }
    kernel = settle_kernel(name)
    columns = [found[key] for key in ("periods", "impacts", "holds", "gaps", "outcome")]

    def run(block: np.ndarray, transient: float) -> None:
        part = np.ascontiguousarray(states[block])
        pieces = [np.ascontiguousarray(column[block]) for column in columns]
        kernel(part, params, transient, longest, tolerance, *pieces)
        states[block] = part
        for column, piece in zip(columns, pieces, strict=True):
            column[block] = piece

    for transient in transients:
        left = np.flatnonzero(found["outcome"] == WANDERING)
        if not left.size:
            break
        blocks = [left[i : i + BLOCK] for i in range(0, left.size, BLOCK)]
        if workers == 1 or len(blocks) == 1:
            for block in blocks:
                run(block, float(transient))
        else:
            with ThreadPoolExecutor(workers) as pool:
                list(pool.map(run, blocks, [float(transient)] * len(blocks)))
    return found


def lyapunov(name: str, state: np.ndarray, params: np.ndarray, periods: int = 4000) -> tuple[float, float]:
    """Largest Lyapunov exponent per forcing period and its standard error, from blocks of the growth's logarithms.

    A neighbour 1e-7 away is drawn back once a period (Benettin et al., Meccanica 15 (1980) 9). The error is that of
    the mean over 20 blocks, which are long against the memory of the motion.
    """
    logs = np.empty(periods)
    left, right = machine(name).walls(params)
    lyapunov_kernel(name)(state.copy(), params, float(left), float(right), periods, 1e-7, logs)
    blocks = logs[periods // 20 :]
    means = blocks[: 19 * (len(blocks) // 19)].reshape(19, -1).mean(axis=1)
    return float(means.mean()), float(means.std(ddof=1) / np.sqrt(len(means)))
