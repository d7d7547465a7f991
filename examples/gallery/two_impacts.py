"""Orbits of the reduced machine with two impacts per period: symmetric in closed form, asymmetric by
Newton's method."""

from __future__ import annotations

import itertools

import numpy as np

from orbits import Absorber, Orbit
from orbits.starts.find import polish
from orbits.theory.manifolds import activation, symmetry_limit
from orbits.theory.manifolds import friction_level as friction_number
from orbits.theory.manifolds import impact_loss as restitution_ratio


def limits(machine: Absorber) -> tuple[float, float]:
    """C^2 at the fold and at the symmetry breaking."""
    R = restitution_ratio(machine.restitution)
    H = friction_number(machine.friction, machine.gravity, machine.mass_ratio) / machine.frequency**2
    return float(activation(R, H).amplitude ** 2), float(symmetry_limit(R, H).amplitude ** 2)


def symmetric(machine: Absorber, squares: np.ndarray, stable: bool = True) -> list[Orbit]:
    """Symmetric orbits at given C^2."""
    return [machine.symmetric_orbit(float(np.sqrt(c)), stable) for c in squares]


def asymmetric(machine: Absorber, top: float, step: float = 0.004) -> list[Orbit]:
    """The asymmetric orbits `LR` from just above the symmetry breaking to C^2 = `top`, real or not.

    The maps alone are solved; whether friction keeps its direction in flight is what ``orbit.real`` tells.
    """
    breaking = limits(machine)[1]
    start = machine.symmetric_orbit(float(np.sqrt(breaking * 1.004)))
    found = None
    for push in (0.05, 0.1, 0.2, 0.3):
        nodes = start.nodes.copy()
        nodes[0, 0] += push
        nodes[1, 0] -= push
        found = polish(Orbit(machine, start.word, 1, nodes, start.params))
        if found is not None and not found.symmetric:
            break
    assert found is not None and not found.symmetric
    branch = [found]
    for square in np.arange(breaking * 1.004 + 0.5 * step, top, step):
        last = branch[-1]
        params = last.params.copy()
        params[0] = np.sqrt(square)
        guess = last.nodes.copy() if len(branch) == 1 else 2 * last.nodes - branch[-2].nodes
        orbit = polish(Orbit(machine, last.word, 1, guess, params))
        if orbit is None:
            orbit = polish(Orbit(machine, last.word, 1, last.nodes.copy(), params))
        if orbit is None or orbit.symmetric:
            break
        branch.append(orbit)
    return branch


def at(branch: list[Orbit], function, level: float = 0.0) -> Orbit:
    """The orbit of a branch at which `function`(orbit) crosses a level, by bisection in C^2."""
    values = np.array([function(orbit) - level for orbit in branch])
    place = int(np.nonzero(values[:-1] * values[1:] < 0)[0][0])
    low, high = branch[place], branch[place + 1]
    for _ in range(48):
        params = 0.5 * (low.params + high.params)
        middle = polish(Orbit(low.model, low.word, 1, 0.5 * (low.nodes + high.nodes), params))
        assert middle is not None
        if (function(middle) - level) * values[place] > 0:
            low = middle
        else:
            high = middle
    return high


def refined(branch: list[Orbit], function, times: int = 14) -> list[Orbit]:
    """A branch with more orbits where `function`(orbit) changes its sign: curves have corners or level off there."""
    found = branch[:1]
    for low, high in itertools.pairwise(branch):
        sign, between, left, right = np.sign(function(low)), [], low, high
        for _ in range(times if sign * function(high) < 0 else 0):
            params = 0.5 * (left.params + right.params)
            middle = polish(Orbit(low.model, low.word, 1, 0.5 * (left.nodes + right.nodes), params))
            if middle is None:
                break
            between.append(middle)
            left, right = (middle, right) if function(middle) * sign > 0 else (left, middle)
        found += [*sorted(between, key=lambda o: o.params[0]), high]
    return found


def speeds(branch: list[Orbit]) -> dict[str, np.ndarray]:
    """C^2 (n,), absolute speeds after and before each impact and their mean (n, 2), stability and reality
    (n,)."""
    tables = [orbit.events for orbit in branch]
    side = np.array(
        [1.0, -1.0]
    )  # L, R: speeds are positive where the ansatz of the slow flow has them positive
    after = np.array([side * t.B_post for t in tables])
    before = np.array([-side * t.B_pre for t in tables])
    return {
        "C2": np.array([o.params[0] ** 2 for o in branch]),
        "after": after, "before": before, "mean": 0.5 * (after + before),
        "stable": np.array([o.stable for o in branch]), "real": np.array([o.real for o in branch]),
    }  # fmt: skip
