"""How a word changes where a margin vanishes: local edits of the event list at a border orbit.

At the border the old and the new description are the same motion, so the nodes of the new word are known there: an
inserted event sits where the margin vanished. What happens beyond follows from the mechanics:

- a flight that comes to rest (velocity graze) has w'' = 0 there, so friction is just beaten; a moment earlier it holds:
  a stick of vanishing duration appears, with a slip in the direction of the flight;
- a turn at which the shaking no longer beats friction becomes a stick with its slip, and the other way round;
- a stick of vanishing duration disappears: into a flight if it slips on in the same direction, into a turn otherwise;
- a turn or stick that reaches a wall becomes an impact of vanishing speed (and the stick after it), and the other way round.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from orbits.cycles.margins import DURATION, EVENT, FLIGHT, PER_NODE, WALL
from orbits.cycles.sampling import flight, slowest
from orbits.cycles.solution import Solution
from orbits.words import Word

SHORT = 1e-4  # phase of a stick, or between a turn and the stick after it, that is about to vanish
NO_SPEED = 1e-7  # an impact slower than this vanishes
FIRST = 2e-3  # size of what grows from nothing: radians of phase, or speed


@dataclass(frozen=True)
class Edit:
    """Events `start` .. `stop - 1` give way to others.

    Attributes
    ----------
    start, stop : int
    events : tuple of str
    modes : tuple of int
    nodes : float array (m, n)
    grows : str
        What vanishes at the border and grows beyond: the ``gap`` in phase between the first two new events, the
        ``speed`` of the impact that is the first new event, or a ``margin`` of the new word where nothing was inserted.
    note : str
    """

    start: int
    stop: int
    events: tuple[str, ...]
    modes: tuple[int, ...]
    nodes: np.ndarray
    grows: str
    note: str


def edits_at(orbit: Solution, index: int, unit: int | None = None) -> list[Edit]:
    """The edits that margin `index` may ask for at the border orbit, the likeliest first.

    Parameters
    ----------
    orbit : Solution
        The border orbit, over its whole cycle.
    index : int
        Index of the vanishing margin, four per node.
    unit : int, optional
        Number of events after which the cycle repeats, or mirrors, itself; default: all.
    """
    place, column = divmod(index, PER_NODE)
    word, n = orbit.word, len(orbit.word)
    letter = word.events[place]
    after = word.modes[place]
    node = orbit.nodes[place]
    if word.frictionless:
        return _frictionless(orbit, place, column)
    if column == FLIGHT and after != 0:
        following = (place + 1) % (unit or n)
        held = following + 1 < n and word.events[following] == "s"
        if held and orbit.nodes[following + 1, 0] - orbit.nodes[following, 0] < SHORT:
            return _stick(orbit, following)  # the flight comes to rest where a stick is about to vanish
        ahead, state = slowest(orbit, place)
        late = np.array([node[0] + ahead, state[0], *state[2:]])[: node.size]
        early = late.copy()
        early[0] -= FIRST
        nodes = np.array([early, late])
        return [
            Edit(
                place + 1, place + 1, ("s", "u"), (0, after), nodes, "gap", "a stick appears inside a flight"
            )
        ]
    if letter == "t" and column != WALL:
        found = []
        if place + 1 < n and word.events[place + 1] == "s":
            held = orbit.nodes[place + 1][None]
            found = [Edit(place, place + 2, ("s",), (0,), held, "margin", "a turn before a stick disappears")]
        late = node.copy()
        late[0] += FIRST
        nodes = np.array([node, late])
        return [
            *found,
            Edit(place, place + 1, ("s", "u"), (0, after), nodes, "gap", "a turn becomes a stick"),
        ]
    if letter in "tsu" and column == WALL:
        return _wall(orbit, place - 1 if letter == "u" else place)
    if letter == "s" and place + 1 < n:
        return _stick(orbit, place)
    if letter in "LR" and column in (EVENT, DURATION):
        # without speed, the flight to what follows takes no time either
        soft = node.copy()
        soft[1] = orbit.events.w[place]
        found = [Edit(place, place + 1, ("t",), (after,), soft[None], "margin", "an impact becomes a turn")]
        if place + 1 < n and word.events[place + 1] == "s":
            soft = soft.copy()
            soft[0] = orbit.nodes[place + 1, 0]
            merged = Edit(
                place, place + 2, ("s",), (0,), soft[None], "margin", "an impact before a stick vanishes"
            )
            found.insert(0, merged)
        return found
    return []


def _stick(orbit: Solution, place: int) -> list[Edit]:
    """A stick that vanishes, or that is about to be preceded by a turn."""
    word, node = orbit.word, orbit.nodes[place]
    before, out = word.modes[place - 1], word.modes[place + 1]
    late = node.copy()
    late[0] += FIRST
    turned = Edit(
        place, place + 1, ("t", "s"), (-before, 0), np.array([node, late]), "gap", "a turn appears before a stick"
    )  # fmt: skip
    if place > 0 and word.events[place - 1] == "t" and node[0] - orbit.nodes[place - 1, 0] < SHORT:
        return [
            Edit(place - 1, place + 1, ("s",), (0,), node[None], "margin", "a turn before a stick disappears")
        ]
    if out == before:
        gone = Edit(place, place + 2, (), (), orbit.nodes[:0], "margin", "a stick disappears inside a flight")
    else:
        middle = node.copy()
        middle[0] = 0.5 * (node[0] + orbit.nodes[place + 1, 0])
        gone = Edit(place, place + 2, ("t",), (out,), middle[None], "margin", "a stick becomes a turn")
    if orbit.nodes[place + 1, 0] - node[0] < SHORT:
        return [gone, turned]
    return [turned]  # the stick still lasts: what vanishes is the reserve of friction where it begins


def _wall(orbit: Solution, place: int) -> list[Edit]:
    """A turn or stick that reaches a wall: an impact of vanishing speed takes its place."""
    word, node = orbit.word, orbit.nodes[place]
    wall, side = _nearer(orbit, node[1])
    if word.modes[place - 1] != side:
        return []
    hit = node.copy()
    hit[1] = orbit.events.v_rate[place] + side * FIRST  # B+ = v' - w'+
    if word.events[place] == "t":
        return [Edit(place, place + 1, (wall,), (-side,), hit[None], "speed", "a turn hits the wall")]
    late = node.copy()
    late[0] += FIRST
    late[1] -= side * 0.1 * FIRST**2
    return [
        Edit(
            place, place + 1, (wall, "s"), (-side, 0), np.array([hit, late]), "speed", "a stick hits the wall"
        )
    ]


def _nearer(orbit: Solution, w: float) -> tuple[str, int]:
    """The nearer wall and the direction in which it is reached."""
    left, right = orbit.model.walls(orbit.params)
    return ("L", 1) if left - w < w - right else ("R", -1)


def _frictionless(orbit: Solution, place: int, column: int) -> list[Edit]:
    if column == FLIGHT:  # it touches the wall just where it begins or ends if an impact there vanishes
        places = (place, (place + 1) % len(orbit.word))
        soft = [k for k in places if abs(orbit.events.rate_post[k]) < NO_SPEED]
        if soft:
            place, column = soft[0], EVENT
    if column == EVENT:
        return [Edit(place, place + 1, (), (), orbit.nodes[:0], "margin", "an impact vanishes")]
    if column != FLIGHT:
        return []
    ahead = np.linspace(0.0, float(orbit.durations[place]), 20002)[1:-1]
    path = flight(orbit, place, ahead)
    inner = np.flatnonzero(np.diff(np.sign(path[:, 1])) != 0)
    if not inner.size:
        return []
    left, right = orbit.model.walls(orbit.params)
    touch = inner[np.argmin(np.minimum(left - path[inner, 0], path[inner, 0] - right))]
    wall, side = _nearer(orbit, path[touch, 0])
    node = np.array([orbit.nodes[place, 0] + ahead[touch], path[touch, 3] + side * FIRST, *path[touch, 2:]])
    node = node[None, : orbit.nodes.shape[1]]
    return [Edit(place + 1, place + 1, (wall,), (-side,), node, "speed", "a flight touches the wall")]


def applied(word: Word, nodes: np.ndarray, edits: list[Edit]) -> tuple[Word, np.ndarray, int]:
    """The word and nodes after the edits (of disjoint places), and where the first edit's new events stand."""
    events, modes = list(word.events), list(word.modes)
    rows = list(nodes)
    for change in sorted(edits, key=lambda e: e.start, reverse=True):
        events[change.start : change.stop] = change.events
        modes[change.start : change.stop] = change.modes
        rows[change.start : change.stop] = list(change.nodes)
    first = min(edits, key=lambda e: e.start)
    return Word(tuple(events), tuple(modes), word.frictionless), np.array(rows), first.start
