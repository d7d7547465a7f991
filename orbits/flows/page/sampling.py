"""An orbit of a declared machine between its events: states over time."""

from __future__ import annotations

from typing import Any

import numpy as np


def lengths(orbit: Any) -> np.ndarray:
    """Clock that passes in each flight, shape (L,)."""
    if not orbit.machine.forced:
        return orbit.nodes[:, 0].copy()
    phases = orbit.nodes[:, 0]
    return np.diff(np.append(phases, phases[0] + 2.0 * np.pi * orbit.periods))


def strobed(orbit: Any) -> np.ndarray:
    """States of a motion without events, once per forcing period from its node on to its return, shape (periods + 1, n)."""
    grid = orbit.nodes[0, 0] + 2.0 * np.pi * np.arange(orbit.periods + 1)
    mode = orbit.word.modes[0]
    watch = orbit.machine.compiled.watch(orbit.machine.equations.pattern_key(mode))
    return watch.path(orbit.nodes[0, 1:], grid, orbit.machine.compiled.numbers(orbit.params, mode))


def sample(orbit: Any, points: int = 400) -> dict[str, np.ndarray]:
    """States over one period, events included with the states before and after them.

    Returns
    -------
    dict of float arrays
        ``time`` from the first event, ``phase`` (of a forced machine), every state by its name, and ``segment`` (index of the
        event before).
    """
    durations = lengths(orbit)
    total = max(float(durations.sum()), 1e-300)
    compiled, e = orbit.machine.compiled, orbit.machine.equations
    clocks, states, segments, passed = [], [], [], 0.0
    first = float(orbit.nodes[0, 0]) if orbit.machine.forced else 0.0
    for i, duration in enumerate(durations):
        count = max(2, round(points * duration / total))
        begin = float(orbit.nodes[i, 0]) if orbit.machine.forced else 0.0
        grid = begin + np.linspace(0.0, max(float(duration), 0.0), count)
        mode = orbit.word.modes[i % len(orbit.word.modes)]
        watch = compiled.watch(e.pattern_key(mode))
        states.append(watch.path(orbit.nodes[i, 1:], grid, compiled.numbers(orbit.params, mode)))
        clocks.append(passed + grid - begin)
        segments.append(np.full(count, i))
        passed += float(duration)
    clock = np.concatenate(clocks)
    result = {}
    if orbit.machine.forced:
        result["time"] = clock / orbit.parameters[str(orbit.machine.phase_rate)]
        result["phase"] = first + clock
    else:
        result["time"] = clock
    table = np.concatenate(states)
    for j, name in enumerate(orbit.machine.states):
        result[name] = table[:, j]
    result["segment"] = np.concatenate(segments)
    return result
