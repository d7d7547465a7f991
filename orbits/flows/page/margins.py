"""Margins of an orbit of a declared machine: they are positive if exactly the events of the word happen.

For each node and the flight after it:

- for every contact, the smallest value of its guard in the flight: at both ends (unless that event belongs to the contact), and at every
  minimum inside, found as a root of the guard's rate in the Taylor steps;
- the strength of the event;
- the duration of the flight.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from orbits.contacts import HIT, SLIP, STICK, SWITCH, TURN
from orbits.settings import EVENTS

if TYPE_CHECKING:
    from orbits.flows.page.pieces import Pieces, Work


def fill_margins(data: Pieces, u: np.ndarray, work: Work, row: np.ndarray) -> None:
    """Write all margins of a linearised solution into `row`, shape (L (contacts + 2),); infinity if one does not apply."""
    n, length, contacts = data.size, data.length, data.contacts
    nodes = np.asarray(u).reshape(length, n + 1)
    begin, end = data.clocks(nodes)
    table = row.reshape(length, contacts + 2)
    table[:] = np.inf
    table[:, contacts + 1] = (end - begin) / data.clock_rate(work.numbers)
    drift = max((abs(work.drift[j]) for j in data.pinned), default=0.0)
    if drift > EVENTS.at_rest:  # the motion returns shifted, so it is no orbit
        table[:, contacts + 1] = -drift
    for values, guards, watch, places in data.guard_groups:
        m, count = len(places), len(guards)
        if not count:
            continue
        table_of_ends = values(
            np.concatenate([nodes[places, 1:], work.arrival[places]]),
            np.concatenate([begin[places], end[places]]),
            np.concatenate([work.numbers[places], work.numbers[places]]),
        )
        at_start, at_end = table_of_ends[:m, :count], table_of_ends[m:, :count]
        rate_start, rate_end = table_of_ends[:m, count:], table_of_ends[m:, count:]
        found: list[tuple[int, int, np.ndarray, float]] = []
        for k, i in enumerate(places):
            first, last = data.letters[i], data.letters[i + 1]
            at_begin, at_stop = data.owned[i], data.owned[i + 1]
            span = end[i] - begin[i]
            for g, guard in enumerate(guards):
                j = guard.contact
                if j not in at_begin:
                    table[i, j] = min(table[i, j], at_start[k, g])
                if j not in at_stop:
                    table[i, j] = min(table[i, j], at_end[k, g])
                _strength(
                    table, data, i, first, last, guard, at_start[k, g], rate_start[k, g], rate_end[k, g]
                )
            if not span > 0.0:
                continue
            for clock, g, state in watch(nodes[i, 1:], begin[i], end[i], work.numbers[i]):
                end_part = EVENTS.at_end * span
                j = guards[g].contact
                if (j in at_begin and clock - begin[i] < end_part) or (
                    j in at_stop and end[i] - clock < end_part
                ):
                    continue
                found.append((i, g, state, clock))
        if found:
            inner = values(
                np.array([f[2] for f in found]),
                np.array([f[3] for f in found]),
                work.numbers[[f[0] for f in found]],
            )
            for (i, g, _, _), point in zip(found, inner):
                j = guards[g].contact
                table[i, j] = min(table[i, j], point[g])


def _strength(table, data, i, first, last, guard, start, rate_start, rate_end) -> None:
    """Write the strength of the events at both ends of flight i, as far as it follows from this guard."""
    column = data.contacts
    following = (i + 1) % data.length
    if guard.contact == first.contact:
        if first.kind == TURN or first.kind == SWITCH:
            table[i, column] = min(table[i, column], rate_start)
        elif first.kind == STICK:
            table[i, column] = min(table[i, column], start)
    if guard.contact == last.contact and (
        last.kind in (HIT, SWITCH) or (last.kind == SLIP and guard.sign == data.slips[i + 1])
    ):
        table[following, column] = min(table[following, column], -rate_end)
