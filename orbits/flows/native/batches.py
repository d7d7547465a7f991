"""Simulate many motions at once: each is run until its state recurs from one forcing phase to the next."""

from __future__ import annotations

import math
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from threading import Event
from typing import NamedTuple

import numpy as np

from contvines.core.library import NOTHING, NUMBER, POINTER, WHOLE, address, function
from contvines.shared.motions import mean_of_blocks
from orbits.flows.protocol import Outcome
from orbits.machines.native_stepper import floats, number, stepper, written
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
    Stepper,
    W,
    buffers,
)
from orbits.settings import SIMULATING

SETTLED, AT_REST, LOST, WANDERING = Outcome.SETTLED, Outcome.AT_REST, Outcome.LOST, Outcome.WANDERING
GROWTH = 4000  # forcing periods over which the growth of small differences is measured

BLOCKS = 19  # blocks of equal length after the first twentieth of the periods
BLOCK = 512  # motions per task of a thread
BUFFER = 1024  # events (or periods of growth) per call of the stepper
WORK = 8000.0  # events and periods of one native call: interrupts take effect between two calls
RESULTS = ("periods", "impacts", "holds", "gaps", "outcome")


class Interrupted(Exception):
    """Another thread has been interrupted."""


class Settling(NamedTuple):
    """Settings for running motions until they recur.

    Attributes
    ----------
    engine : Stepper
    params : ndarray, shape (P,)
    transient : float
        Forcing periods before the search for a recurrence.
    longest : int
        Forcing periods of the longest recurrence.
    tolerance : float
        Largest difference of two states that counts as a return.
    """

    engine: Stepper
    params: np.ndarray
    transient: float
    longest: int
    tolerance: float

    def settle(self, states: np.ndarray, found: dict[str, np.ndarray], stopped: Event | None = None) -> None:
        """Run every motion that is still wandering until it recurs, rests or is lost.

        Parameters
        ----------
        states : ndarray, shape (n, S)
            Changed in place.
        found : dict of ndarray
            Results as in `settle_all`, changed in place.
        stopped : Event, optional
            Raises `Interrupted` between two motions once it is set.
        """
        begin, machine = 0, number(self.engine.name)
        while begin < len(states):
            if stopped is not None and stopped.is_set():
                raise Interrupted
            if machine is not None:
                begin = self._natively(machine, begin, states, found)
                continue
            if found["outcome"][begin] == WANDERING:
                self._settle_one(states[begin], begin, found)
            begin += 1

    def _natively(self, machine: int, begin: int, states: np.ndarray, found: dict[str, np.ndarray]) -> int:
        """Run some motions from number `begin` on in the native core; return the number of the next one."""
        work = function(
            "simulation_settle", WHOLE, WHOLE, WHOLE, WHOLE, POINTER, POINTER, NUMBER, WHOLE, NUMBER, *[POINTER] * 5, NUMBER
        )  # fmt: skip
        results = [written(found[name]) for name in RESULTS]
        settings = address(self.params), self.transient, self.longest, self.tolerance
        return work(machine, begin, len(states), written(states), *settings, *results, WORK)

    def _settle_one(self, state: np.ndarray, i: int, found: dict[str, np.ndarray]) -> None:
        """Run motion number i in plain Python: the reference of `native/many_starts.hpp`."""
        engine, params, room = self.engine, self.params, buffers(self.engine, BUFFER)
        if state[TURNS] < 0.5:
            engine.launch(state, params)
        until = np.floor(state[TURNS] + state[PSI] / (2.0 * np.pi) + 0.5) + self.transient
        status, _, _ = _follow(engine, state, params, until, room)
        first = state.copy()
        looked_at = [c for c in range(W, engine.state) if c not in (TURNS, LOW)]
        hits, held, k = 0, 0, 0
        if status not in (REST, FAILED):
            found["gaps"][i] = np.inf
        while status not in (REST, FAILED) and k < self.longest:
            k += 1
            status, more, piled = _follow(engine, state, params, until + k, room)
            if status in (REST, FAILED):
                break
            hits, held = hits + more, held + piled
            gap = np.abs(state[looked_at] - first[looked_at]).max()
            found["gaps"][i] = min(found["gaps"][i], gap)
            if gap < self.tolerance:
                found["periods"][i], found["impacts"][i], found["holds"][i] = k, hits, held
                found["outcome"][i] = SETTLED
                break
        if status in (REST, FAILED):
            found["outcome"][i] = AT_REST if status == REST else LOST


def _follow(
    engine: Stepper,
    state: np.ndarray,
    params: np.ndarray,
    until: float,
    room: tuple[np.ndarray, np.ndarray, np.ndarray],
) -> tuple[int, int, int]:
    """Run on to a time; return the status, the number of impacts, and how often impacts accumulated."""
    hits, held, status = 0, 0, EVENTS_FULL
    while status == EVENTS_FULL:
        count, status = engine.advance(state, params, until, *room)
        hits += int(np.count_nonzero(room[0][:count] < 2))
        held += int(np.count_nonzero(room[0][:count] == HOLD))
    return status, hits, held


def growth(engine: Stepper, state: np.ndarray, params: np.ndarray, count: int) -> np.ndarray:
    """Return factors by which the distance to a neighbouring motion grows in each forcing period, shape (count,).

    The neighbour stays between the walls and is moved back to its first distance once per period.
    """
    ratios, other, distance = np.empty(count), state.copy(), SIMULATING.nudge
    left, right = (float(wall) for wall in engine.walls(params))
    machine = number(engine.name)
    if machine is not None:
        work = function(
            "simulation_growth", NOTHING, WHOLE, POINTER, POINTER, POINTER, NUMBER, NUMBER, WHOLE, WHOLE, NUMBER, POINTER
        )  # fmt: skip
        params = floats(params)
        arrays = written(state), written(other), address(params)
        for begin in range(0, count, BUFFER):
            end = min(begin + BUFFER, count)
            work(machine, *arrays, left, right, begin, end, distance, address(ratios))
        return ratios
    # the reference of `native/many_starts.hpp`
    room = buffers(engine, BUFFER)
    drawn_back = [c for c in range(W, engine.state) if c not in (MODE, TURNS, LOW)]
    other[W] -= distance * np.sign(other[W])
    other[RATE] += distance * 0.5
    engine.launch(other, params)
    for k in range(len(ratios)):
        until = np.floor(state[TURNS] + state[PSI] / (2.0 * np.pi) + 0.5) + 1.0
        for one in (state, other):
            _follow(engine, one, params, until, room)
        separation = other[drawn_back] - state[drawn_back]
        size = math.sqrt(float(separation @ separation))
        if size == 0.0:  # both motions stick and have become equal: separate them again
            ratios[k] = SIMULATING.lost_growth
            other[RATE] = state[RATE] + distance
        else:
            ratios[k] = size / distance
            other[drawn_back] = state[drawn_back] + distance / size * separation
        other[[PSI, TURNS, LOW]] = state[[PSI, TURNS, LOW]]
        other[W] = min(max(other[W], right), left)
        engine.launch(other, params)
    return ratios


def settle_all(
    name: str,
    states: np.ndarray,
    params: np.ndarray,
    *,
    transients: Sequence[float],
    longest: int,
    tolerance: float,
    workers: int,
) -> dict[str, np.ndarray]:
    """Run all motions until they recur, with one transient after another; `states` (n, S) is changed in place.

    The result of each motion depends on its start alone, so it is the same for any number of workers.

    Returns
    -------
    dict of arrays (n,)
        ``outcome``; ``periods``, ``impacts`` and ``holds`` of one recurrence; ``gaps``, the smallest difference of a return.
    """
    n = len(states)
    found = {
        "periods": np.zeros(n, np.int64),
        "impacts": np.zeros(n, np.int64),
        "holds": np.zeros(n, np.int64),
        "gaps": np.full(n, np.inf),
        "outcome": np.zeros(n, np.int64),
    }
    engine, stopped = stepper(name), Event()

    def run(block: np.ndarray, transient: float) -> None:
        part, pieces = states[block], {key: column[block] for key, column in found.items()}
        settling = Settling(engine, floats(params), transient, longest, tolerance)
        settling.settle(part, pieces, stopped)
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
                    stopped.set()  # otherwise the pool waits for all threads
                    raise
    return found


def lyapunov(name: str, state: np.ndarray, params: np.ndarray, periods: int = GROWTH) -> tuple[float, float]:
    """Return the largest Lyapunov exponent per forcing period and its standard error, from blocks of logarithms of the growth.

    A neighbour at a distance of 1e-7 is moved back once per period (Benettin et al., Meccanica 15 (1980) 9). The error is that of the mean
    over 19 blocks, which are long compared with the memory of the motion.
    """
    logs = np.log(growth(stepper(name), state.copy(), params, periods))[periods // 20 :]
    return mean_of_blocks(logs[: BLOCKS * (len(logs) // BLOCKS)], BLOCKS)
