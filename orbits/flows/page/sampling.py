"""An orbit of a declared machine between its events: states over time."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from orbits.flows.protocol import Motion
from orbits.machines.page.machine import Machine
from orbits.numbers import SMALLEST
from orbits.words import Word


def strobed(
    machine: Machine, word: Word, periods: int, node: np.ndarray, params: np.ndarray, often: int = 1
) -> np.ndarray:
    """Nodes of a motion without events, so often per forcing period from one of them on to its return, shape (often periods + 1, n + 1)."""
    clocks, mode = node[0] + 2.0 * np.pi / often * np.arange(often * periods + 1), word.entries(0)
    watch = machine.compiled.watch(machine.equations.pattern_key(mode))
    return np.column_stack([clocks, watch.path(node[1:], clocks, machine.compiled.numbers(params, mode))])


def sample(motion: Motion[Machine], points: int = 400) -> dict[str, np.ndarray]:
    """States over one period, events included with the states before and after them.

    Returns
    -------
    dict of float arrays
        ``time`` from the first event, ``phase`` (of a forced machine), every state by its name, and ``segment`` (index of the
        event before).
    """
    durations = motion.durations
    total = max(float(durations.sum()), SMALLEST)
    compiled, e = motion.model.compiled, motion.model.equations
    clocks, states, segments, passed = [], [], [], 0.0
    first = float(motion.nodes[0, 0]) if motion.model.forced else 0.0
    for i, duration in enumerate(durations):
        count = max(2, round(points * duration / total))
        begin = float(motion.nodes[i, 0]) if motion.model.forced else 0.0
        grid = begin + np.linspace(0.0, max(float(duration), 0.0), count)
        mode = motion.word.entries(i)
        watch = compiled.watch(e.pattern_key(mode))
        states.append(watch.path(motion.nodes[i, 1:], grid, compiled.numbers(motion.params, mode)))
        clocks.append(passed + grid - begin)
        segments.append(np.full(count, i))
        passed += float(duration)
    clock = np.concatenate(clocks)
    result = {}
    if motion.model.forced:
        result["time"] = clock / motion.model.phase_speed(motion.params)
        result["phase"] = first + clock
    else:
        result["time"] = clock
    table = np.concatenate(states)
    for j, name in enumerate(motion.model.states):
        result[name] = table[:, j]
    result["segment"] = np.concatenate(segments)
    return result


def states_at(motion: Motion[Machine], phases: np.ndarray) -> np.ndarray:
    """States of a forced motion at phases from 0 on, shape (m, n)."""
    whole, first = 2.0 * np.pi * motion.periods, motion.nodes[0, 0]
    wanted = (phases - first) % whole
    wanted[wanted >= whole] = 0.0  # of a phase just below zero
    begins = first + np.maximum.accumulate(motion.nodes[:, 0] - first)
    return along(
        motion.model, motion.params, motion.word.contact_modes, motion.nodes[:, 1:], begins, first + wanted
    )


def along(
    machine: Machine,
    params: np.ndarray,
    modes: Sequence[Sequence[int]],
    states: np.ndarray,
    begins: np.ndarray,
    clocks: np.ndarray,
) -> np.ndarray:
    """States, shape (m, n), at some clocks, each on the flight that begins last before it: there flight i is in states[i], with the mode modes[i]."""
    flights = np.clip(np.searchsorted(begins, clocks, side="right") - 1, 0, len(begins) - 1)
    compiled, e, out = machine.compiled, machine.equations, np.empty((len(clocks), machine.size))
    for i in np.unique(flights).tolist():
        places = np.flatnonzero(flights == i)
        places = places[np.argsort(clocks[places])]
        mode, first = modes[i % len(modes)], begins[i]
        turn = 2.0 * np.pi * np.floor(first / (2.0 * np.pi)) if machine.forced else first
        grid = np.concatenate([[first], clocks[places]]) - turn
        watch = compiled.watch(e.pattern_key(mode))
        out[places] = watch.path(states[i], grid, compiled.numbers(params, mode))[1:]
    return out
