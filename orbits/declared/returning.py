"""Cycles of a forced declared machine, stable or not, that Newton's method on its return map reaches from drawn starts."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from orbits.attractors.fixed_points import fixed_point
from orbits.contacts.letters import HOLD, RELEASE
from orbits.declared.attractor import solved
from orbits.declared.orbit import DeclaredOrbit
from orbits.declared.simulation import collect
from orbits.declared.stepper import TWO_PI, SimulationError, Stepper

WARM = 3  # forcing periods of each start, after which the search begins
EVENTS = 400  # in a forcing period at most
ONE = 1e-5  # largest difference of two points that are one, relative to the box
FAR = 0.01  # largest distance of a cycle from what was found, relative to 1 + states


def returning_cycles(
    stepper: Stepper, starts: np.ndarray, box: np.ndarray, longest: int
) -> Iterator[DeclaredOrbit]:
    """Cycles of up to `longest` forcing periods with events, each once; see `orbits.attractors.returning`.

    Parameters
    ----------
    stepper : Stepper
        Of the machine; it is moved about.
    starts : float array (n, 1 + d)
        Phase and states.
    box : float array (1 + d, 2)
        Smallest and largest value of these.
    longest : int

    Yields
    ------
    DeclaredOrbit
        A cycle, which may be unstable.
    """
    states = box[1:]
    size = states[:, 1] - states[:, 0]
    known = np.empty((0, len(states)))
    soft = np.zeros(len(states), dtype=bool)  # a start within a wall is refused by the simulation
    for start in starts:
        begin = _later(stepper, start[1:], float(start[0]), TWO_PI * WARM)
        for count in range(1, longest + 1):
            x = fixed_point(lambda y, n=count: _later(stepper, y, 0.0, TWO_PI * n), begin, states, soft)
            if x is None or np.any(np.abs((known - x) / size).max(axis=1) < ONE):
                continue
            points = [x]
            for _ in range(count - 1):
                points.append(_later(stepper, points[-1], 0.0, TWO_PI))
            known = np.concatenate([known, points])
            again = np.abs((np.array(points[1:]).reshape(-1, len(x)) - x) / size).max(axis=1) < ONE
            found = _solved(stepper, x, int(np.argmax(again)) + 1 if again.any() else count)
            if found is not None:
                yield found


def _later(stepper: Stepper, x: np.ndarray, phase: float, until: float) -> np.ndarray:
    """The states at a later clock; NaN where the motion does not get there."""
    try:
        stepper.start(x, phase)
        while stepper.advance(until) is not None:
            pass
    except SimulationError:
        return np.full(len(x), np.nan)
    return stepper.state.copy()


def _solved(stepper: Stepper, x: np.ndarray, periods: int) -> DeclaredOrbit | None:
    """The cycle through states at phase zero as an orbit; None if it is none that can be continued."""
    stepper.start(x, 0.0)
    try:
        run = collect(stepper, TWO_PI * periods, EVENTS * periods)
    except SimulationError:
        return None
    kinds = {kind for _, kind, _ in run.events}
    if not run.events or kinds & {HOLD, RELEASE}:
        return None
    return solved(run, len(run.events), periods, FAR)
