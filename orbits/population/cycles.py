"""Find cycles of a machine, stable or not: near the returns of a chaotic motion, and by Newton's method on the return map from random starts."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from orbits.attractors.search import solved
from orbits.flows.protocol import SimulationError, Simulator, later
from orbits.flows.trajectory import Trajectory
from orbits.orbit import Orbit
from orbits.settings import SIMULATING, SOLVING

NEXT, WIDE = 0.01, 0.5
"""Largest distance of a cycle from its guess, relative to 1 + states: of a cycle through a fixed point, and near a return of a chaotic motion."""
NEAR = 0.1  # largest difference of a return, relative to the extent of the motion
TRIES = 3  # returns with the same list of events that are tried
PER_LENGTH = 200  # nearest returns of each length that are tried
LONGEST_WORD = 400  # events
PER_PERIOD = 4  # events of the longest cycle per period wanted, of a self-excited machine
ITERATIONS = 12  # of Newton's method
LONGEST = 0.2  # largest Newton step, relative to the box
SHORTER = 3  # halvings of a step to a point whose motion does not return
BEYOND = 0.5  # largest distance outside the box, relative to it
WARM = 3.0  # forcing periods simulated of each start before the search, to leave states that are never reached again
EVENTS = 400  # per forcing period at most


def embedded_cycles(simulator: Simulator, longest: int) -> Iterator[Orbit]:
    """Find cycles of up to `longest` forcing periods near the closest returns of a motion.

    Parameters
    ----------
    simulator : Simulator
        At a state of the motion; it is advanced.
    longest : int
        Longest cycle in forcing periods; of a self-excited machine a quarter of its number of events.

    Yields
    ------
    Orbit
        A cycle, usually unstable; the same one may be yielded more than once.

    Notes
    -----
    A chaotic motion returns close to each of its unstable cycles again and again; the piece between two close states is a guess
    for Newton's method (D. P. Lathrop and E. J. Kostelich, Phys. Rev. A 40 (1989) 4028).
    """
    periods, events = simulator.watched
    record = simulator.run(periods, events)
    marks = np.flatnonzero(record.hits) if record.hits.sum() > 1 else np.arange(len(record))
    if len(marks) < 2:
        return
    spread = np.ptp(record.points[marks], axis=0)
    spread[spread <= 0.0] = 1.0
    lengths = range(1, longest + 1) if simulator.forced else range(1)
    for length in lengths:
        tried: dict[tuple, int] = {}
        for i, j in _returns(record, marks, spread, length, PER_PERIOD * longest):
            if record.piled[i:j].any():
                continue
            events = record.labels[i:j].tolist()
            key = min(tuple(events[k:] + events[:k]) for k in range(j - i))  # the same for all rotations
            tried[key] = tried.get(key, 0) + 1
            if tried[key] > TRIES:
                continue
            found = solved(record, i, j, max(length, 1), WIDE)
            if found is not None:
                yield found


def _returns(
    record: Trajectory, marks: np.ndarray, spread: np.ndarray, periods: int, events: int
) -> list[tuple[int, int]]:
    """Pairs of marks with the same event that are `periods` forcing periods (0: up to `events` events) apart, the closest first."""
    times, points = record.times[marks], record.points[marks]
    first = np.arange(len(marks))
    if periods:
        after = np.searchsorted(times, times + periods)
        ends = [after - 1, after]
    else:
        ends = [first + n for n in range(1, events + 1)]
    table = []
    for last in ends:
        fits = (last < len(marks)) & (last > first)
        one, other = first[fits], last[fits]
        size = np.abs((points[other] - points[one]) / spread).max(axis=1, initial=0.0)
        if periods:
            size = np.maximum(size, 2.0 * np.pi * np.abs(times[other] - times[one] - periods))
        size[record.labels[marks[one]] != record.labels[marks[other]]] = np.inf
        table.append(np.column_stack([marks[one], marks[other], size]))
    rows = np.concatenate(table)
    rows = rows[np.argsort(rows[:, 2], kind="stable")][:PER_LENGTH]
    return [(int(i), int(j)) for i, j, size in rows if size < NEAR and j - i <= LONGEST_WORD]


def fixed_point(
    step: Callable[[np.ndarray], np.ndarray], x: np.ndarray, box: np.ndarray, hard: np.ndarray
) -> np.ndarray | None:
    """Solve ``step(x) = x`` by Newton's method with finite differences; None if it does not converge.

    Parameters
    ----------
    step : callable
        The map; NaN if a point has no image.
    x : float array (d,)
        First guess.
    box : float array (d, 2)
        Smallest and largest value of each coordinate of the starts.
    hard : bool array (d,)
        Coordinates whose limits cannot be passed (walls).
    """
    low, high = box.T
    size = high - low
    middle, outside = 0.5 * (low + high), (0.5 + BEYOND) * size
    shift = SIMULATING.nudge * size
    one = np.eye(len(size))
    matrix = np.empty_like(one)
    x = np.array(x, dtype=float)
    image = step(x)
    for _ in range(ITERATIONS):
        residual = x - image
        far = float(np.abs(residual / size).max())
        if far < SOLVING.scaled:
            return x
        if not far < np.inf:
            return None
        for j, offset in enumerate(np.where(x > middle, -shift, shift)):  # into the box
            trial = x.copy()
            trial[j] += offset
            matrix[:, j] = (step(trial) - image) / offset
        try:
            change = np.linalg.solve(matrix - one, residual)
        except np.linalg.LinAlgError:
            return None
        length = float(np.abs(change / size).max())
        if not length < np.inf:
            return None
        change *= min(1.0, LONGEST / max(length, LONGEST))
        trial = x
        for _ in range(SHORTER):
            trial = x + change
            if hard.any():
                trial = np.where(hard, np.clip(trial, low, high), trial)
            image = step(trial)
            if not np.isnan(image[0]):
                break
            change *= 0.5
        x = trial
        if (np.abs(x - middle) > outside).any():
            return None
    return None


def returning_cycles(
    simulator: Simulator, starts: np.ndarray, box: np.ndarray, longest: int
) -> Iterator[Orbit]:
    """Find cycles with events of up to `longest` forcing periods, by Newton's method on the return map, each once.

    Parameters
    ----------
    simulator : Simulator
        Of a forced machine.
    starts : float array (n, 1 + d)
        Phase and coordinates.
    box : float array (1 + d, 2)
        Smallest and largest value of phase and coordinates.
    longest : int

    Yields
    ------
    Orbit
        A cycle, which may be unstable.

    Notes
    -----
    A cycle is a fixed point of the n-th iterate of the return map. Newton's method converges to it from a far larger part of the box than
    the motion itself does (for an unstable cycle: none). For a machine with a mirror symmetry the map is half a period followed by the mirror, so
    that a symmetric cycle of odd period needs half the iterates.
    """
    box = box[1:]
    length, size = (0.5 if simulator.mirrored else 1.0), box[:, 1] - box[:, 0]
    earlier = np.empty((0, len(box)))

    def ahead(x: np.ndarray, count: int) -> np.ndarray:
        """The `count`-th iterate of the map."""
        end = later(simulator, x, count * length)
        return simulator.image(end) if length == 0.5 and count % 2 else end

    for start in starts:
        time = float(start[0]) / (2.0 * np.pi)
        begin = later(simulator, start[1:], np.floor(time) + WARM - time, time)
        if not np.isfinite(begin).all():
            continue
        for count in range(1, round(longest / length) + 1):
            x = fixed_point(lambda y, n=count: ahead(y, n), begin, box, simulator.hard)
            if x is None or np.any(np.abs((earlier - x) / size).max(axis=1) < SIMULATING.same):
                continue
            points = [x]
            for _ in range(count - 1):
                points.append(ahead(points[-1], 1))
            earlier = np.concatenate([earlier, points])
            repeats = (
                np.abs((np.array(points[1:]).reshape(-1, len(x)) - x) / size).max(axis=1) < SIMULATING.same
            )
            prime = int(np.argmax(repeats)) + 1 if repeats.any() else count
            found = _cycle_at(simulator, x, prime if prime % 2 or length == 1.0 else prime // 2)
            if found is not None:
                yield found


def _cycle_at(simulator: Simulator, x: np.ndarray, periods: int) -> Orbit | None:
    """The cycle through a point as an orbit; None if it cannot be continued."""
    try:
        simulator.start(x)
        record = simulator.run(float(periods), EVENTS * periods)
    except SimulationError:
        return None
    if not record.whole or not len(record) or record.piled.any():
        return None
    return solved(record, 0, len(record), periods, NEXT)
