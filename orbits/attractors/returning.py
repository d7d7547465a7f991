"""Cycles of a machine, stable or not, that Newton's method on its return map reaches from drawn starts."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from orbits.attractors.attractor import Attractor
from orbits.attractors.fixed_points import fixed_point
from orbits.attractors.recurrence import EVENTS_PER_PERIOD, recurring
from orbits.machines.stepping import FAILED, HOLD, PSI, REST, TURNS, Machine
from orbits.simulation.driver import buffers, collect, skip

WARM = (
    3.0  # forcing periods of each start, after which the search begins: what is never reached again is left
)
ONE = 1e-5  # largest difference of two points that are one, relative to the box
SOLVED = 1e-8  # largest residual of a cycle


def returning_cycles(
    model: Any, engine: Machine, params: np.ndarray, states: np.ndarray, box: np.ndarray, longest: int
) -> Iterator[Attractor]:
    """Cycles of up to `longest` forcing periods with impacts, each once.

    Parameters
    ----------
    model : Model
    engine : Machine
        Its compiled simulation.
    params : float array (P,)
    states : float array (n, S)
        Where to begin; they are moved on.
    box : float array (d, 2)
        Smallest and largest value of the coordinates but the phase, as in `Population.box`.
    longest : int

    Yields
    ------
    Attractor
        A cycle, which may be unstable.

    Notes
    -----
    A cycle is a fixed point of the n-th iterate of the return map, and the points from which Newton's method reaches it fill a far
    larger part of the box than those from which the motion itself settles on it (of an unstable one: none). A machine with a mirror is
    looked at every half period and mirrored, so that a symmetric cycle of odd period takes half as long.
    """
    flow = _Flow(engine, params, 0.5 if model.has_mirror(params) else 1.0)
    known = np.empty((0, len(box)))
    size = box[:, 1] - box[:, 0]
    hard = np.arange(len(box)) == 0  # the walls
    for state in states:
        begin = flow.warm(state)
        if begin is None:
            continue
        for count in range(1, round(longest / flow.length) + 1):
            x = fixed_point(lambda y, n=count: flow.ahead(y, n), begin, box, hard)
            if x is None or np.any(np.abs((known - x) / size).max(axis=1) < ONE):
                continue
            points = flow.round(x, count)
            known = np.concatenate([known, points])
            again = np.abs((points[1:] - x) / size).max(axis=1, initial=0.0) < ONE
            prime = int(np.argmax(again)) + 1 if again.any() else count
            periods = prime if prime % 2 or flow.length == 1.0 else prime // 2
            found = _solved(model, engine, params, flow.state(x), periods)
            if found is not None:
                yield found


def _solved(
    model: Any, engine: Machine, params: np.ndarray, state: np.ndarray, periods: int
) -> Attractor | None:
    """The polished cycle through a state; None if it is none that can be continued."""
    most = EVENTS_PER_PERIOD * periods
    codes, modes, rows, status = collect(engine, state, params, float(periods), most)
    if status in (REST, FAILED) or len(codes) == most or np.any(codes == HOLD) or not np.any(codes < 2):
        return None
    found = recurring(model, engine, params, codes, modes, rows, periods)
    return found if found.residual < SOLVED and found.word is not None else None


class _Flow:
    """The motion seen whenever the forcing passes phase zero, or every half period and every other time mirrored."""

    def __init__(self, engine: Machine, params: np.ndarray, length: float) -> None:
        self.engine, self.params, self.length = engine, params, length
        self.places = list(engine.places)
        self.left, self.right = (float(wall) for wall in engine.walls(params))
        self.scratch = buffers(engine, 64)

    def warm(self, state: np.ndarray) -> np.ndarray | None:
        """Where a start passes phase zero after a few periods; None if it comes to rest or is lost."""
        self.engine.launch(state, self.params)
        begin = np.floor(state[TURNS] + state[PSI] / (2.0 * np.pi)) + WARM
        return state[self.places] if self._until(state, begin) else None

    def state(self, x: np.ndarray) -> np.ndarray:
        """The simulation's state at phase zero."""
        state = np.zeros(self.engine.state)
        state[self.places] = x
        self.engine.launch(state, self.params)
        return state

    def ahead(self, x: np.ndarray, count: int) -> np.ndarray:
        """So many lengths later."""
        state = self.state(x)
        if not (self.right <= x[0] <= self.left and self._until(state, count * self.length)):
            return np.full(len(x), np.nan)
        x = state[self.places]
        return -x if self.length == 0.5 and count % 2 else x

    def round(self, x: np.ndarray, count: int) -> np.ndarray:
        """x and its next images, shape (count, d)."""
        points = [x]
        for _ in range(count - 1):
            points.append(self.ahead(points[-1], 1))
        return np.array(points)

    def _until(self, state: np.ndarray, until: float) -> bool:
        status = skip(
            self.engine, state, self.params, until, int(EVENTS_PER_PERIOD * (until + 1.0)), self.scratch
        )
        return (
            status != FAILED and abs(float(state[TURNS]) + float(state[PSI]) / (2.0 * np.pi) - until) < 1e-9
        )
