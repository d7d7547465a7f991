"""Switches: laws that change at a surface, without a jump of the state. In words, and on a machine's page."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from orbits.contacts.changes import CLOSE, Change, Grows, Site, Spot, What
from orbits.contacts.letters import SWITCH, Letter


class NotAlternating(ValueError):
    """The crossings of a switch in a word do not alternate."""


class SwitchLaw:
    """What a switch means for words: a letter for each crossing, its sign as mode, and how crossings come and go."""

    name: str

    def __init__(self, name: str) -> None:
        self.name = name

    @property
    def letters(self) -> tuple[str, str]:
        """What a word calls the two crossings."""
        return (f"{self.name}+", f"{self.name}-")

    def events(self, j: int) -> list[Letter]:
        """The letters, for the contact with index j."""
        plus, minus = self.letters
        return [Letter(plus, j, SWITCH, 1), Letter(minus, j, SWITCH, -1)]

    def mirrored(self, mode: int, turned: bool) -> int:
        """The mode of the mirror image."""
        return -mode if turned else mode

    def watched(self, mode: int) -> str:
        """The margin that watches it between events."""
        return "switch"

    def together(self, here: int, there: int) -> str:
        """The kind of border at which two consecutive crossings fall together."""
        return "switch-graze"

    def signs(self, letters: Sequence[Letter], j: int, noted: Mapping[int, int], default: int) -> list[int]:
        """The sign after each event of a word.

        Parameters
        ----------
        letters : sequence of Letter
            Of the whole word.
        j : int
            Index of this contact.
        noted : mapping
            Event -> the sign after it, where the word says so.
        default : int
            Where no event of the word fixes it.

        Raises
        ------
        NotAlternating
        """
        n = len(letters)
        own = [i for i in range(n) if letters[i].contact == j]
        if not own:
            return [next(iter(noted.values()), default)] * n
        if len(own) == 1 or any(letters[i].sign == letters[own[a - 1]].sign for a, i in enumerate(own)):
            raise NotAlternating
        column = [0] * n
        sign = letters[own[-1]].sign
        for i in range(n):
            sign = letters[i].sign if letters[i].contact == j else sign
            column[i] = sign
        return column

    # ------------------------------------------------------------------ how the word changes
    def met(self, site: Site, j: int) -> list[Change]:
        """A flight touches the surface: two crossings are born."""
        word = site.word
        if len(word) and site.lengths[site.place] < CLOSE:
            return self.weakened(site, j)
        mode, start = word.mode(site.place), site.place + 1 if len(word) else 0
        here, text_of = site.entry(site.place, j), word.alphabet.text_of
        events = (text_of(j, SWITCH, -here), text_of(j, SWITCH, here))
        modes = (word.alphabet.with_entry(mode, j, -here), mode)
        spots = (Spot(None, later=-0.5), Spot(None, later=0.5))
        return [Change(start, start, events, modes, spots, Grows.GAP, What.CROSSINGS_APPEAR)]

    def weakened(self, site: Site, j: int) -> list[Change]:
        """Two crossings that meet disappear."""
        word, found = site.word, []
        for first in (site.place, site.place - 1):
            if first < 0 or first + 1 >= len(word):
                continue
            if word.letter(first).contact == word.letter(first + 1).contact and site.lengths[first] < CLOSE:
                found.append(Change(first, first + 2, (), (), (), Grows.MARGIN, What.CROSSINGS_VANISH))
        return found

    def collapsed(self, site: Site, j: int) -> list[Change]:
        """Two consecutive crossings fall together."""
        return self.weakened(site, j)


@dataclass(frozen=True, eq=False)
class Switch(SwitchLaw):
    """A surface at which the equations of motion change: stops with springs, backlash, clutches.

    `motion` finds the sign of the surface, +1 or -1, in ``contact.<name>``.

    Parameters
    ----------
    name : str
        Its letters in words are ``name+`` and ``name-``: the sign after the event.
    surface : callable
        ``(state, phase, p)`` -> a number that is zero on the surface.
    """

    name: str
    surface: Callable
