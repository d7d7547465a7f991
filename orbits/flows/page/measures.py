"""Measures of the orbits of a declared machine, for arrays of solutions."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from orbits.contacts.letters import HIT
from orbits.words import Word

OF_STATES = ("max", "min", "first", "strobe")


def names(machine: Any) -> tuple[str, ...]:
    """max_x, min_x (over the period), first_x (after the first event), strobe_x (at phase zero) of every state; `phase` of the first
    event, `period`, `rate` (2 pi / period), `approach_speed` (of the fastest impact)."""
    what = OF_STATES if machine.forced else OF_STATES[:3]
    own = [f"{kind}_{state}" for state in machine.states for kind in what]
    walls = any(letter.kind == HIT for letter in machine.alphabet.letters.values())
    return (
        *own,
        *(["phase"] if machine.forced else []),
        "period",
        "rate",
        *(["approach_speed"] if walls else []),
    )


def shown_first(machine: Any) -> str:
    """The measure that a diagram shows when none is asked for: impact speeds, or how far the first state goes."""
    return "approach_speed" if "approach_speed" in names(machine) else f"max_{machine.states[0]}"


def measure(
    machine: Any, word: Word, periods: int, nodes: np.ndarray, params: np.ndarray, wanted: Sequence[str]
) -> dict[str, np.ndarray]:
    """Values, each of shape (m,), of solutions with nodes (m, L, n + 1) and parameters (m, P).

    Raises
    ------
    KeyError
        If there is no such measure.
    """
    known = names(machine)
    for name in wanted:
        if name not in known:
            raise KeyError(f"there is no measure {name!r}; choose from {', '.join(known)}")
    result: dict[str, np.ndarray] = {}
    period = _periods(machine, periods, nodes, params)
    extremes = None
    for name in wanted:
        kind, _, state = name.partition("_")
        if name == "phase":
            result[name] = np.mod(nodes[:, 0, 0], 2.0 * np.pi)
        elif name == "period":
            result[name] = period
        elif name == "rate":
            result[name] = 2.0 * np.pi / period
        elif name == "approach_speed":
            result[name] = _approach_speeds(machine, word, nodes, params)
        elif kind == "first":
            result[name] = nodes[:, 0, 1 + machine.states.index(state)].copy()
        elif kind == "strobe":
            result[name] = _strobed(machine, word, periods, nodes, params)[:, machine.states.index(state)]
        else:
            if extremes is None:
                extremes = _extremes(machine, word, periods, nodes, params)
            result[name] = extremes[0 if kind == "max" else 1][:, machine.states.index(state)]
    return result


def _periods(machine: Any, periods: int, nodes: np.ndarray, params: np.ndarray) -> np.ndarray:
    if not machine.forced:
        return nodes[:, :, 0].sum(axis=1)
    return 2.0 * np.pi * periods / machine.phase_speed(params)


def _spans(machine: Any, periods: int, nodes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Clock at the beginning and the end of every flight of one solution."""
    if not machine.forced:
        return np.zeros(len(nodes)), nodes[:, 0]
    return nodes[:, 0], np.append(nodes[1:, 0], nodes[0, 0] + 2.0 * np.pi * periods)


def _extremes(
    machine: Any, word: Word, periods: int, nodes: np.ndarray, params: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Largest and smallest value of every state over the period: at the events, and where a rate is zero between them."""
    compiled, e = machine.compiled, machine.equations
    keys = [e.pattern_key(word.modes[i % len(word.modes)]) for i in range(nodes.shape[1])]
    watches = [compiled.extremes(key) for key in keys]
    largest, smallest = nodes[:, :, 1:].max(axis=1), nodes[:, :, 1:].min(axis=1)
    for k in range(len(nodes)):
        begin, end = _spans(machine, periods, nodes[k])
        for i, watch in enumerate(watches):
            if not 0.0 < end[i] - begin[i] < 1e3:
                continue
            numbers = compiled.numbers(params[k], word.modes[i % len(word.modes)])
            found = [state for _, _, state in watch(nodes[k, i, 1:], begin[i], end[i], numbers)]
            found.append(watch.final)
            table = np.array(found)
            largest[k] = np.maximum(largest[k], table.max(axis=0))
            smallest[k] = np.minimum(smallest[k], table.min(axis=0))
    return largest, smallest


def _strobed(machine: Any, word: Word, periods: int, nodes: np.ndarray, params: np.ndarray) -> np.ndarray:
    """States at the first passage of phase zero (a multiple of 2 pi) after the first event."""
    compiled, e = machine.compiled, machine.equations
    out = np.empty((len(nodes), machine.size))
    for k in range(len(nodes)):
        begin, end = _spans(machine, periods, nodes[k])
        target = 2.0 * np.pi * np.ceil(begin[0] / (2.0 * np.pi) - 1e-12)
        i = int(np.clip(np.searchsorted(begin, target, side="right") - 1, 0, len(begin) - 1))
        mode = word.modes[i % len(word.modes)]
        state = nodes[k, i, 1:].copy()
        compiled.extremes(e.pattern_key(mode)).move(
            state, begin[i], max(target, begin[i]), compiled.numbers(params[k], mode)
        )
        out[k] = state
    return out


def _approach_speeds(machine: Any, word: Word, nodes: np.ndarray, params: np.ndarray) -> np.ndarray:
    """Fastest approach at an impact: the gap's rate before it, from the one after it and the restitution."""
    compiled = machine.compiled
    best = np.zeros(len(nodes))
    if not len(word):
        return best
    numbers = np.hstack([params, np.zeros((len(params), len(machine.equations.signed)))])
    for i in range(nodes.shape[1]):
        letter = word.letter(i)
        if letter.kind != HIT:
            continue
        clock = np.ascontiguousarray(nodes[:, i, 0]) if machine.forced else np.zeros(len(nodes))
        rows = compiled.rebound(letter.contact)(nodes[:, i, 1:], clock, numbers)
        best = np.maximum(best, rows[:, 0] / rows[:, 1])
    return best
