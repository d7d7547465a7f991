"""What the contacts' laws propose at a border orbit, with the nodes of the new events.

At the border the old and the new description are the same motion, so an inserted event sits where the margin vanished. The laws
(`orbits.contacts`) say how the word changes and where the new events are; here they get their numbers.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from orbits.contacts.changes import Change, Site, Spot
from orbits.contacts.dry_friction import STUCK
from orbits.contacts.letters import HIT, SLIP
from orbits.cycles.solution import Solution
from orbits.flows.native.sampling import flight, slowest
from orbits.words import Word
from orbits.words.alphabet import FLOOR, LEFT, RIGHT
from orbits.words.edit import Edit
from orbits.words.margins import DURATION, EVENT, FLIGHT, PER_NODE, WALL
from orbits.words.rewriting import Watch, applied, changes_at, spliced

NO_SPEED = 1e-7  # an impact slower than this vanishes
FIRST = 2e-3  # size of what grows from nothing: radians of phase, or speed
WATCHED = {EVENT: Watch.STRENGTH, DURATION: Watch.DURATION}


class _Touch(NamedTuple):
    """Where a margin vanishes inside a flight: phase ahead of the event before, and (w, w', v, v') there."""

    ahead: float
    path: np.ndarray


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
    word, touch = orbit.word, None
    site = Site(word, place, orbit.durations, unit or len(word))
    if word.frictionless and column == FLIGHT:
        soft = _soft(orbit, place)
        if soft is not None:
            site, column = site._replace(place=soft), EVENT
        else:
            touch, watched = _touching(orbit, place)
            if touch is None:
                return []
    elif word.frictionless and column != EVENT:
        return []
    if column in WATCHED:
        watched = WATCHED[column]
    elif column == WALL:
        at = place - 1 if word.letter(place).kind == SLIP else place
        site, watched = site._replace(place=at, at=at), _nearer(orbit, orbit.nodes[at, 1])
    elif (
        word.modes[place] == STUCK
    ):  # the time to the slip jumps where the reserve of friction vanishes in the stick
        watched = Watch.STRENGTH
    elif not word.frictionless:
        watched, touch = FLOOR, _Touch(*slowest(orbit, place))
    changes = changes_at(site, watched)
    return [Edit(change, _placed(orbit, place, change, touch)) for change in changes]


def _soft(orbit: Solution, place: int) -> int | None:
    """The event at either end of a flight that is an impact of vanishing speed."""
    places = (place, (place + 1) % len(orbit.word))
    speed = NO_SPEED * math.prod(orbit.model.natural_units(orbit.params))
    return next((k for k in places if abs(orbit.events.rate_post[k]) < speed), None)


def _touching(orbit: Solution, place: int) -> tuple[_Touch | None, int]:
    """Where a flight that reverses freely is closest to a wall, and which."""
    ahead = np.linspace(0.0, float(orbit.durations[place]), 20002)[1:-1]
    path = flight(orbit, place, ahead)
    inner = np.flatnonzero(np.diff(np.sign(path[:, 1])) != 0)
    if not inner.size:
        return None, LEFT
    left, right = orbit.model.walls(orbit.params)
    touch = inner[np.argmin(np.minimum(left - path[inner, 0], path[inner, 0] - right))]
    return _Touch(float(ahead[touch]), path[touch]), _nearer(orbit, path[touch, 0])


def _nearer(orbit: Solution, w: float) -> int:
    """The nearer wall."""
    left, right = orbit.model.walls(orbit.params)
    return LEFT if left - w < w - right else RIGHT


def _placed(orbit: Solution, place: int, change: Change, touch: _Touch | None) -> np.ndarray:
    """The nodes of a change's new events: (Psi, B+) at impacts, (Psi, w) elsewhere, and what the machine adds."""
    word, nodes = orbit.word, orbit.nodes
    letters = word.alphabet.letters
    rows: list[np.ndarray] = []
    length, rate = orbit.model.natural_units(orbit.params)
    hit_before = 0  # side of a new impact among the events so far
    for text, spot in zip(change.events, change.spots):
        hit = letters[text].kind == HIT
        side = (1 if letters[text].contact == LEFT else -1) if hit else 0
        row, speed, was_hit = _at(orbit, place, spot, touch)
        row[0] += spot.later * FIRST
        if hit and not was_hit:
            row[1] = speed + side * FIRST * length * rate  # B+ = v' - w'+
        elif was_hit and not hit and spot.node is not None:
            row[1] = orbit.model.walls(orbit.params)[0 if word.letter(spot.node).contact == LEFT else 1]
        elif hit_before and not hit:
            row[1] -= hit_before * 0.1 * FIRST**2 * length  # a little off the wall
        hit_before = side
        rows.append(row)
    return np.array(rows) if rows else nodes[:0]


def _at(orbit: Solution, place: int, spot: Spot, touch: _Touch | None) -> tuple[np.ndarray, float, bool]:
    """The node of a spot as that of an event off the walls or as the event's own, v' there, and whether it is an impact's."""
    nodes = orbit.nodes
    if spot.node is None:
        assert touch is not None
        row = np.array([nodes[place, 0] + touch.ahead, touch.path[0], *touch.path[2:]])[: nodes.shape[1]]
        return row, float(touch.path[3]), False
    row = nodes[spot.node].copy()
    if spot.clock is not None:
        row[0] = nodes[spot.clock, 0]
    if spot.between:
        row[0] = 0.5 * (row[0] + nodes[spot.node + 1, 0])
    speed, _ = orbit.model.cavity_speed(nodes[spot.node], orbit.params)
    return row, speed, orbit.word.letter(spot.node).kind == HIT


def rewritten(word: Word, nodes: np.ndarray, edits: list[Edit]) -> tuple[Word, np.ndarray, int]:
    """The word and nodes after the edits (of disjoint places), and where the first edit's new events stand."""
    changes = [edit.change for edit in edits]
    new, first = applied(word, changes)
    return new, spliced(nodes, changes, [edit.nodes for edit in edits], not len(word)), first
