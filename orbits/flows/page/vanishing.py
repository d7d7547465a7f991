"""Where a margin of a declared machine's orbit vanishes, and clocks and states of the events that the contacts' laws propose there."""

from __future__ import annotations

import numpy as np

from orbits.contacts.letters import Change, Site, Spot
from orbits.flows.protocol import Motion, Vanishing
from orbits.machines.page.machine import Machine
from orbits.numbers import SMALLEST
from orbits.settings import EVENTS, GROWING
from orbits.words.margins import place_of


def vanishing(motion: Motion[Machine], index: int, unit: int) -> Vanishing:
    """What vanishes with margin `index` of a border orbit, over its whole cycle; see `orbits.flows.protocol`."""
    place, watched = place_of(motion.word, index)
    spans = motion.durations
    site = Site(motion.word, place, spans, unit)
    if watched < 0:
        return Vanishing(site, watched)
    ahead, state, sign = _closest(motion, place, watched)
    share = ahead / max(spans[place], SMALLEST)
    site = site._replace(sign=sign, at=_end(motion, place, share), ahead=share < EVENTS.at_end)
    return Vanishing(site, watched, (ahead, state))


def _end(motion: Motion[Machine], place: int, share: float) -> int:
    """The event at that end of a flight at which a guard vanishes; -1 inside it."""
    if not len(motion.word) or EVENTS.at_end <= share <= 1.0 - EVENTS.at_end:
        return -1
    return (place if share < EVENTS.at_end else place + 1) % len(motion.word)


def _closest(motion: Motion[Machine], place: int, contact: int) -> tuple[float, np.ndarray, int]:
    """Where the guards of a contact come closest to zero in a flight: clock from its start, state, sign of the guard's event."""
    compiled, e = motion.model.compiled, motion.model.equations
    mode = motion.word.entries(place)
    key = e.pattern_key(mode)
    numbers = compiled.numbers(motion.params, mode)
    guards, values, watch = e.pattern(key).guards, compiled.guards(key), compiled.watch(key)
    begin = float(motion.nodes[place, 0]) if motion.model.forced else 0.0
    length = float(motion.durations[place])
    state = motion.nodes[place, 1:]
    candidates = [(begin, g, state) for g, guard in enumerate(guards) if guard.contact == contact]
    candidates += [c for c in watch(state, begin, begin + length, numbers) if guards[c[1]].contact == contact]
    final = watch.final
    candidates += [(begin + length, g, final) for g, guard in enumerate(guards) if guard.contact == contact]
    own_start = len(motion.word) and motion.word.letter(place).contact == contact
    own_end = len(motion.word) and motion.word.letter(place + 1).contact == contact
    best, found = np.inf, (0.0, state, 0)
    for clock, g, there in candidates:
        share = (clock - begin) / max(length, SMALLEST)
        if (own_start and share < EVENTS.at_end) or (own_end and share > 1.0 - EVENTS.at_end):
            continue
        value = abs(values(there[None], np.array([clock]), numbers[None])[0, g])
        if value < best:
            best, found = value, (clock - begin, np.array(there), guards[g].sign)
    return found


def placed(motion: Motion[Machine], found: Vanishing, place: int, change: Change) -> np.ndarray:
    """The nodes of a change's new events."""
    rows = [_at(motion, place, spot, found) for spot in change.spots]
    return np.array(rows) if rows else motion.nodes[:0]


def _at(motion: Motion[Machine], place: int, spot: Spot, found: Vanishing) -> np.ndarray:
    """Clock and states of a spot; a self-excited orbit's inserted events have the clock from the flight's start."""
    forced, nodes = motion.model.forced, motion.nodes
    if spot.node is None:
        assert found.touch is not None
        ahead, state = found.touch
        begin = float(nodes[place, 0]) if forced else 0.0
        row = np.concatenate([[begin + ahead], state])
    else:
        row = nodes[spot.node].copy()
        if spot.clock is not None:
            row[0] = nodes[spot.clock, 0]
        if spot.between:
            row[0] = (0.5 if forced else 1.0) * (row[0] + nodes[spot.node + 1, 0])
    row[0] += spot.later * GROWING.first
    return row
