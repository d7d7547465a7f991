"""Walls with Newton's impact law: their letters, modes and changes of words, and the class `Wall` for machine files."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from contvines.shared.near_names import hinted
from orbits.contacts import HIT, STICK, SWITCH, TURN, Change, Grows, Letter, Site, Spot, WordChange

FREE, HELD = 0, 1  # modes


class WallLaw:
    """A wall in words: one letter, two modes, margins, and changes of the word at borders."""

    letter: str

    def __init__(self, letter: str) -> None:
        self.letter = letter

    @property
    def name(self) -> str:
        """The wall's letter."""
        return self.letter

    @property
    def letters(self) -> tuple[str, ...]:
        """The letter of its impacts."""
        return (self.letter,)

    @property
    def described(self) -> str:
        """Kind of contact and its name, for messages."""
        return f"wall {self.letter!r}"

    def events(self, j: int) -> list[Letter]:
        """Return the letters, for the contact with index j."""
        return [Letter(self.letter, j, HIT)]

    def mirrored(self, mode: int, turned: bool) -> int:
        """Return the entry of the mirror image."""
        return mode

    def watched(self, mode: int) -> str:
        """Return the name of its margin inside a flight: the distance, or the push of a wall that holds."""
        return "push" if mode == HELD else "wall"

    def together(self, first: int, second: int) -> str:
        """Return the kind of border at which two consecutive impacts on this wall coincide."""
        return "vanishing-event"

    # ------------------------------------------------------------------ how the word changes
    def met(self, site: Site, j: int) -> list[Change]:
        """Return the changes if the gap vanishes without an impact: inside a flight, or at a turn or stick."""
        if site.at >= 0:
            return self._met_at_event(site, j)
        word, start = site.word, site.place + 1 if len(site.word) else 0
        text, mode = word.alphabet.text_of(j, HIT), word.alphabet.after_impact(word.mode(site.place), j)
        return [Change(start, start, (text,), (mode,), (Spot(None),), Grows.SPEED, WordChange.IMPACT_APPEARS)]

    def _met_at_event(self, site: Site, j: int) -> list[Change]:
        word, place = site.word, site.at
        letter = word.letter(place)
        sign = word.alphabet.flips.get((j, letter.contact))
        if sign is None or site.entry(place - 1, letter.contact) != -sign:
            return []
        text = word.alphabet.text_of(j, HIT)
        after = site.mode(place - 1, letter.contact, sign)
        if letter.kind in (TURN, SWITCH):
            spots = (Spot(place),)
            return [Change(place, place + 1, (text,), (after,), spots, Grows.SPEED, WordChange.TURN_HITS)]
        events, modes = (text, letter.text), (after, word.mode(place))
        spots = (Spot(place), Spot(place, later=1.0))
        return [Change(place, place + 1, events, modes, spots, Grows.SPEED, WordChange.STICK_HITS)]

    def weakened(self, site: Site, j: int) -> list[Change]:
        """Return the changes if the speed of an impact vanishes.

        The impact disappears; if it changed the sign of a friction's velocity (or of a switch), it becomes a turn (or a crossing).
        """
        word, place = site.word, site.place
        turned = [
            k
            for (wall, k) in word.alphabet.flips
            if wall == j and site.entry(place, k) != site.entry(place - 1, k)
        ]
        turned = [k for k in turned if not word.alphabet.absent(word.mode(place), k)]
        if not turned:
            return [Change(place, place + 1, (), (), (), Grows.MARGIN, WordChange.IMPACT_VANISHES)]
        if len(turned) > 1:
            return []
        k, found = turned[0], []
        if site.is_event(place + 1, k, STICK):
            stick, modes = word.events[place + 1], (word.mode(place + 1),)
            spots = (Spot(place, clock=place + 1),)
            found.append(
                Change(place, place + 2, (stick,), modes, spots, Grows.MARGIN, WordChange.IMPACT_MERGES)
            )
        reversal = word.alphabet.contacts[k].reversal
        turn, modes = word.alphabet.text_of(k, reversal, site.entry(place, k)), (word.mode(place),)
        found.append(
            Change(
                place, place + 1, (turn,), modes, (Spot(place),), Grows.MARGIN, WordChange.IMPACT_BECOMES_TURN
            )
        )
        return found

    def collapsed(self, site: Site, j: int) -> list[Change]:
        """Return no changes if two consecutive impacts coincide, since then infinitely many do."""
        return []


@hinted
@dataclass(frozen=True, eq=False)
class Wall(WallLaw):
    """A unilateral contact with Newton's impact law.

    The gap stays at or above zero. At an impact an impulse acts along `push`; its size is such that the rate of the gap after it
    is -restitution times the rate before. After an accumulation of infinitely many impacts, or an impact without rebound, the wall
    holds the bodies together as long as its force pushes.

    Parameters
    ----------
    letter : str
        Letter of its impacts, for example "R".
    gap : callable
        ``(state, phase, p)`` -> the distance, 0 at contact.
    push : mapping
        Name of a state -> its change by a unit impulse: a number, the name of a parameter, or a function of
        ``(state, phase, p)``. Only velocities may change: an impulse does not change the gap itself.
    restitution : str or float
        Coefficient of restitution, or the name of a parameter; above 0 and at most 1.
    """

    letter: str
    gap: Callable
    push: Mapping[str, float | str | Callable]
    restitution: float | str = 1.0
