"""Dry friction (Coulomb's law): its letters, modes and changes of words, and the class `DryFriction` for machine files."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from contvines.shared.near_names import hinted
from orbits.contacts import HIT, SLIP, STICK, TURN, Change, Grows, Letter, Site, Spot, WordChange
from orbits.settings import GROWING

SLIDE_BACK, STUCK, SLIDE_ON, ABSENT = -1, 0, 1, 2  # modes; ABSENT: the limit is zero


class Event(NamedTuple):
    """An event that affects a friction: its own, or an impact that changes its velocity.

    `sign` is the sign of the velocity after the event, if the event determines it; before an impact with a sign the velocity has the opposite one.
    """

    kind: int
    sign: int | None = None


class CannotFollow(ValueError):
    """Among the events that affect a friction, event `event` is impossible after the mode `before`."""

    def __init__(self, event: int, before: int | None) -> None:
        super().__init__(event, before)
        self.event, self.before = event, before


class FrictionLaw:
    """Dry friction in words: letters (turn, stick, slip), modes (direction of sliding), margins, and changes of the word at borders."""

    name: str
    letters: Sequence[str]
    reversal = TURN
    """Kind of the event at which the velocity changes its sign without an impact."""

    def __init__(self, name: str, letters: Sequence[str] = ("t", "s", "u")) -> None:
        self.name, self.letters = name, tuple(letters)

    @property
    def described(self) -> str:
        """Kind of contact and its name, for messages."""
        return f"friction {self.name!r}"

    def events(self, j: int) -> list[Letter]:
        """Return the letters, for the contact with index j."""
        return [Letter(text, j, kind) for text, kind in zip(self.letters, (TURN, STICK, SLIP))]

    def mirrored(self, mode: int, turned: bool) -> int:
        """Return the entry of the mirror image, in which all velocities change their signs."""
        return -mode if mode in (SLIDE_BACK, SLIDE_ON) else mode

    def watched(self, mode: int) -> str:
        """Return the name of its margin inside a flight: time or reserve of a stick, else the relative speed."""
        return "hold" if mode == STUCK else "flight"

    def together(self, first: int, second: int) -> str:
        """Return the kind of border at which two consecutive events of this friction, of these kinds, coincide."""
        return "velocity-graze" if first == second == TURN else "stick"

    # ------------------------------------------------------------------ modes of a word
    def directions(self, beats: Sequence[Event], noted: Mapping[int, int] | None = None) -> list[int]:
        """Return the mode after each event that affects this friction, in a cyclic word; linear time.

        Where the events do not determine the direction, a slip reverses the motion that its stick ended, and a word of turns alone
        begins with `SLIDE_ON`.

        Parameters
        ----------
        beats : sequence of Event
        noted : mapping, optional
            Event -> mode after it, for events with a written mode.

        Raises
        ------
        CannotFollow
            If an event is impossible after the one before it.
        """
        n = len(beats)
        after: list[int | None] = [STUCK if b.kind == STICK else b.sign for b in beats]
        for i, mode in (noted or {}).items():
            after[i] = mode if after[i] is None else after[i]
        for i, b in enumerate(beats):
            own, before = after[i], after[i - 1]
            if b.kind == TURN and own is None and before is not None:
                after[i] = -before
            elif b.kind == SLIP and before is None:
                after[i - 1] = STUCK
            elif before is None and own is not None and (b.kind == TURN or (b.kind == HIT and b.sign)):
                after[i - 1] = -own
        _settle(beats, after, [i for i in range(n) if after[i] is not None])
        for i, b in enumerate(beats):
            if b.kind == SLIP and after[i] is None:
                after[i] = SLIDE_ON
                _settle(beats, after, [i])
        if all(mode is None for mode in after):  # turns alone
            after = [-SLIDE_ON if i % 2 else SLIDE_ON for i in range(n)]
        for i, mode in enumerate(after):  # an impact without a sign keeps the direction
            if mode is None:
                after[i] = SLIDE_ON if after[i - 1] is None else after[i - 1]
                _settle(beats, after, [i])
        self._refuse(beats, after)
        return [int(mode) for mode in after]  # type: ignore[arg-type]

    @staticmethod
    def _refuse(beats: Sequence[Event], after: Sequence[int | None]) -> None:
        """Raise `CannotFollow` for the first impossible event."""
        for i in [*range(1, len(beats)), 0][: len(beats)]:
            b, before, mode = beats[i], after[i - 1], after[i]
            sliding = before in (SLIDE_BACK, SLIDE_ON)
            possible = {
                TURN: sliding and mode == -(before or 0),
                STICK: sliding,
                SLIP: before == STUCK and mode in (SLIDE_BACK, SLIDE_ON),
                HIT: b.sign is None or (mode == b.sign and before == -b.sign),
            }
            if not possible[b.kind]:
                raise CannotFollow(i, before)

    # ------------------------------------------------------------------ how the word changes
    def met(self, site: Site, j: int) -> list[Change]:
        """Return the changes if the velocity vanishes inside a flight, or the reserve of friction inside a stick."""
        word, place = site.word, site.place
        start = place + 1 if len(word) else 0
        mode, text_of = word.mode(place), word.alphabet.text_of
        if site.entry(place, j) == STUCK:
            events = (text_of(j, SLIP), text_of(j, STICK))
            modes = (word.alphabet.with_entry(mode, j, site.sign), mode)
            change = WordChange.SLIP_APPEARS
        else:
            following = (place + 1) % site.unit if len(word) else -1
            if (
                site.is_event(following, j, STICK)
                and following + 1 < len(word)
                and site.lengths[following] < GROWING.short
            ):
                return self._stick(site, following, j)  # the velocity vanishes next to a very short stick
            events = (text_of(j, STICK), text_of(j, SLIP))
            modes = (word.alphabet.with_entry(mode, j, STUCK), mode)
            change = WordChange.STICK_APPEARS
        return [Change(start, start, events, modes, (Spot(None, later=-1.0), Spot(None)), Grows.GAP, change)]

    def weakened(self, site: Site, j: int) -> list[Change]:
        """Return the changes if the margin (strength) of one of its events vanishes."""
        letter, place = site.word.letter(site.place), site.place
        if letter.kind == TURN:
            return self._turn(site, place, j)
        if letter.kind == STICK and place + 1 < len(site.word):
            return self._stick(site, place, j)
        vanishing = site.is_event(place - 1, j, STICK) and site.lengths[place - 1] < GROWING.short
        return self._stick(site, place - 1, j) if letter.kind == SLIP and vanishing else []

    def collapsed(self, site: Site, j: int) -> list[Change]:
        """Return the changes if two consecutive events of this friction coincide."""
        place = site.place
        first, second = site.word.letter(place).kind, site.word.letter(place + 1).kind
        if first == STICK:
            return self._stick(site, place, j)
        if first == TURN and second == STICK:
            return self._turn(site, place, j)
        if {first, second} in ({TURN}, {SLIP, STICK}):
            change = WordChange.TURNS_VANISH if first == TURN else WordChange.SLIP_VANISHES
            return [Change(place, place + 2, (), (), (), Grows.MARGIN, change)]
        return []

    def _turn(self, site: Site, place: int, j: int) -> list[Change]:
        """Return the changes if the force no longer exceeds friction at a turn."""
        word, found = site.word, []
        text_of = word.alphabet.text_of
        if site.is_event(place + 1, j, STICK):
            events, modes = (text_of(j, STICK),), (word.mode(place + 1),)
            spots = (Spot(place + 1),)
            found.append(
                Change(place, place + 2, events, modes, spots, Grows.MARGIN, WordChange.TURN_DISAPPEARS)
            )
        events = (text_of(j, STICK), text_of(j, SLIP))
        modes = (site.mode(place, j, STUCK), word.mode(place))
        spots = (Spot(place), Spot(place, later=1.0))
        found.append(Change(place, place + 1, events, modes, spots, Grows.GAP, WordChange.TURN_BECOMES_STICK))
        return found

    def _stick(self, site: Site, place: int, j: int) -> list[Change]:
        """Return the changes of a stick that vanishes, or that has a turn before it beyond the border."""
        word, text_of = site.word, site.word.alphabet.text_of
        stick, turn = word.events[place], text_of(j, TURN)
        before, gap = site.entry(place - 1, j), site.lengths[place - 1]
        if site.is_event(place - 1, j, TURN) and gap < GROWING.short:
            held, spots = (word.mode(place),), (Spot(place),)
            return [
                Change(place - 1, place + 1, (stick,), held, spots, Grows.MARGIN, WordChange.TURN_DISAPPEARS)
            ]
        if site.is_event(place - 1, j, SLIP) and gap < GROWING.close:
            other = Change(place - 1, place + 1, (), (), (), Grows.MARGIN, WordChange.SLIP_VANISHES)
        else:
            modes = (site.mode(place - 1, j, -before), word.mode(place))
            spots = (Spot(place), Spot(place, later=1.0))
            other = Change(place, place + 1, (turn, stick), modes, spots, Grows.GAP, WordChange.TURN_APPEARS)
        if not site.is_event(place + 1, j, SLIP) or site.lengths[place] >= GROWING.short:
            return [other]  # the stick has a duration: the reserve of friction at its beginning vanishes
        if site.entry(place + 1, j) == before:
            vanished = Change(place, place + 2, (), (), (), Grows.MARGIN, WordChange.STICK_DISAPPEARS)
        else:
            modes, spots = (word.mode(place + 1),), (Spot(place, between=True),)
            vanished = Change(
                place, place + 2, (turn,), modes, spots, Grows.MARGIN, WordChange.STICK_BECOMES_TURN
            )
        return [vanished, other]


def _settle(beats: Sequence[Event], after: list[int | None], settled: list[int]) -> None:
    """Extend known modes over turns; then let each slip without a direction reverse the motion that its stick ended."""
    n, slips = len(beats), []
    while settled or slips:
        if not settled:
            slip = slips.pop()
            before = after[slip - 2]
            if after[slip] is None and before is not None:
                after[slip] = -before
                settled = [slip]
            continue
        i = settled.pop()
        mode, following = after[i], (i + 1) % n
        assert mode is not None
        for neighbour, joined in ((following, following), (i - 1, i)):
            if beats[joined].kind == TURN and after[neighbour] is None:
                after[neighbour] = -mode
                settled.append(neighbour % n)
        slip = (i + 2) % n
        if mode and beats[following].kind == STICK and beats[slip].kind == SLIP:
            slips.append(slip)


@hinted
@dataclass(frozen=True, eq=False)
class DryFriction(FrictionLaw):
    """Dry friction between two bodies, or between a body and the ground.

    While they slide, the force is ``-limit sign(velocity)``; while they stick, it is the force that keeps the velocity at zero,
    as long as this does not exceed the limit. The function `motion` of a machine file reads the force as ``contact.<name>``.

    Parameters
    ----------
    name : str
    velocity : callable
        ``(state, phase, p)`` -> relative velocity.
    limit : str, float or callable
        Largest force: the name of a parameter, a number, or a function of ``(state, phase, p)`` (the normal force may vary,
        and so may the coefficient with the velocity).
    letters : sequence of three str
        Letters of a turn (the velocity changes its sign without sticking), a stick and a slip.
    """

    name: str
    velocity: Callable
    limit: float | str | Callable
    letters: Sequence[str] = ("t", "s", "u")
