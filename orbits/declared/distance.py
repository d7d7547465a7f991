"""How far two motions of a declared machine are apart, whatever their words."""

from __future__ import annotations

import numpy as np

from orbits.declared.orbit import DeclaredOrbit
from orbits.declared.sampling import lengths

SAME = 1e-5  # largest difference of states, at equal clocks, of one and the same motion


def distance(one: DeclaredOrbit, other: DeclaredOrbit, points: int = 300) -> float:
    """How far two motions are apart, whatever their words; the mirror image of a motion counts as the same.

    Forced: the states at equal phases, but for the instants at which one of them jumps a little earlier. Self-excited: periods and
    extremes.
    """
    if not one.machine.forced:
        names = [n for n in one.problem().measure_names if n.startswith(("max_", "min_", "period"))]
        a, b = one.measures(*names), other.measures(*names)
        scale = 1.0 + max(abs(v) for v in a.values())
        return max(abs(a[n] - b[n]) for n in names) / scale
    images = [other]
    if one.machine.alphabet.mirror is not None:
        images.append(other.mirror())
    return min(_apart(one, image, points) for image in images)


def _apart(one: DeclaredOrbit, other: DeclaredOrbit, points: int) -> float:
    periods = max(one.periods, other.periods)
    if periods % one.periods or periods % other.periods:
        return np.inf
    phases = np.linspace(0.0, 2.0 * np.pi * periods, points * periods, endpoint=False)
    a, b = _states(one, phases), _states(other, phases)
    jumps = 2 * (len(one.word) + len(other.word)) + 2
    best = np.inf
    for shift in range(periods):
        gap = np.abs(a - np.roll(b, shift * points, axis=0)).max(axis=1)
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
