"""From which event a cycle is read: beyond a border the new word begins where the old one began.

Measures taken at the first impact and words in tables then go on without a jump along a chain of branches.
"""

from __future__ import annotations

import numpy as np

from orbits.contacts.letters import HIT, SLIP
from orbits.orbit import Orbit
from orbits.protocol import CycleProblem, Seed


def read_alike(seed: Seed, before: Orbit) -> Seed:
    """The seed, its orbit read from the event that corresponds to the first event of the orbit before the border."""
    if not len(seed.problem.word) or not len(before.word):
        return seed
    orbit = seed.problem.orbit(seed.u, seed.p)
    places = _first_event(orbit, before)
    if places == 0:
        return seed
    turned = orbit.rotate(places)
    problem = seed.problem.sibling(turned.word, turned.periods, seed.problem.symmetric, seed.problem.params)
    nodes = turned.nodes.copy()
    if orbit.forced:
        nodes[:, 0] -= 2.0 * np.pi * round((nodes[0, 0] - before.nodes[0, 0]) / (2.0 * np.pi))
    tangent = seed.tangent
    if tangent is not None:
        along = np.roll(whole_direction(seed.problem, tangent[:-1]), -places, axis=0)[: problem.length]
        tangent = np.append(along.ravel(), tangent[-1])
    return seed._replace(problem=problem, u=problem.reduce(nodes), tangent=tangent)


def whole_direction(problem: CycleProblem, direction: np.ndarray) -> np.ndarray:
    """A direction of the unknowns as one of the nodes of the whole cycle."""
    along = np.asarray(direction).reshape(problem.length, -1)
    if not problem.symmetric:
        return along
    image = -along
    image[:, 0] = along[:, 0]
    return np.concatenate([along, image])


def _first_event(orbit: Orbit, before: Orbit) -> int:
    """The event at the phase of the old first one (of a self-excited motion: with its states), of its kind if there is one; never a slip."""
    word = orbit.word
    kinds = [word.letter(i).kind for i in range(len(word))]
    choices = [i for i, letter in enumerate(word.events) if letter == before.word.events[0]]
    choices = choices or [i for i, kind in enumerate(kinds) if kind == HIT]
    choices = choices or [i for i, kind in enumerate(kinds) if kind != SLIP]
    if not orbit.forced:
        apart = np.abs(orbit.nodes[:, 1:] - before.nodes[0, 1:]).max(axis=1)
        return min(choices, key=lambda i: apart[i])
    whole = 2.0 * np.pi * before.periods
    phases, first = orbit.nodes[:, 0].tolist(), float(before.nodes[0, 0])
    return min(choices, key=lambda i: abs((phases[i] - first + 0.5 * whole) % whole - 0.5 * whole))
