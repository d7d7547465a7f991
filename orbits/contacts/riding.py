"""A surface that moves with the velocity of a friction: how the word changes where that turns or sticks just on the surface.

The surface has an extreme wherever the friction turns, or sticks and slips back: beyond it the word has a crossing before that event
and another one after it. Where it sticks and slips on, the crossing comes either before the stick or after the slip.
"""

from __future__ import annotations

from orbits.contacts.changes import Change, Grows, Site, Spot, What
from orbits.contacts.letters import SLIP, STICK, SWITCH, TURN
from orbits.settings import GROWING


def touched(site: Site, j: int, k: int) -> list[Change]:
    """A turn, or a stick from which it slips back, of friction k meets the surface of switch j, which the word does not cross there."""
    word, text_of = site.word, site.word.alphabet.text_of
    at = site.at - 1 if site.is_event(site.at, k, SLIP) else site.at
    stop = at + 2 if site.is_event(at + 1, k, SLIP) else at + 1
    if not site.is_event(at, k, TURN, STICK) or (stop == at + 1 and not site.is_event(at, k, TURN)):
        return []
    here = site.entry(at, j)
    if site.entry(stop - 1, k) == site.entry(at - 1, k):
        return []  # it goes on through the surface: the word has that crossing already
    inner = range(at, stop)
    events = (text_of(j, SWITCH, -here), *(word.events[i] for i in inner), text_of(j, SWITCH, here))
    modes = (site.mode(at - 1, j, -here), *(site.mode(i, j, -here) for i in inner), word.mode(stop - 1))
    spots = (Spot(at, later=-1.0), *(Spot(i) for i in inner), Spot(stop - 1, later=1.0))
    return [Change(at, stop, events, modes, spots, Grows.GAP, What.CROSSINGS_APPEAR)]


def withdrawn(site: Site, j: int) -> list[Change]:
    """The crossings of switch j beside a turn or a stick of a friction with which its surface moves fall into it."""
    word = site.word
    frictions = [k for (switch, k) in word.alphabet.rides if switch == j]
    found = []
    for k in frictions:
        for at in range(max(0, site.place - 2), min(len(word), site.place + 3)):
            if site.is_event(at, k, TURN) or (site.is_event(at, k, STICK) and site.is_event(at + 1, k, SLIP)):
                found += _withdrawn(site, j, at)
    return found


def _withdrawn(site: Site, j: int, at: int) -> list[Change]:
    word = site.word
    stop = at + 1 if word.letter(at).kind == TURN else at + 2
    before = site.is_event(at - 1, j, SWITCH) and site.lengths[at - 1] < GROWING.close
    after = site.is_event(stop, j, SWITCH) and site.lengths[stop - 1] < GROWING.close
    inner = range(at, stop)
    events = tuple(word.events[i] for i in inner)
    spots = tuple(Spot(i) for i in inner)
    if before and after:
        outside = site.entry(at - 2, j)
        modes = tuple(site.mode(i, j, outside) for i in inner)
        return [Change(at - 1, stop + 1, events, modes, spots, Grows.MARGIN, What.CROSSINGS_VANISH)]
    if stop == at + 1 or before == after:
        return []
    if before:  # beyond the border it sticks before it reaches the surface
        outside = site.entry(at - 2, j)
        modes = (*(site.mode(i, j, outside) for i in inner), word.mode(stop - 1))
        events, spots = (*events, word.events[at - 1]), (*spots, Spot(stop - 1, later=1.0))
        return [Change(at - 1, stop, events, modes, spots, Grows.MARGIN, What.ORDER_CHANGES)]
    inside = site.entry(stop, j)
    modes = (site.mode(at - 1, j, inside), *(site.mode(i, j, inside) for i in inner))
    events, spots = (word.events[stop], *events), (Spot(at, later=-1.0), *spots)
    return [Change(at, stop + 1, events, modes, spots, Grows.MARGIN, What.ORDER_CHANGES)]
