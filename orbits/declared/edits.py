"""What the contacts' laws propose at a border orbit of a declared machine, with the nodes of the new events.

The laws (`orbits.contacts`) say how the word changes and where the new events are; here they get their clocks and states.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from orbits.contacts.changes import Change, Site, Spot
from orbits.flows.page.margins import per_node
from orbits.flows.page.sampling import lengths
from orbits.words.edit import Edit
from orbits.words.rewriting import Watch, changes_at

FIRST = 2e-3  # size of what grows from nothing
AT_END = 1e-9  # share of a flight from its ends within which a guard vanishes there


class _Touch(NamedTuple):
    """Where a guard vanishes in a flight: clock from its start, state, sign of the guard's event."""

    ahead: float
    state: np.ndarray
    sign: int


def edits_at(orbit: Any, index: int) -> list[Edit]:
    """The edits that margin `index` may ask for at a border orbit, the likeliest first.

    The orbit must be read so that the margin's event is not the last one (see `crossing.turned`).
    """
    contacts = orbit.machine.contacts
    place, column = divmod(index, per_node(len(contacts)))
    spans = lengths(orbit)
    site, touch = Site(orbit.word, place, spans, len(orbit.word)), None
    if column < len(contacts):
        watched, touch = column, closest(orbit, place, column)
        share = touch.ahead / max(spans[place], 1e-300)
        site = site._replace(sign=touch.sign, at=_end(orbit, place, share), ahead=share < AT_END)
    else:
        watched = Watch.STRENGTH if column == len(contacts) else Watch.DURATION
    return [Edit(change, _placed(orbit, place, change, touch)) for change in changes_at(site, watched)]


def _end(orbit: Any, place: int, share: float) -> int:
    """The event at that end of a flight at which a guard vanishes; -1 inside it."""
    if not len(orbit.word) or AT_END <= share <= 1.0 - AT_END:
        return -1
    return (place if share < AT_END else place + 1) % len(orbit.word)


def closest(orbit: Any, place: int, contact: int) -> _Touch:
    """Where the guards of a contact come closest to zero in a flight."""
    machine = orbit.machine
    compiled, e = machine.compiled, machine.equations
    mode = orbit.word.mode(place)
    key = e.pattern_key(mode)
    numbers = compiled.numbers(orbit.params, mode)
    guards, values, watch = e.pattern(key).guards, compiled.guards(key), compiled.watch(key)
    begin = float(orbit.nodes[place, 0]) if machine.forced else 0.0
    length = float(lengths(orbit)[place])
    state = orbit.nodes[place, 1:]
    candidates = [(begin, g, state) for g, guard in enumerate(guards) if guard.contact == contact]
    candidates += [c for c in watch(state, begin, begin + length, numbers) if guards[c[1]].contact == contact]
    final = watch.final
    candidates += [(begin + length, g, final) for g, guard in enumerate(guards) if guard.contact == contact]
    own_start = len(orbit.word) and orbit.word.letter(place).contact == contact
    own_end = len(orbit.word) and orbit.word.letter(place + 1).contact == contact
    best, found = np.inf, _Touch(0.0, state, 0)
    for clock, g, there in candidates:
        share = (clock - begin) / max(length, 1e-300)
        if (own_start and share < AT_END) or (own_end and share > 1.0 - AT_END):
            continue
        value = abs(values(there[None], np.array([clock]), numbers[None])[0, g])
        if value < best:
            best, found = value, _Touch(clock - begin, np.array(there), guards[g].sign)
    return found


def _placed(orbit: Any, place: int, change: Change, touch: _Touch | None) -> np.ndarray:
    """The nodes of a change's new events."""
    rows = [_at(orbit, place, spot, touch) for spot in change.spots]
    return np.array(rows) if rows else orbit.nodes[:0]


def _at(orbit: Any, place: int, spot: Spot, touch: _Touch | None) -> np.ndarray:
    """Clock and states of a spot; a self-excited orbit's inserted events have the clock from the flight's start."""
    forced, nodes = orbit.machine.forced, orbit.nodes
    if spot.node is None:
        assert touch is not None
        begin = float(nodes[place, 0]) if forced else 0.0
        row = np.concatenate([[begin + touch.ahead], touch.state])
    else:
        row = nodes[spot.node].copy()
        if spot.clock is not None:
            row[0] = nodes[spot.clock, 0]
        if spot.between:
            row[0] = (0.5 if forced else 1.0) * (row[0] + nodes[spot.node + 1, 0])
    row[0] += spot.later * FIRST
    return row
