"""Cycles of a machine, stable or not, that Newton's method on its return map reaches from drawn starts."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from orbits.attractors.fixed_points import fixed_point
from orbits.flows.protocol import SimulationError, Simulator, later
from orbits.flows.trajectory import Trajectory
from orbits.orbit import Orbit
from orbits.settings import SIMULATING

Solve = Callable[[Trajectory, int, int, int], Orbit | None]
"""(record, first, last, periods) -> the cycle next to these events of a record, or None."""

WARM = (
    3.0  # forcing periods of each start, after which the search begins: what is never reached again is left
)
EVENTS = 400  # in a forcing period at most


def returning_cycles(
    simulator: Simulator,
    starts: np.ndarray,
    box: np.ndarray,
    longest: int,
    solve: Solve,
) -> Iterator[Orbit]:
    """Cycles of up to `longest` forcing periods with events, each once.

    Parameters
    ----------
    simulator : Simulator
        Of a forced machine.
    starts : float array (n, 1 + d)
        Phase and coordinates.
    box : float array (1 + d, 2)
        Smallest and largest value of these.
    longest : int
    solve : callable
        ``(record, first, last, periods)`` -> the cycle next to these events of a record, or None.

    Yields
    ------
    Orbit
        A cycle, which may be unstable.

    Notes
    -----
    A cycle is a fixed point of the n-th iterate of the return map, and the points from which Newton's method reaches it fill a far
    larger part of the box than those from which the motion itself settles on it (of an unstable one: none). A machine with a mirror is
    looked at every half period and mirrored, so that a symmetric cycle of odd period takes half as long.
    """
    box = box[1:]
    length, size = (0.5 if simulator.mirrored else 1.0), box[:, 1] - box[:, 0]
    known = np.empty((0, len(box)))

    def ahead(x: np.ndarray, count: int) -> np.ndarray:
        """So many lengths later."""
        there = later(simulator, x, count * length)
        return simulator.image(there) if length == 0.5 and count % 2 else there

    for start in starts:
        time = float(start[0]) / (2.0 * np.pi)
        begin = later(simulator, start[1:], np.floor(time) + WARM - time, time)
        if not np.isfinite(begin).all():
            continue
        for count in range(1, round(longest / length) + 1):
            x = fixed_point(lambda y, n=count: ahead(y, n), begin, box, simulator.hard)
            if x is None or np.any(np.abs((known - x) / size).max(axis=1) < SIMULATING.same):
                continue
            points = [x]
            for _ in range(count - 1):
                points.append(ahead(points[-1], 1))
            known = np.concatenate([known, points])
            again = (
                np.abs((np.array(points[1:]).reshape(-1, len(x)) - x) / size).max(axis=1) < SIMULATING.same
            )
            prime = int(np.argmax(again)) + 1 if again.any() else count
            found = _solved(simulator, x, prime if prime % 2 or length == 1.0 else prime // 2, solve)
            if found is not None:
                yield found


def _solved(simulator: Simulator, x: np.ndarray, periods: int, solve: Solve) -> Orbit | None:
    """The cycle through a point; None if it is none that can be continued."""
    try:
        simulator.start(x)
        record = simulator.run(float(periods), EVENTS * periods)
    except SimulationError:
        return None
    if not record.whole or not len(record) or record.piled.any():
        return None
    return solve(record, 0, len(record), periods)
