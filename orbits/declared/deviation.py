"""How far the simulated motion leaves a claimed orbit of a declared machine."""

from __future__ import annotations

from typing import Any

import numpy as np

from orbits.flows.page.stepper import TWO_PI, SimulationError, Stepper
from orbits.simulation.page import collect

DELICATE = 1e-4  # margins below this may make two events one
WILD = 1e3  # multipliers above this blow rounding up within a period
AGREED = 1e-9


def deviation(orbit: Any) -> float:
    """Largest deviation of the simulation from the orbit over one period.

    Nodes are compared event by event. At a border, where rounding alone makes events appear or vanish, and on very unstable
    orbits the states are compared at many instants as well, flight by flight, and the smaller deviation counts. Infinite if the
    simulation does something else.
    """
    error = by_events(orbit)
    if error < AGREED:
        return error
    margins = np.array([margin.value for margin in orbit.margins])
    delicate = np.any(np.abs(margins) < DELICATE) or np.any(np.abs(orbit.multipliers) > WILD)
    if not (delicate or np.isfinite(error)):
        return error
    return min(error, by_states(orbit))


def _begun(orbit: Any, place: int) -> Stepper:
    stepper = Stepper(orbit.model, orbit.params)
    forced = orbit.model.forced
    clock = float(orbit.nodes[place, 0]) if forced else 0.0
    stepper.start(orbit.nodes[place, 1:], clock, orbit.word.modes[place])
    return stepper


def by_events(orbit: Any) -> float:
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


def by_states(orbit: Any, points: int = 400) -> float:
    """Largest difference of the states at many instants, the simulation started anew at every definite event."""

    durations = orbit.durations
    if np.any(durations < -1e-9):
        return np.inf
    word, nodes, n = orbit.word, orbit.nodes, max(1, len(orbit.word))
    weak = {
        m.segment
        for m in orbit.margins
        if abs(m.value) < DELICATE and m.kind not in ("wall", "flight", "hold")
    }
    places = [i for i in range(n) if i not in weak] or [0]
    compiled, e = orbit.model.compiled, orbit.model.equations
    worst = 0.0
    for a, b in zip(places, [*places[1:], places[0] + n]):
        clocks, claimed, passed = [], [], 0.0
        for i in range(a, b):
            k = i % n
            begin = float(nodes[k, 0]) if orbit.model.forced else 0.0
            count = max(3, round(points * durations[k] / max(durations.sum(), 1e-300)))
            grid = begin + np.linspace(0.0, max(float(durations[k]), 0.0), count + 1)
            watch = compiled.watch(e.pattern_key(word.modes[k]))
            path = watch.path(nodes[k, 1:], grid, compiled.numbers(orbit.params, word.modes[k]))
            clocks.append(passed + grid[:-1] - begin)
            claimed.append(path[:-1])
            passed += float(durations[k])
        try:
            stepper = _begun(orbit, a)
            origin = stepper.base + stepper.clock
            run = collect(stepper, passed + 1e-9, 50 * n + 200)
        except SimulationError:
            return np.inf
        if run.end < origin + passed:
            return np.inf
        there = run.sample(origin + np.concatenate(clocks))
        here = np.concatenate(claimed)
        gap = np.abs(there - here).max(axis=1)
        # where an impact falls a little earlier or later, velocities differ for an instant: positions decide
        gap = np.sort(gap)[: max(1, len(gap) - 2 * (b - a) - 2)]
        worst = max(worst, float(gap.max()))
    return worst
