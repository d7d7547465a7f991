"""Creep: a motion without impacts that comes back after some periods but for a little way along the cavity.

Where friction holds less one way than the other (a slope, unlike walls' frictions) the absorber slips a little further in every period.
Between the walls all places are alike as long as the cavity moves as prescribed, so each time the way is the same, and the motion may be
moved on by as many of these ways as there is room for: what it settles on is decided at the wall.
"""

from __future__ import annotations

import math

import numpy as np

from orbits.flows.trajectory import TWO_PI
from orbits.machines.stepping import HOLD, Stepper, W
from orbits.settings import EVENTS, SIMULATING


def creep(nodes: np.ndarray, codes: np.ndarray, modes: np.ndarray, max_period: int) -> np.ndarray | None:
    """The ways from the last events' places to those before them, shape (events of a recurrence,); None where the motion does not creep.

    Parameters
    ----------
    nodes : ndarray, shape (n, NODE)
        Of a motion, phases counted through.
    codes, modes : ndarray of int, shape (n,)
    max_period : int
        Longest recurrence, in forcing periods.
    """
    n = len(codes)
    if n < 2 or codes.min() < 2 or codes.max() >= HOLD:
        return None
    for length in range(1, n // 2 + 1):
        here, before = slice(n - length, n), slice(n - 2 * length, n - length)
        if not (np.array_equal(codes[here], codes[before]) and np.array_equal(modes[here], modes[before])):
            continue
        shift = nodes[here, :2] - nodes[before, :2]
        periods = round(float(shift[-1, 0]) / TWO_PI)
        if periods > max_period:
            return None
        way = float(shift[-1, 1])
        late = np.abs(shift[:, 0] - TWO_PI * periods).max()
        uneven = np.abs(shift[:, 1] - way).max()
        if periods and abs(way) > EVENTS.zero and max(late, uneven) < SIMULATING.steady * abs(way):
            return shift[:, 1]
    return None


def move_on(
    engine: Stepper,
    params: np.ndarray,
    state: np.ndarray,
    nodes: np.ndarray,
    codes: np.ndarray,
    modes: np.ndarray,
    max_period: int,
) -> bool:
    """Move a creeping motion on to a wall, in place; whether it was moved."""
    ways = creep(nodes, codes, modes, max_period)
    if ways is None:
        return False
    left, right = engine.walls(params)
    places, way = nodes[-len(ways) :, 1], float(ways[-1])  # the turns and sticks are the furthest
    room = left - places.max() if way > 0.0 else right - places.min()
    times = math.floor(room / way) - 1
    if times < 1:
        return False
    state[W] += times * way
    return True
