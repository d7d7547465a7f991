"""Switches: surfaces at which the equations change without a jump of the state; their letters, signs and changes of words.

A surface function may depend on a position whose velocity is that of a friction (`Alphabet.rides`). Then it has an extremum wherever the
friction turns, or sticks and slips back: if the extremum passes zero, the word gets a crossing before this event and one after it. If the
friction sticks and slips on, the crossing is either before the stick or after the slip.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar

from contvines.shared.near_names import hinted
from orbits.contacts import (
    SLIP,
    STICK,
    SWITCH,
    TURN,
    Change,
    Grows,
    Letter,
    NotAlternating,
    Site,
    Spot,
    WordChange,
)
from orbits.settings import GROWING


@hinted
@dataclass(frozen=True, eq=False)
class Switch:
    """A surface at which the equations of motion change: stops with springs, backlash, clutches.

    The function `motion` of a machine file reads the sign of the surface, +1 or -1, as ``contact.<name>``.

    Parameters
    ----------
    name : str
        The letters are ``name+`` and ``name-``, with the sign after the event.
    surface : callable
        ``(state, phase, p)`` -> a number that is zero on the surface.
    """

    name: str
    surface: Callable

    reversal: ClassVar[int] = SWITCH
    """Kind of the event at which the sign changes without an impact."""

    @property
    def letters(self) -> tuple[str, str]:
        """Letters of the two crossings."""
        return (f"{self.name}+", f"{self.name}-")

    @property
    def described(self) -> str:
        """Kind of contact and its name, for messages."""
        return f"switch {self.name!r}"

    def events(self, j: int) -> list[Letter]:
        """Return the letters, for the contact with index j."""
        plus, minus = self.letters
        return [Letter(plus, j, SWITCH, 1), Letter(minus, j, SWITCH, -1)]

    def mirrored(self, mode: int, turned: bool) -> int:
        """Return the sign of the mirror image."""
        return -mode if turned else mode

    def watched(self, mode: int) -> str:
        """Return the name of its margin inside a flight."""
        return "switch"

    def together(self, first: int, second: int) -> str:
        """Return the kind of border at which two consecutive crossings coincide."""
        return "switch-graze"

    def signs(
        self,
        letters: Sequence[Letter],
        j: int,
        noted: Mapping[int, int],
        hits: Mapping[int, int | None],
    ) -> list[int]:
        """Return the sign after each event of a word.

        Parameters
        ----------
        letters : sequence of Letter
            Letters of the whole word.
        j : int
            Index of this contact.
        noted : mapping
            Event -> sign after it, for events with a written mode.
        hits : mapping
            Impact that may jump over the surface -> sign after it (before it: the opposite sign); None: both signs are possible.

        Raises
        ------
        NotAlternating
            If the crossings do not alternate.
        """
        n = len(letters)
        crossings = [i for i in range(n) if letters[i].contact == j]
        places = sorted([*crossings, *hits])
        if not places:
            return [next(iter(noted.values()), 1)] * n
        fixed = {i: letters[i].sign for i in crossings} | {
            i: sign for i, sign in hits.items() if sign is not None
        }
        last = [bisect_right(places, i) - 1 for i in range(n)]  # -1: the last one, cyclically
        after = {places[last[i]]: sign for i, sign in noted.items()} | fixed
        for k, i in enumerate(places):  # a crossing determines the sign before it
            if i in fixed:
                after.setdefault(places[k - 1], -fixed[i])
        for k in range(2 * len(places)):  # an impact after which both signs are possible keeps the sign
            before = after.get(places[(k - 1) % len(places)])
            if before is not None:
                after.setdefault(places[k % len(places)], before)
        after = {i: after.get(i, 1) for i in places}
        if any(after[places[k - 1]] != -fixed[i] for k, i in enumerate(places) if i in fixed):
            raise NotAlternating
        return [after[places[k]] for k in last]

    # ------------------------------------------------------------------ how the word changes
    def met(self, site: Site, j: int) -> list[Change]:
        """Return the changes if a flight touches the surface: two crossings appear, or one next to an impact."""
        word = site.word
        if len(word) and site.lengths[site.place] < GROWING.close:
            found = self.collapsed(site, j)
            if found:
                return found
        if site.at >= 0 and (j, word.letter(site.at).contact) in word.alphabet.rides:
            return touched(site, j, word.letter(site.at).contact)
        if site.at >= 0 and (word.letter(site.at).contact, j) in word.alphabet.flips:
            return [self._next_to_impact(site, j)]
        if len(word) and site.lengths[site.place] < GROWING.close:
            return []
        mode, start = word.mode(site.place), site.place + 1 if len(word) else 0
        side, text_of = site.entry(site.place, j), word.alphabet.text_of
        events = (text_of(j, SWITCH, -side), text_of(j, SWITCH, side))
        modes = (word.alphabet.with_entry(mode, j, -side), mode)
        spots = (Spot(None, later=-0.5), Spot(None, later=0.5))
        return [Change(start, start, events, modes, spots, Grows.GAP, WordChange.CROSSINGS_APPEAR)]

    def _next_to_impact(self, site: Site, j: int) -> Change:
        """Return the change if an impact ends or begins at the surface: a crossing appears just after or just before it."""
        word, at = site.word, site.at
        side, text_of, hit = site.entry(site.place, j), word.alphabet.text_of, word.events[at]
        if site.ahead:
            events, modes = (hit, text_of(j, SWITCH, side)), (site.mode(at, j, -side), word.mode(at))
            spots = (Spot(at), Spot(at, later=1.0))
        else:
            events, modes = (text_of(j, SWITCH, -side), hit), (site.mode(at - 1, j, -side), word.mode(at))
            spots = (Spot(at, later=-1.0), Spot(at))
        return Change(at, at + 1, events, modes, spots, Grows.GAP, WordChange.CROSSING_APPEARS)

    def weakened(self, site: Site, j: int) -> list[Change]:
        """Return the changes if the rate at a crossing vanishes: two coinciding crossings disappear."""
        word, found = site.word, withdrawn(site, j)
        for first in (site.place, site.place - 1):
            if first < 0 or first + 1 >= len(word):
                continue
            if (
                word.letter(first).contact == word.letter(first + 1).contact
                and site.lengths[first] < GROWING.close
            ):
                found.append(Change(first, first + 2, (), (), (), Grows.MARGIN, WordChange.CROSSINGS_VANISH))
        return found

    def collapsed(self, site: Site, j: int) -> list[Change]:
        """Return the changes if two consecutive crossings coincide, or one coincides with an impact that jumps over the surface."""
        word, place = site.word, site.place
        for hit, crossing in ((place, place + 1), (place + 1, place)):
            jumped = (word.letter(hit).contact, j) in word.alphabet.flips
            if jumped and place + 1 < len(word) and site.is_event(crossing, j, SWITCH):
                events, modes, spots = (word.events[hit],), (word.mode(place + 1),), (Spot(hit),)
                return [
                    Change(place, place + 2, events, modes, spots, Grows.MARGIN, WordChange.CROSSING_VANISHES)
                ]
        return self.weakened(site, j)


def touched(site: Site, j: int, k: int) -> list[Change]:
    """Return the changes if a turn of friction k, or a stick from which it slips back, reaches the surface of switch j without a crossing."""
    word, text_of = site.word, site.word.alphabet.text_of
    at = site.at - 1 if site.is_event(site.at, k, SLIP) else site.at
    stop = at + 2 if site.is_event(at + 1, k, SLIP) else at + 1
    if not site.is_event(at, k, TURN, STICK) or (stop == at + 1 and not site.is_event(at, k, TURN)):
        return []
    side = site.entry(at, j)
    if site.entry(stop - 1, k) == site.entry(at - 1, k):
        return []  # the motion continues through the surface: the word has this crossing already
    inner = range(at, stop)
    events = (text_of(j, SWITCH, -side), *(word.events[i] for i in inner), text_of(j, SWITCH, side))
    modes = (site.mode(at - 1, j, -side), *(site.mode(i, j, -side) for i in inner), word.mode(stop - 1))
    spots = (Spot(at, later=-1.0), *(Spot(i) for i in inner), Spot(stop - 1, later=1.0))
    return [Change(at, stop, events, modes, spots, Grows.GAP, WordChange.CROSSINGS_APPEAR)]


def withdrawn(site: Site, j: int) -> list[Change]:
    """Return the changes if crossings of switch j coincide with a turn or stick of a friction with which its surface moves."""
    word = site.word
    frictions = [k for (switch, k) in word.alphabet.rides if switch == j]
    found = []
    for k in frictions:
        for at in range(max(0, site.place - 2), min(len(word), site.place + 3)):
            if site.is_event(at, k, TURN) or (site.is_event(at, k, STICK) and site.is_event(at + 1, k, SLIP)):
                found += _withdrawn_at(site, j, at)
    return found


def _withdrawn_at(site: Site, j: int, at: int) -> list[Change]:
    """Do `withdrawn` for the turn or stick `at`."""
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
        return [Change(at - 1, stop + 1, events, modes, spots, Grows.MARGIN, WordChange.CROSSINGS_VANISH)]
    if stop == at + 1 or before == after:
        return []
    if before:  # beyond the border the friction sticks before the surface is reached
        outside = site.entry(at - 2, j)
        modes = (*(site.mode(i, j, outside) for i in inner), word.mode(stop - 1))
        events, spots = (*events, word.events[at - 1]), (*spots, Spot(stop - 1, later=1.0))
        return [Change(at - 1, stop, events, modes, spots, Grows.MARGIN, WordChange.ORDER_CHANGES)]
    inside = site.entry(stop, j)
    modes = (site.mode(at - 1, j, inside), *(site.mode(i, j, inside) for i in inner))
    events, spots = (word.events[stop], *events), (Spot(at, later=-1.0), *spots)
    return [Change(at, stop + 1, events, modes, spots, Grows.MARGIN, WordChange.ORDER_CHANGES)]
