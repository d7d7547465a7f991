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

from orbits.monitors import DURATION, EVENT, FLIGHT, PER_NODE, WALL
from orbits.orbit import Orbit
from orbits.sampling import slowest
from orbits.words import Word

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
        What vanishes at the border and grows beyond: ``duration`` of the stick at the first new event, ``speed`` of the
        impact that is the first new event, or ``margin`` where nothing was inserted.
    note : str
    """

    start: int
    stop: int
    events: tuple[str, ...]
    modes: tuple[int, ...]
    nodes: np.ndarray
    grows: str
    note: str


def edit(orbit: Orbit, index: int, params: np.ndarray) -> Edit | None:
    """The edit that margin `index` asks for at the border orbit; None if no local rule applies.

    Parameters
    ----------
    orbit : Orbit
        The border orbit, over its whole cycle.
    index : int
        Index of the vanishing margin, four per node.
    params : float array (P,)
    """
    place, column = divmod(index, PER_NODE)
    word, n = orbit.word, len(orbit.word)
    letter = word.events[place]
    after, before = word.modes[place], word.modes[place - 1]
    node = orbit.nodes[place]
    if word.frictionless:
        return _frictionless(orbit, place, column)
    if column == FLIGHT and after != 0:
        ahead, (w, _, v, v_rate) = slowest(orbit, place)
        full = np.array([node[0] + ahead, w, v, v_rate])[: orbit.nodes.shape[1]]
        early = full.copy()
        early[0] -= FIRST
        return Edit(
            place + 1, place + 1, ("s", "u"), (0, after), np.array([early, full]), "duration",
            "a stick appears inside a flight",
        )  # fmt: skip
    if letter == "s" and (column == FLIGHT or column == DURATION or column == EVENT) and place + 1 < n:
        out = word.modes[place + 1]
        if out == before:
            return Edit(place, place + 2, (), (), orbit.nodes[:0], "margin", "a stick disappears inside a flight")
        middle = node.copy()
        middle[0] = 0.5 * (node[0] + orbit.nodes[place + 1, 0])
        return Edit(place, place + 2, ("t",), (out,), middle[None], "margin", "a stick becomes a turn")
    if letter == "t" and column == EVENT:
        late = node.copy()
        late[0] += FIRST
        return Edit(place, place + 1, ("s", "u"), (0, after), np.array([node, late]), "duration", "a turn becomes a stick")
    if letter == "t" and column == WALL:
        wall = "L" if node[1] > 0.0 else "R"
        if before != (1 if wall == "L" else -1):
            return None
        return Edit(place, place + 1, (wall,), (after,), _impact(orbit, place, wall)[None], "speed", "a turn hits the wall")
    if letter in "su" and column == WALL:
        if letter == "u":
            place -= 1
            node, before = orbit.nodes[place], word.modes[place - 1]
        wall = "L" if node[1] > 0.0 else "R"
        if before != (1 if wall == "L" else -1):
            return None
        late = node.copy()
        late[0] += FIRST
        late[1] -= np.sign(node[1]) * 0.1 * FIRST**2
        hit = _impact(orbit, place, wall)
        return Edit(
            place, place + 1, (wall, "s"), (-before, 0), np.array([hit, late]), "speed", "a stick hits the wall"
        )  # fmt: skip
    if letter in "LR" and column == EVENT:
        soft = node.copy()
        soft[1] = 1.0 if letter == "L" else -1.0
        if word.events[(place + 1) % n] == "s" and place + 1 < n:
            soft[0] = orbit.nodes[place + 1, 0]
            return Edit(place, place + 2, ("s",), (0,), soft[None], "margin", "an impact before a stick vanishes")
        return Edit(place, place + 1, ("t",), (after,), soft[None], "margin", "an impact becomes a turn")
    return None


def _frictionless(orbit: Orbit, place: int, column: int) -> Edit | None:
    word = orbit.word
    if column == EVENT:
        return Edit(place, place + 1, (), (), orbit.nodes[:0], "margin", "an impact vanishes")
    if column != FLIGHT:
        return None
    from orbits.sampling import flight, lengths

    ahead = np.linspace(0.0, float(lengths(orbit)[place]), 20002)[1:-1]
    path = flight(orbit, place, ahead)
    inner = np.flatnonzero(np.diff(np.sign(path[:, 1])) != 0)
    if not inner.size:
        return None
    touch = inner[np.argmax(np.abs(path[inner, 0]))]
    wall = "L" if path[touch, 0] > 0.0 else "R"
    speed = FIRST if wall == "L" else -FIRST
    node = np.array([orbit.nodes[place, 0] + ahead[touch], path[touch, 3] + speed, *path[touch, 2:]])
    return Edit(
        place + 1, place + 1, (wall,), (-1 if wall == "L" else 1,), node[None, : orbit.nodes.shape[1]], "speed",
        "a flight touches the wall",
    )  # fmt: skip


def _impact(orbit: Orbit, place: int, wall: str) -> np.ndarray:
    """The node of an impact of vanishing speed in place of a turn or stick: B+ = v' - w'+."""
    node = orbit.nodes[place].copy()
    node[1] = orbit.events.v_rate[place] + (FIRST if wall == "L" else -FIRST)
    return node


def apply(word: Word, nodes: np.ndarray, edits: list[Edit]) -> tuple[Word, np.ndarray, int]:
    """The word and nodes after the edits (of disjoint places), and where the first edit's new events stand."""
    events, modes = list(word.events), list(word.modes)
    rows = [row for row in nodes]
    for change in sorted(edits, key=lambda e: e.start, reverse=True):
        events[change.start : change.stop] = change.events
        modes[change.start : change.stop] = change.modes
        rows[change.start : change.stop] = list(change.nodes)
    first = min(edits, key=lambda e: e.start)
    return Word(tuple(events), tuple(modes), word.frictionless), np.array(rows), first.start
