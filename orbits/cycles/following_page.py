"""A claimed orbit of a machine on a page followed by simulation: event by event, position by position."""

from __future__ import annotations

import numpy as np

from orbits.cycles.cycle import Cycle
from orbits.flows.page.stepper import TWO_PI, SimulationError, Stepper
from orbits.simulation.page import collect

SHORT = 1e-4  # flights that are over so soon may swap the events at their ends


def _begun(orbit: Cycle, place: int) -> Stepper:
    stepper = Stepper(orbit.model, orbit.params)
    forced = orbit.model.forced
    clock = float(orbit.nodes[place, 0]) if forced else 0.0
    stepper.start(orbit.nodes[place, 1:], clock, orbit.word.modes[place])
    return stepper


def by_events(orbit: Cycle) -> float:
    """Largest difference of nodes over one period, infinite if the events differ."""
    word, nodes, forced = orbit.word, orbit.nodes, orbit.model.forced
    n = len(word)
    try:
        stepper = _begun(orbit, 0)
        if not n:
            first = nodes[0, 1:].copy()
            event = stepper.advance(stepper.base + stepper.clock + TWO_PI * orbit.periods)
            return np.inf if event is not None else float(np.abs(stepper.state - first).max())
        length = TWO_PI * orbit.periods if forced else float(nodes[:, 0].sum())
        run = collect(stepper, 2.0 * length + 1.0, n)
    except SimulationError:
        return np.inf
    if (
        len(run) < n
        or tuple(run.letters) != word.rotate(1).events
        or tuple(run.modes[1:]) != word.rotate(1).modes
    ):
        return np.inf
    claimed = np.roll(nodes, -1, axis=0)
    if forced:
        claimed[-1, 0] += TWO_PI * orbit.periods
        clocks = run.clocks[1:]
    else:
        clocks = np.diff(run.clocks)
        return float(max(np.abs(run.states[1:] - claimed[:, 1:]).max(), np.abs(clocks - nodes[:, 0]).max()))
    return float(max(np.abs(run.states[1:] - claimed[:, 1:]).max(), np.abs(clocks - claimed[:, 0]).max()))


def one_by_one(orbit: Cycle) -> float:
    """Nothing is gained that way: the simulation does something else."""
    return np.inf


def by_positions(orbit: Cycle, points: int = 400) -> float:
    """Largest difference at many instants of the states that no impulse moves, the simulation started anew at every definite event."""
    durations, n = orbit.durations, max(1, len(orbit.word))
    if np.any(durations < -1e-9):
        return np.inf
    places = [i for i in range(n) if durations[i] > SHORT and durations[i - 1] > SHORT] or [0]
    motion = orbit.flow.sample(orbit, points)
    clocks = motion["phase"] if orbit.forced else motion["time"]
    names = [orbit.model.states[entry - 1] for entry in orbit.flow.position_entries(orbit.model)]
    claimed = np.tile(np.column_stack([motion[name] for name in names]), (2, 1))
    clocks = np.append(clocks, clocks + durations.sum())
    first = np.searchsorted(motion["segment"], np.arange(n + 1))
    first = np.append(first[:-1], first + len(motion["segment"]))  # twice through the cycle
    columns = [orbit.model.states.index(name) for name in names]
    worst = 0.0
    for a, b in zip(places, [*places[1:], places[0] + n]):
        part = slice(first[a], first[b])
        since = clocks[part] - clocks[part][0]
        try:
            stepper = _begun(orbit, a)
            origin = stepper.base + stepper.clock
            run = collect(stepper, float(since[-1]) + 1e-9, 50 * n + 200)
        except SimulationError:
            return np.inf
        if run.end < origin + since[-1]:
            return np.inf
        there = run.sample(origin + since)[:, columns]
        worst = max(worst, float(np.abs(there - claimed[part]).max()))
    return worst
