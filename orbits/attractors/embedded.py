"""Unstable cycles that a chaotic motion passes near: what nearly returns is solved."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np

from orbits.flows.protocol import Simulator
from orbits.flows.trajectory import Trajectory

NEAR = 0.1  # largest difference of a return, relative to the spread of the motion
TRIES = 3  # returns with one and the same list of events
PER_LENGTH = 200  # nearest returns of each length
LONGEST_WORD = 400
PER_PERIOD = (
    4  # events of the longest cycle that are looked for per period asked for, of a self-excited machine
)


def embedded_cycles(
    simulator: Simulator, longest: int, solve: Callable[[Trajectory, int, int, int], Any]
) -> Iterator[Any]:
    """Cycles next to the nearest returns of a motion, of up to `longest` forcing periods.

    Parameters
    ----------
    simulator : Simulator
        On the motion; it is moved on.
    longest : int
        Of a self-excited machine: a fourth of the events of the longest cycle.
    solve : callable
        ``(record, first, last, periods)`` -> the cycle next to these events of a record, or None.

    Yields
    ------
    Orbit
        A cycle, as a rule unstable; one may come more than once.

    Notes
    -----
    Chaotic motion comes back near each of its unstable cycles again and again, and a short piece between two near states is a guess
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
            key = _list_of_events(record.labels[i:j].tolist())
            tried[key] = tried.get(key, 0) + 1
            if tried[key] > TRIES:
                continue
            found = solve(record, i, j, max(length, 1))
            if found is not None:
                yield found


def _returns(
    record: Trajectory, marks: np.ndarray, spread: np.ndarray, periods: int, events: int
) -> list[tuple[int, int]]:
    """Pairs of marks alike in what they are and so many forcing periods (0: up to so many events) apart, the nearest ones first."""
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


def _list_of_events(events: Sequence[int]) -> tuple:
    """The events and modes, the same wherever the cycle is begun."""
    return min(tuple(events[k:]) + tuple(events[:k]) for k in range(len(events)))
