"""How far two motions of a declared machine are apart, whatever their words."""

from __future__ import annotations

import numpy as np

from orbits.declared.orbit import DeclaredOrbit
from orbits.flows.page.cycle_equations import loose_states
from orbits.flows.page.sampling import lengths

SAME = 1e-5  # largest difference of states, at equal clocks, of one and the same motion


def distance(one: DeclaredOrbit, other: DeclaredOrbit, points: int = 300) -> float:
    """How far two motions are apart, whatever their words; the mirror image of a motion counts as the same.

    Forced: the states at equal phases, but for the instants at which one of them jumps a little earlier. Self-excited: periods and
    extremes. Where both motions may be shifted along a state (a body that nothing but friction holds in its place), so may they be
    to compare them.
    """
    machine = one.machine
    loose = sorted({*loose_states(machine, one.word)} & {*loose_states(machine, other.word)})
    if not machine.forced:
        return _unlike(one, other, {machine.states[j] for j in loose})
    images = [other]
    if machine.has_mirror(other.params):
        images.append(other.mirror())
    return min(_apart(one, image, points, loose) for image in images)


def _unlike(one: DeclaredOrbit, other: DeclaredOrbit, loose: set[str]) -> float:
    """How much periods and extremes (of states along which both may be shifted: how far they go) differ."""
    names = [f"{side}_{state}" for state in one.machine.states for side in ("max", "min")]
    rows = []
    for orbit in (one, other):
        found = orbit.measures(*names, "period")
        for state in loose:
            found[f"max_{state}"] -= found[f"min_{state}"]
            found[f"min_{state}"] = 0.0
        rows.append(np.array(list(found.values())))
    a, b = rows
    return float(np.abs(a - b).max() / (1.0 + np.abs(a).max()))


def _apart(one: DeclaredOrbit, other: DeclaredOrbit, points: int, loose: list[int]) -> float:
    periods = max(one.periods, other.periods)
    if periods % one.periods or periods % other.periods:
        return np.inf
    phases = np.linspace(0.0, 2.0 * np.pi * periods, points * periods, endpoint=False)
    a, b = _states(one, phases), _states(other, phases)
    jumps = 2 * (len(one.word) + len(other.word)) + 2
    best = np.inf
    for shift in range(periods):
        apart = a - np.roll(b, shift * points, axis=0)
        apart[:, loose] -= np.median(apart[:, loose], axis=0)
        gap = np.abs(apart).max(axis=1)
        best = min(best, float(np.sort(gap)[max(0, len(gap) - 1 - jumps)]))
    return best


def _states(orbit: DeclaredOrbit, phases: np.ndarray) -> np.ndarray:
    """States at phases from 0 on, shape (m, n)."""
    compiled, e = orbit.machine.compiled, orbit.machine.equations
    spans, whole = lengths(orbit), 2.0 * np.pi * orbit.periods
    out = np.empty((len(phases), orbit.machine.size))
    for i, span in enumerate(spans):
        begin = float(orbit.nodes[i, 0])
        inside = np.mod(phases - begin, whole)
        places = np.flatnonzero(inside < span)
        if not places.size:
            continue
        order = places[np.argsort(inside[places])]
        mode = orbit.word.modes[i % len(orbit.word.modes)]
        grid = begin + np.concatenate([[0.0], inside[order]])
        path = compiled.watch(e.pattern_key(mode)).path(
            orbit.nodes[i, 1:], grid, compiled.numbers(orbit.params, mode)
        )
        out[order] = path[1:]
    return out
