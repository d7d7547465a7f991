"""How a word changes where a margin vanishes: the proposals of the contacts' laws, put together and carried out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple, Protocol

import numpy as np

from orbits.contacts.changes import Change, Grows, Site, Spot, What
from orbits.contacts.letters import HIT, STICK, SWITCH
from orbits.words.alphabet import Watch
from orbits.words.word import Word

if TYPE_CHECKING:
    from orbits.words.alphabet import Alphabet


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


def applied(word: Word, changes: Sequence[Change]) -> tuple[Word, int]:
    """The word after some changes of disjoint places, and where the first one's new events stand."""
    events, modes = list(word.events), list(word.modes) if len(word) else []
    for change in sorted(changes, key=lambda c: c.start, reverse=True):
        events[change.start : change.stop] = change.events
        modes[change.start : change.stop] = change.modes
    first = min(change.start for change in changes)
    if not events and len(word):  # nothing is left: what the contacts did before goes on
        return word.like((), (word.mode(first - 1),)), 0
    return word.like(events, modes), first


def later(change: Change, places: int, alphabet: Alphabet, turned: bool) -> Change:
    """The same change so many events later, of the mirror image if it is turned."""
    events, modes = change.events, change.modes
    if turned:
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
    return replace(change, start=start, stop=stop, events=events, modes=modes, spots=spots)


def spliced(
    nodes: np.ndarray, changes: Sequence[Change], placed: Sequence[np.ndarray], empty: bool
) -> np.ndarray:
    """The nodes after the same changes, from the new events' nodes for each of them; where nothing is left one to look from."""
    rows = [] if empty else list(nodes)
    for change, new in sorted(zip(changes, placed), key=lambda pair: pair[0].start, reverse=True):
        rows[change.start : change.stop] = list(new)
    return np.array(rows) if rows else nodes[:1]


class Rounds(Protocol):
    """The problem of the cycles that a word describes, of which a round is one cycle, or half a symmetric one."""

    @property
    def word(self) -> Word: ...
    @property
    def symmetric(self) -> bool: ...
    @property
    def shift(self) -> float: ...
    @property
    def length(self) -> int: ...
    def middle(self, p: float) -> float: ...


class Edit(NamedTuple):
    """A change of the word, and the nodes of its new events, a row each: phase or clock first, then what is held there."""

    change: Change
    nodes: np.ndarray

    def later(self, rounds: int, problem: Rounds, p: float) -> Edit:
        """The same some rounds later, in a longer cycle; a round is a cycle of the problem, or half a symmetric one."""
        if rounds == 0:
            return self
        turned = problem.symmetric and rounds % 2 == 1
        nodes = -self.nodes if turned else self.nodes.copy()
        nodes[:, 0] = self.nodes[:, 0] + rounds * problem.shift
        if turned and (middle := problem.middle(p)):  # images are taken about the middle between the walls
            letters = problem.word.alphabet.letters
            nodes[[letters[text].kind != HIT for text in self.change.events], 1] += 2.0 * middle
        return Edit(later(self.change, rounds * problem.length, problem.word.alphabet, turned), nodes)
