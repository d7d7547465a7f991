"""Many motions at once: each is run until its state recurs from one forcing phase to the next."""

from __future__ import annotations

import math
from concurrent.futures import ThreadPoolExecutor
from threading import Event

import numpy as np

from contvines.core.library import NOTHING, NUMBER, POINTER, WHOLE, address, function, native
from orbits.flows.protocol import Outcome
from orbits.machines.catalogue import stepper as machine
from orbits.machines.native_stepper import NUMBERS, floats, written
from orbits.machines.stepping import (
    EVENTS_FULL,
    FAILED,
    HOLD,
    LOW,
    MODE,
    PSI,
    RATE,
    REST,
    TURNS,
    Machine,
    W,
)
from orbits.settings import SIMULATING
from orbits.simulation.driver import buffers

SETTLED, AT_REST, LOST, WANDERING = Outcome.SETTLED, Outcome.AT_REST, Outcome.LOST, Outcome.WANDERING
GROWTH = 4000  # forcing periods over which the growth of small differences is followed

BLOCK = 512  # motions that one thread takes at a time
BUFFER = 1024  # events kept between two looks
WORK = 8000.0  # events and periods of one native call: an interrupt is seen between two calls
RESULTS = ("periods", "impacts", "holds", "gaps", "outcome")


class Interrupted(Exception):
    """Another thread has been interrupted."""


def settle(
    engine: Machine,
    states: np.ndarray,
    params: np.ndarray,
    transient: float,
    longest: int,
    tolerance: float,
    found: dict[str, np.ndarray],
    stopped: Event | None = None,
) -> None:
    """Run every motion that is still wandering until it recurs, rests or is lost.

    Parameters
    ----------
    engine : Machine
    states : ndarray, shape (n, S)
        Moved along.
    params : ndarray, shape (P,)
    transient : float
        Forcing periods before a recurrence is looked for.
    longest : int
        Forcing periods of the longest recurrence.
    tolerance : float
        Largest difference of two states that counts as a return.
    found : dict of ndarray
        As in `settle_all`, filled.
    stopped : Event, optional
        Ends the work with `Interrupted` when it is set.
    """
    count, begin = len(states), 0
    while begin < count:
        if stopped is not None and stopped.is_set():
            raise Interrupted
        if native():
            begin = _settle_native(
                engine, begin, states, floats(params), transient, longest, tolerance, found
            )
        else:
            if found["outcome"][begin] == WANDERING:
                _settle_one(engine, begin, states[begin], params, transient, longest, tolerance, found)
            begin += 1


def _settle_native(
    engine: Machine,
    begin: int,
    states: np.ndarray,
    params: np.ndarray,
    transient: float,
    longest: int,
    tolerance: float,
    found: dict[str, np.ndarray],
) -> int:
    """Some motions from number `begin` on; the number of the next one."""
    work = function(
        "simulation_settle", WHOLE, WHOLE, WHOLE, WHOLE, POINTER, POINTER, NUMBER, WHOLE, NUMBER, *[POINTER] * 5, NUMBER
    )  # fmt: skip
    results = [written(found[name]) for name in RESULTS]
    number = NUMBERS[engine.name]
    return work(
        number,
        begin,
        len(states),
        written(states),
        address(params),
        transient,
        longest,
        tolerance,
        *results,
        WORK,
    )


def _settle_one(
    engine: Machine,
    i: int,
    state: np.ndarray,
    params: np.ndarray,
    transient: float,
    longest: int,
    tolerance: float,
    found: dict[str, np.ndarray],
) -> None:
    """Motion number i in plain Python: the reference of `native/many_starts.hpp`."""
    room = buffers(engine, BUFFER)
    if state[TURNS] < 0.5:
        engine.launch(state, params)
    until = np.floor(state[TURNS] + state[PSI] / (2.0 * np.pi) + 0.5) + transient
    status, _, _ = _follow(engine, state, params, until, room)
    first = state.copy()
    looked_at = [c for c in range(W, engine.state) if c not in (TURNS, LOW)]
    hits, held, k = 0, 0, 0
    if status not in (REST, FAILED):
        found["gaps"][i] = np.inf
    while status not in (REST, FAILED) and k < longest:
        k += 1
        status, more, piled = _follow(engine, state, params, until + k, room)
        if status in (REST, FAILED):
            break
        hits, held = hits + more, held + piled
        gap = np.abs(state[looked_at] - first[looked_at]).max()
        found["gaps"][i] = min(found["gaps"][i], gap)
        if gap < tolerance:
            found["periods"][i], found["impacts"][i], found["holds"][i] = k, hits, held
            found["outcome"][i] = SETTLED
            break
    if status in (REST, FAILED):
        found["outcome"][i] = AT_REST if status == REST else LOST


def _follow(
    engine: Machine,
    state: np.ndarray,
    params: np.ndarray,
    until: float,
    room: tuple[np.ndarray, np.ndarray, np.ndarray],
) -> tuple[int, int, int]:
    """Run on to a time; the status, impacts and impacts that have piled up."""
    hits, held, status = 0, 0, EVENTS_FULL
    while status == EVENTS_FULL:
        count, status = engine.advance(state, params, until, *room)
        hits += int(np.count_nonzero(room[0][:count] < 2))
        held += int(np.count_nonzero(room[0][:count] == HOLD))
    return status, hits, held


def growth(
    engine: Machine,
    state: np.ndarray,
    params: np.ndarray,
    left: float,
    right: float,
    count: int,
    distance: float,
) -> np.ndarray:
    """Follow a motion and a neighbour between the walls, drawn back to it once a forcing period; growth factors, shape (count,)."""
    ratios, other = np.empty(count), state.copy()
    if not native():
        _growth(engine, state, other, params, left, right, distance, ratios)
        return ratios
    work = function(
        "simulation_growth", NOTHING, WHOLE, POINTER, POINTER, POINTER, NUMBER, NUMBER, WHOLE, WHOLE, NUMBER, POINTER
    )  # fmt: skip
    params = floats(params)
    arrays = written(state), written(other), address(params)
    for begin in range(0, count, BUFFER):
        end = min(begin + BUFFER, count)
        work(NUMBERS[engine.name], *arrays, left, right, begin, end, distance, address(ratios))
    return ratios


def _growth(
    engine: Machine,
    state: np.ndarray,
    other: np.ndarray,
    params: np.ndarray,
    left: float,
    right: float,
    distance: float,
    ratios: np.ndarray,
) -> None:
    """The same in plain Python: the reference of `native/many_starts.hpp`."""
    room = buffers(engine, BUFFER)
    drawn_back = [c for c in range(W, engine.state) if c not in (MODE, TURNS, LOW)]
    other[W] -= distance * np.sign(other[W])
    other[RATE] += distance * 0.5
    engine.launch(other, params)
    for k in range(len(ratios)):
        until = np.floor(state[TURNS] + state[PSI] / (2.0 * np.pi) + 0.5) + 1.0
        for one in (state, other):
            _follow(engine, one, params, until, room)
        apart = other[drawn_back] - state[drawn_back]
        size = math.sqrt(float(apart @ apart))
        if size == 0.0:  # a stick has lost the difference: give it one again
            ratios[k] = SIMULATING.lost
            other[RATE] = state[RATE] + distance
        else:
            ratios[k] = size / distance
            other[drawn_back] = state[drawn_back] + distance / size * apart
        other[[PSI, TURNS, LOW]] = state[[PSI, TURNS, LOW]]
        other[W] = min(max(other[W], right), left)
        engine.launch(other, params)


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
    engine, stopped = machine(name), Event()

    def run(block: np.ndarray, transient: float) -> None:
        part, pieces = states[block], {key: column[block] for key, column in found.items()}
        settle(engine, part, params, transient, longest, tolerance, pieces, stopped)
        states[block] = part
        for key, piece in pieces.items():
            found[key][block] = piece

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
                try:
                    list(pool.map(run, blocks, [float(transient)] * len(blocks)))
                except BaseException:
                    stopped.set()  # else the pool waits until all threads are done
                    raise
    return found


def lyapunov(name: str, state: np.ndarray, params: np.ndarray, periods: int = GROWTH) -> tuple[float, float]:
    """Largest Lyapunov exponent per forcing period and its standard error, from blocks of the growth's logarithms.

    A neighbour 1e-7 away is drawn back once a period (Benettin et al., Meccanica 15 (1980) 9). The error is that of
    the mean over 20 blocks, which are long against the memory of the motion.
    """
    engine = machine(name)
    left, right = engine.walls(params)
    logs = np.log(growth(engine, state.copy(), params, float(left), float(right), periods, SIMULATING.nudge))
    blocks = logs[periods // 20 :]
    means = blocks[: 19 * (len(blocks) // 19)].reshape(19, -1).mean(axis=1)
    return float(means.mean()), float(means.std(ddof=1) / np.sqrt(len(means)))
