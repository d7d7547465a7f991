"""How the word changes at a border: what the contacts' laws propose, with the nodes of the new events, and the word and nodes that come of it.

The laws (`orbits.contacts`) say how the word changes and where the new events are; the flow gives them their numbers.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from orbits.contacts import HIT, STICK, SWITCH, Change, Grows, Site, Spot, What
from orbits.orbit import Orbit
from orbits.protocol import CycleProblem
from orbits.settings import BORDERING, GROWING
from orbits.words import Word, place_of
from orbits.words.alphabet import Watch


def edits_at(orbit: Orbit, index: int, unit: int | None = None) -> list[Edit]:
    """The edits that margin `index` may ask for at the border orbit, the likeliest first.

    Parameters
    ----------
    orbit : Orbit
        The border orbit, over its whole cycle, read so that the margin's event is not the last one.
    index : int
        Index of the vanishing margin.
    unit : int, optional
        Number of events after which the cycle repeats, or mirrors, itself; default: all.
    """
    found = orbit.flow.vanishing(orbit, index, unit or len(orbit.word))
    if found is None:
        return []
    place, _ = place_of(orbit.word, index)
    changes = changes_at(found.site, found.watched)
    return [Edit(change, orbit.flow.placed(orbit, found, place, change)) for change in changes]


def rewritten(word: Word, nodes: np.ndarray, edits: list[Edit]) -> tuple[Word, np.ndarray, int]:
    """The word and nodes after the edits (of disjoint places), and where the first edit's new events stand; where nothing is left one node to look from."""
    full = len(word) > 0
    events, modes, rows = list(word.events), list(word.modes) if full else [], list(nodes) if full else []
    for change, new in sorted(edits, key=lambda edit: edit.change.start, reverse=True):
        place = slice(change.start, change.stop)
        events[place], modes[place], rows[place] = change.events, change.modes, list(new)
    first = min(edit.change.start for edit in edits)
    if full and not events:  # what the contacts did before goes on
        return word.like((), (word.mode(first - 1),)), nodes[:1], 0
    return word.like(events, modes), np.array(rows) if rows else nodes[:1], first


def durations_after(durations: np.ndarray, nodes: np.ndarray, edit: Edit) -> np.ndarray:
    """Nodes of a self-excited orbit after an edit, whose inserted events have clocks from the flight's start: durations in their place.

    Parameters
    ----------
    durations : ndarray, shape (L,)
        Before the edit.
    nodes : ndarray
        After it.
    edit : Edit
    """
    nodes = nodes.copy()
    change, m = edit.change, len(edit.change.events)
    if change.start == change.stop and m:  # inserted into the flight before `start`
        if len(nodes) == m:  # the first events of a motion that had none
            nodes[:, 0] = np.diff(np.append(edit.nodes[:, 0], edit.nodes[0, 0] + durations.sum()))
            return nodes
        inside = np.append(edit.nodes[:, 0], durations[change.start - 1])
        nodes[change.start - 1, 0] = inside[0]
        nodes[change.start : change.start + m, 0] = np.diff(inside)
        return nodes
    # from the event before `start` to that at `stop` it takes as long as before
    alone = len(nodes) == m  # nothing of the old word is left: the last flight leads to the first new event
    passed = np.cumsum(np.roll(durations, 1 - change.start)[: change.stop - change.start + 1])
    instants = [_instant(spot, change.start, passed) for spot in change.spots]
    whole = [*instants, instants[0] + durations.sum()] if alone else [0.0, *instants, passed[-1]]
    spans = np.maximum(np.diff(whole), BORDERING.least_flight)
    nodes[(np.arange(len(spans)) + change.start - (0 if alone else 1)) % len(nodes), 0] = spans
    return nodes


def _instant(spot: Spot, start: int, passed: np.ndarray) -> float:
    """When the event of a spot happens, `passed` after the event before `start`."""
    event = spot.node if spot.clock is None else spot.clock
    assert event is not None  # nothing is met where events give way to others
    place = event - start
    ahead = 0.5 * (passed[place + 1] - passed[place]) if spot.between else 0.0
    return float(passed[place] + ahead + spot.later * GROWING.first)


def changes_at(site: Site, watched: int) -> list[Change]:
    """The changes that a vanishing margin may ask for, the likeliest first.

    Parameters
    ----------
    site : Site
        The cycle must be read so that the margin's event is not the last one.
    watched : int
        Index of the contact that is met in the flight after the event, or one of `Watch`.
    """
    word, contacts = site.word, site.word.alphabet.contacts
    if watched >= 0:
        return contacts[watched].met(site, watched)
    if not len(word):
        return []
    here = word.letter(site.place)
    if watched == Watch.STRENGTH:
        return contacts[here.contact].weakened(site, here.contact)
    if site.place + 1 >= len(word):
        return []
    there = word.letter(site.place + 1)
    if here.contact == there.contact:
        return contacts[here.contact].collapsed(site, here.contact)
    alphabet = word.alphabet
    for one, other in ((here, there), (there, here)):
        if (one.contact, other.contact) in alphabet.rides:
            return contacts[one.contact].collapsed(site, one.contact)
    if alphabet.touches(here, there.contact) or alphabet.touches(there, here.contact):
        if SWITCH in (here.kind, there.kind):
            switch = (here if here.kind == SWITCH else there).contact
            return contacts[switch].collapsed(site, switch)
        alone = here.kind == HIT and there.kind != STICK
        return [] if alone else contacts[here.contact].weakened(site, here.contact)
    return [_swapped(site)]


def _swapped(site: Site) -> Change:
    """Two consecutive events of contacts that do not know each other change their order."""
    word, place = site.word, site.place
    here, there = word.events[place], word.events[place + 1]
    between = word.mode(place - 1)
    for j in range(len(word.alphabet.contacts)):
        if site.entry(place + 1, j) != site.entry(place, j):
            between = word.alphabet.with_entry(between, j, site.entry(place + 1, j))
    modes, spots = (between, word.mode(place + 1)), (Spot(place), Spot(place + 1))
    return Change(place, place + 2, (there, here), modes, spots, Grows.MARGIN, What.ORDER_CHANGES)


class Edit(NamedTuple):
    """A change of the word, and the nodes of its new events, a row each: phase or clock first, then what is held there."""

    change: Change
    nodes: np.ndarray

    def later(self, rounds: int, problem: CycleProblem, p: float) -> Edit:
        """The same some rounds later, in a longer cycle; a round is a cycle of the problem, or half a symmetric one."""
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
