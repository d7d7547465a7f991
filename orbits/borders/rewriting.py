"""Rewrite the word of an orbit at a border.

The laws of the contacts (`orbits.contacts`) propose changes of the word and the places of the new events; the flow computes the nodes of these
events; `rewritten` applies both to the word and nodes of the orbit.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from orbits.contacts import HIT, STICK, SWITCH, Change, Grows, Site, Spot, WordChange
from orbits.orbit import Orbit
from orbits.protocol import CycleProblem
from orbits.settings import BORDERING, GROWING
from orbits.words import Word, place_of
from orbits.words.alphabet import Watch


def edits_at(orbit: Orbit, index: int, unit: int | None = None) -> list[Edit]:
    """Edits of a border orbit at which margin `index` vanishes, the likeliest first.

    Parameters
    ----------
    orbit : Orbit
        The border orbit over its whole cycle, rotated so that the margin's event is not the last one.
    index : int
        Index of the vanishing margin.
    unit : int, optional
        Number of events after which the cycle repeats itself or its mirror image; default: all.
    """
    found = orbit.flow.vanishing(orbit, index, unit or len(orbit.word))
    if found is None:
        return []
    place, _ = place_of(orbit.word, index)
    changes = changes_at(found.site, found.watched)
    return [Edit(change, orbit.flow.placed(orbit, found, place, change)) for change in changes]


def rewritten(word: Word, nodes: np.ndarray, edits: list[Edit]) -> tuple[Word, np.ndarray, int]:
    """Apply edits of disjoint places: the new word, its nodes, and the index of the first new event; for an empty word one node remains."""
    full = len(word) > 0
    events, modes, rows = list(word.events), list(word.modes) if full else [], list(nodes) if full else []
    for change, new in sorted(edits, key=lambda edit: edit.change.start, reverse=True):
        place = slice(change.start, change.stop)
        events[place], modes[place], rows[place] = change.events, change.modes, list(new)
    first = min(edit.change.start for edit in edits)
    if full and not events:  # the contacts keep the mode before the edit
        return word.like((), (word.mode(first - 1),)), nodes[:1], 0
    return word.like(events, modes), np.array(rows) if rows else nodes[:1], first


def durations_after(durations: np.ndarray, nodes: np.ndarray, edit: Edit) -> np.ndarray:
    """Nodes of a self-excited orbit after an edit, with the durations of the flights in the first column.

    Parameters
    ----------
    durations : ndarray, shape (L,)
        Durations of the flights before the edit.
    nodes : ndarray
        Nodes after the edit; the first entry of an inserted event is its time since the flight began.
    edit : Edit
    """
    nodes = nodes.copy()
    change, m = edit.change, len(edit.change.events)
    if change.start == change.stop and m:  # inserted into the flight before `start`
        if len(nodes) == m:  # the orbit had no events before
            nodes[:, 0] = np.diff(np.append(edit.nodes[:, 0], edit.nodes[0, 0] + durations.sum()))
            return nodes
        inside = np.append(edit.nodes[:, 0], durations[change.start - 1])
        nodes[change.start - 1, 0] = inside[0]
        nodes[change.start : change.start + m, 0] = np.diff(inside)
        return nodes
    # the time from the event before `start` to that at `stop` stays the same
    fresh = len(nodes) == m  # no event of the old word remains: the last flight leads to the first new event
    passed = np.cumsum(np.roll(durations, 1 - change.start)[: change.stop - change.start + 1])
    instants = [_instant(spot, change.start, passed) for spot in change.spots]
    whole = [*instants, instants[0] + durations.sum()] if fresh else [0.0, *instants, passed[-1]]
    spans = np.maximum(np.diff(whole), BORDERING.least_flight)
    nodes[(np.arange(len(spans)) + change.start - (0 if fresh else 1)) % len(nodes), 0] = spans
    return nodes


def _instant(spot: Spot, start: int, passed: np.ndarray) -> float:
    """Time of a spot's event, from the cumulative times `passed` since the event before `start`."""
    event = spot.node if spot.clock is None else spot.clock
    assert event is not None  # a change that replaces events meets no contact
    place = event - start
    ahead = 0.5 * (passed[place + 1] - passed[place]) if spot.between else 0.0
    return float(passed[place] + ahead + spot.later * GROWING.first)


def changes_at(site: Site, watched: int) -> list[Change]:
    """Changes of the word that a vanishing margin may cause, the likeliest first.

    Parameters
    ----------
    site : Site
        Place of the margin in the cycle, which must be rotated so that the margin's event is not the last one.
    watched : int
        Index of the contact that is met in the flight after the event, or a member of `Watch`.
    """
    word, contacts = site.word, site.word.alphabet.contacts
    if watched >= 0:
        return contacts[watched].met(site, watched)
    if not len(word):
        return []
    event = word.letter(site.place)
    if watched == Watch.STRENGTH:
        return contacts[event.contact].weakened(site, event.contact)
    if site.place + 1 >= len(word):
        return []
    next_event = word.letter(site.place + 1)
    if event.contact == next_event.contact:
        return contacts[event.contact].collapsed(site, event.contact)
    alphabet = word.alphabet
    for one, other in ((event, next_event), (next_event, event)):
        if (one.contact, other.contact) in alphabet.rides:
            return contacts[one.contact].collapsed(site, one.contact)
    if alphabet.touches(event, next_event.contact) or alphabet.touches(next_event, event.contact):
        if SWITCH in (event.kind, next_event.kind):
            switch = (event if event.kind == SWITCH else next_event).contact
            return contacts[switch].collapsed(site, switch)
        impact_only = event.kind == HIT and next_event.kind != STICK
        return [] if impact_only else contacts[event.contact].weakened(site, event.contact)
    return [_swapped(site)]


def _swapped(site: Site) -> Change:
    """Exchange two consecutive events of independent contacts."""
    word, place = site.word, site.place
    first, second = word.events[place], word.events[place + 1]
    between = word.mode(place - 1)
    for j in range(len(word.alphabet.contacts)):
        if site.entry(place + 1, j) != site.entry(place, j):
            between = word.alphabet.with_entry(between, j, site.entry(place + 1, j))
    modes, spots = (between, word.mode(place + 1)), (Spot(place), Spot(place + 1))
    return Change(place, place + 2, (second, first), modes, spots, Grows.MARGIN, WordChange.ORDER_CHANGES)


class Edit(NamedTuple):
    """A change of the word, and the nodes of its new events, one row each: phase or time, then the other unknowns."""

    change: Change
    nodes: np.ndarray

    def later(self, rounds: int, problem: CycleProblem, p: float) -> Edit:
        """The same edit `rounds` rounds later, in a longer cycle; a round is a cycle of the problem, or half of a symmetric one."""
        if rounds == 0:
            return self
        change, alphabet, places = self.change, problem.word.alphabet, rounds * problem.length
        turned = problem.symmetric and rounds % 2 == 1
        nodes = -self.nodes if turned else self.nodes.copy()
        nodes[:, 0] = self.nodes[:, 0] + rounds * problem.shift
        events, modes = change.events, change.modes
        if turned:
            if middle := problem.middle(p):  # images are taken about the middle between the walls
                nodes[[alphabet.letters[text].kind != HIT for text in events], 1] += 2.0 * middle
            events = tuple(alphabet.images[text] for text in events)
            modes = tuple(alphabet.mirrored_mode(mode) for mode in modes)
        spots = tuple(
            spot._replace(
                node=None if spot.node is None else spot.node + places,
                clock=None if spot.clock is None else spot.clock + places,
            )
            for spot in change.spots
        )
        start, stop = change.start + places, change.stop + places
        return Edit(replace(change, start=start, stop=stop, events=events, modes=modes, spots=spots), nodes)
