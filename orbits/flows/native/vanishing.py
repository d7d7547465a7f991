"""Where a margin of a built-in machine's orbit vanishes, and the nodes of the events that the contacts' laws propose there.

At the border the old and the new description are the same motion, so an inserted event sits where the margin vanished.
"""

from __future__ import annotations

import math

import numpy as np

from orbits.contacts.dry_friction import STUCK
from orbits.contacts.letters import HIT, SLIP, Change, Site, Spot
from orbits.flows.native.sampling import flight, slowest
from orbits.flows.protocol import Motion, Vanishing
from orbits.machines.base import Model
from orbits.machines.events import events_of
from orbits.settings import EVENTS, GROWING
from orbits.words.alphabet import FLOOR, LEFT, RIGHT, Watch
from orbits.words.margins import place_of

FLIGHT = 0  # column of the margin that watches a flight


def vanishing(motion: Motion[Model], index: int, unit: int) -> Vanishing | None:
    """What vanishes with margin `index` of a border orbit, over its whole cycle; see `orbits.flows.protocol`."""
    word = motion.word
    place, watched = place_of(word, index)
    in_flight = index % len(word.alphabet.columns) == FLIGHT
    site = Site(word, place, motion.durations, unit)
    if word.frictionless and in_flight:
        soft = _soft(motion, place)
        if soft is not None:
            return Vanishing(site._replace(place=soft), Watch.STRENGTH)
        touch, wall = _touching(motion, place)
        return None if touch is None else Vanishing(site, wall, touch)
    if watched in (Watch.STRENGTH, Watch.DURATION):
        return None if word.frictionless and watched == Watch.DURATION else Vanishing(site, watched)
    if not in_flight:
        if word.frictionless:
            return None
        at = place - 1 if word.letter(place).kind == SLIP else place
        return Vanishing(site._replace(place=at, at=at), _nearer(motion, motion.nodes[at, 1]))
    if (
        word.modes[place] == STUCK
    ):  # the time to the slip jumps where the reserve of friction vanishes in the stick
        return Vanishing(site, Watch.STRENGTH)
    ahead, path = slowest(motion, place)
    return Vanishing(site, FLOOR, (ahead, path))


def _soft(motion: Motion[Model], place: int) -> int | None:
    """The event at either end of a flight that is an impact of vanishing speed."""
    places = (place, (place + 1) % len(motion.word))
    speed = EVENTS.touch * math.prod(motion.model.natural_units(motion.params))
    rates = events_of(motion).rate_post
    return next((k for k in places if abs(rates[k]) < speed), None)


def _touching(motion: Motion[Model], place: int) -> tuple[tuple[float, np.ndarray] | None, int]:
    """Where a flight that reverses freely is closest to a wall, and which."""
    ahead = np.linspace(0.0, float(motion.durations[place]), 20002)[1:-1]
    path = flight(motion, place, ahead)
    inner = np.flatnonzero(np.diff(np.sign(path[:, 1])) != 0)
    if not inner.size:
        return None, LEFT
    left, right = motion.model.walls(motion.params)
    touch = inner[np.argmin(np.minimum(left - path[inner, 0], path[inner, 0] - right))]
    return (float(ahead[touch]), path[touch]), _nearer(motion, path[touch, 0])


def _nearer(motion: Motion[Model], w: float) -> int:
    """The nearer wall."""
    left, right = motion.model.walls(motion.params)
    return LEFT if left - w < w - right else RIGHT


def placed(motion: Motion[Model], found: Vanishing, place: int, change: Change) -> np.ndarray:
    """The nodes of a change's new events: (Psi, B+) at impacts, (Psi, w) elsewhere, and what the machine adds."""
    word, nodes = motion.word, motion.nodes
    letters = word.alphabet.letters
    rows: list[np.ndarray] = []
    length, rate = motion.model.natural_units(motion.params)
    hit_before = 0  # side of a new impact among the events so far
    for text, spot in zip(change.events, change.spots):
        hit = letters[text].kind == HIT
        side = (1 if letters[text].contact == LEFT else -1) if hit else 0
        row, speed, was_hit = _at(motion, place, spot, found)
        row[0] += spot.later * GROWING.first
        if hit and not was_hit:
            row[1] = speed + side * GROWING.first * length * rate  # B+ = v' - w'+
        elif was_hit and not hit and spot.node is not None:
            row[1] = motion.model.walls(motion.params)[0 if word.letter(spot.node).contact == LEFT else 1]
        elif hit_before and not hit:
            row[1] -= hit_before * 0.1 * GROWING.first**2 * length  # a little off the wall
        hit_before = side
        rows.append(row)
    return np.array(rows) if rows else nodes[:0]


def _at(motion: Motion[Model], place: int, spot: Spot, found: Vanishing) -> tuple[np.ndarray, float, bool]:
    """The node of a spot as that of an event off the walls or as the event's own, v' there, and whether it is an impact's."""
    nodes = motion.nodes
    if spot.node is None:
        assert found.touch is not None
        ahead, path = found.touch
        row = np.array([nodes[place, 0] + ahead, path[0], *path[2:]])[: nodes.shape[1]]
        return row, float(path[3]), False
    row = nodes[spot.node].copy()
    if spot.clock is not None:
        row[0] = nodes[spot.clock, 0]
    if spot.between:
        row[0] = 0.5 * (row[0] + nodes[spot.node + 1, 0])
    speed, _ = motion.model.cavity_speed(nodes[spot.node], motion.params)
    return row, speed, motion.word.letter(spot.node).kind == HIT
