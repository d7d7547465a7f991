"""Unstable cycles that a chaotic motion passes near: what nearly returns is solved."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from orbits.attractors.attractor import Attractor
from orbits.attractors.recurrence import recurring
from orbits.machines.states import nodes_of
from orbits.machines.stepping import HOLD, TURNS, Machine
from orbits.simulation.driver import collect
from orbits.simulation.trajectory import TWO_PI

PERIODS = 2000  # forcing periods of the motion in which returns are looked for
PER_PERIOD = 400  # events
NEAR = 0.1  # largest difference of a return, relative to the spread of the motion
TRIES = 3  # returns with one and the same list of events
PER_LENGTH = 200  # nearest returns of each length
SOLVED = 1e-8  # largest residual of a cycle


def embedded_cycles(
    model: Any, engine: Machine, params: np.ndarray, state: np.ndarray, longest: int
) -> Iterator[Attractor]:
    """Cycles next to the nearest returns of a motion, of up to `longest` forcing periods.

    Parameters
    ----------
    model : Model
    engine : Machine
        Its compiled simulation.
    params : float array (P,)
    state : float array (S,)
        On the motion; it is not changed.
    longest : int

    Yields
    ------
    Attractor
        A cycle, as a rule unstable; one may come more than once.

    Notes
    -----
    Chaotic motion comes back near each of its unstable cycles again and again, and a short piece between two near states is a guess
    for Newton's method (D. P. Lathrop and E. J. Kostelich, Phys. Rev. A 40 (1989) 4028).
    """
    state = state.copy()
    state[TURNS] = 0.0
    codes, modes, rows, _ = collect(engine, state, params, PERIODS, PER_PERIOD * PERIODS)
    nodes = nodes_of(engine, params, codes, modes, rows)
    hits = np.flatnonzero(codes < 2)
    if len(hits) < 2:
        return
    spread = np.ptp(nodes[hits, 1:], axis=0)
    spread = np.append(1.0, np.where(spread > 0.0, spread, 1.0))  # phases are counted in radians
    for periods in range(1, longest + 1):
        tried: dict[bytes, int] = {}
        for i, j in _returns(codes, modes, nodes, hits, spread, periods):
            piece = slice(i, j)
            if np.any(codes[piece] == HOLD):
                continue
            key = _list_of_events(codes[piece], modes[piece])
            tried[key] = tried.get(key, 0) + 1
            if tried[key] > TRIES:
                continue
            found = recurring(model, engine, params, codes[piece], modes[piece], rows[piece], periods)
            if found.residual < SOLVED and found.word is not None:
                yield found


def _returns(
    codes: np.ndarray,
    modes: np.ndarray,
    nodes: np.ndarray,
    hits: np.ndarray,
    spread: np.ndarray,
    periods: int,
) -> list[tuple[int, int]]:
    """Pairs of impacts so many forcing periods apart, alike in what they are, the nearest ones first."""
    phases = nodes[hits, 0]
    after = np.searchsorted(phases, phases + TWO_PI * periods)
    pairs = []
    for k in (after - 1, after):
        fits = k < len(hits)
        one, other = hits[fits], hits[k[fits]]
        gap = nodes[other] - nodes[one]
        gap[:, 0] -= TWO_PI * periods
        size = np.abs(gap / spread).max(axis=1)
        size[(codes[one] != codes[other]) | (modes[one] != modes[other])] = np.inf
        pairs.append(np.column_stack([one, other, size]))
    table = np.concatenate(pairs)
    table = table[np.argsort(table[:, 2], kind="stable")][:PER_LENGTH]
    return [(int(i), int(j)) for i, j, size in table if size < NEAR]


def _list_of_events(codes: np.ndarray, modes: np.ndarray) -> bytes:
    """The events and modes, the same wherever the cycle is begun."""
    row = (10 * codes.astype(int) + modes + 1).astype(np.uint8)
    return min(np.roll(row, -k).tobytes() for k in range(len(row)))
