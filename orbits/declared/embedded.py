"""Unstable cycles that a chaotic motion of a declared machine passes near: what nearly returns is solved."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from orbits.contacts.letters import HOLD, RELEASE
from orbits.declared.attractor import LONGEST_WORD, solved
from orbits.declared.orbit import DeclaredOrbit
from orbits.declared.simulation import Trajectory, collect
from orbits.declared.stepper import TWO_PI, Stepper

EVENTS = 3000  # of the motion in which returns are looked for, and as many forcing periods at most
NEAR = 0.1  # largest difference of a return, relative to the spread of the motion
TRIES = 2  # returns with one and the same list of events
PER_LENGTH = 40  # nearest returns of each length
FAR = 0.5  # largest distance of a cycle from its guess, relative to 1 + states: what is real counts, wherever it was looked for


def embedded_cycles(stepper: Stepper, longest: int) -> Iterator[DeclaredOrbit]:
    """Cycles next to the nearest returns of a motion, of up to `longest` forcing periods; see `orbits.attractors.embedded`.

    Of a self-excited machine they have up to `longest` times as many events as there are contacts.

    Parameters
    ----------
    stepper : Stepper
        On the motion; it is moved on.
    longest : int

    Yields
    ------
    DeclaredOrbit
        A cycle, as a rule unstable; one may come more than once.
    """
    machine = stepper.machine
    run = collect(stepper, TWO_PI * EVENTS if machine.forced else 1e5, EVENTS)
    if len(run) < 2:
        return
    spread = np.ptp(run.states[1:], axis=0)
    spread[spread <= 0.0] = 1.0
    tried: dict[tuple, int] = {}
    for periods in range(1, longest + 1):
        events = None if machine.forced else range(1, longest * len(machine.contacts) + 1)
        for i, j in _returns(run, spread, periods, events):
            if any(kind in (HOLD, RELEASE) for _, kind, _ in run.events[i + 1 : j + 1]):
                continue
            key = _list_of_events(run, i, j)
            tried[key] = tried.get(key, 0) + 1
            if tried[key] > TRIES:
                continue
            found = solved(_part(run, j), j - i, periods, FAR)
            if found is not None:
                yield found
        if not machine.forced:
            return


def _returns(
    run: Trajectory, spread: np.ndarray, periods: int, events: range | None
) -> list[tuple[int, int]]:
    """Pairs of events alike in what they are and so many forcing periods (or events) apart, the nearest ones first."""
    count = len(run)
    clocks, states = run.clocks[1:], run.states[1:]
    first = np.arange(count)
    if events is None:
        after = np.searchsorted(clocks, clocks + TWO_PI * periods)
        ends = [after - 1, after]
    else:
        ends = [first + n for n in events]
    table = []
    for last in ends:
        fits = (last < count) & (last > first)
        one, other = first[fits], last[fits]
        size = np.abs((states[other] - states[one]) / spread).max(axis=1, initial=0.0)
        if events is None:
            size = np.maximum(size, np.abs(clocks[other] - clocks[one] - TWO_PI * periods))
        table.append(np.column_stack([one, other, size]))
    rows = np.concatenate(table)
    rows = rows[np.argsort(rows[:, 2], kind="stable")]
    rows = rows[(rows[:, 2] < NEAR) & (rows[:, 1] - rows[:, 0] <= LONGEST_WORD)]
    modes = run.modes[1:]
    pairs = [(int(i), int(j)) for i, j, _ in rows]
    return [(i, j) for i, j in pairs if run.events[i] == run.events[j] and modes[i] == modes[j]][:PER_LENGTH]


def _part(run: Trajectory, last: int) -> Trajectory:
    """The run up to an event."""
    stop = last + 2
    return Trajectory(
        run.machine,
        run.params,
        run.clocks[:stop],
        run.states[:stop],
        run.modes[:stop],
        run.events[: last + 1],
        float(run.clocks[stop - 1]),
        run.status,
    )


def _list_of_events(run: Trajectory, i: int, j: int) -> tuple:
    """The events and modes of a piece, the same wherever the cycle is begun."""
    pairs = [*zip(run.events[i + 1 : j + 1], run.modes[i + 2 : j + 2], strict=True)]
    return min(tuple(pairs[k:] + pairs[:k]) for k in range(len(pairs)))
