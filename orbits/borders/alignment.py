"""From which event a cycle is read: beyond a border the new word begins where the old one began.

Measures taken at the first impact and words in tables then go on without a jump along a chain of branches.
"""

from __future__ import annotations

import numpy as np

from orbits.cycles.solution import Solution
from orbits.protocol import Seed


def read_alike(seed: Seed, before: Solution) -> Seed:
    """The seed, its orbit read from the event that corresponds to the first event of the orbit before the border."""
    if not len(seed.problem.word):
        return seed
    orbit = seed.problem.orbit(seed.u, seed.p)
    places = _first_event(orbit, before)
    if places == 0:
        return seed
    turned = orbit.rotate(places)
    problem = seed.problem.sibling(turned.word, turned.periods, seed.problem.symmetric, seed.problem.params)
    nodes = turned.nodes.copy()
    nodes[:, 0] -= 2.0 * np.pi * round((nodes[0, 0] - before.nodes[0, 0]) / (2.0 * np.pi))
    tangent = seed.tangent
    if tangent is not None:
        along = np.asarray(tangent[:-1]).reshape(seed.problem.length, -1)
        if seed.problem.symmetric:
            image = -along
            image[:, 0] = along[:, 0]
            along = np.concatenate([along, image])
        along = np.roll(along, -places, axis=0)[: problem.length]
        tangent = np.append(along.ravel(), tangent[-1])
    return seed._replace(problem=problem, u=problem.reduce(nodes), tangent=tangent)


def _first_event(orbit: Solution, before: Solution) -> int:
    """The event at the phase of the old first one, of its kind if there is one; never a slip."""
    letters = orbit.word.events
    wanted = before.word.events[0]
    choices = [i for i, letter in enumerate(letters) if letter == wanted]
    choices = choices or [i for i, letter in enumerate(letters) if letter in "LR"]
    choices = choices or [i for i, letter in enumerate(letters) if letter != "u"]
    whole = 2.0 * np.pi * before.periods
    phases, first = orbit.nodes[:, 0].tolist(), float(before.nodes[0, 0])
    return min(choices, key=lambda i: abs((phases[i] - first + 0.5 * whole) % whole - 0.5 * whole))
