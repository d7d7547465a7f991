"""Admissibility: prove all inequalities of a real orbit on the whole of every flight, or prove that one of them is violated.

On a flight, f > 0 is proved by bisection with mean value forms. At an end where f vanishes exactly (the relative velocity
at a turn, the distance at an impact) the sign of a derivative is used instead: f(0) = 0 and f' > 0 on [0, b] prove f > 0 on (0, b].
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from orbits.proofs.balls import interval, library
from orbits.proofs.equations import Motif
from orbits.proofs.flights import WALLS, Flight, Flights, Motion
from orbits.proofs.obstacles import Obstacle, Remedy, Step

if TYPE_CHECKING:
    from flint import arb

    from orbits.proofs.elimination import Nodes

Rates = tuple["arb", "arb", "arb", Any]
"""A function and its first three derivatives with respect to time, at an instant or over an interval."""

EVALUATIONS = 6000  # most subintervals of one flight that are examined for one inequality


@dataclass(frozen=True)
class Zero:
    """The margin that vanishes exactly at a border: its name, its event (or flight), the phase inside the flight if it vanishes there, and the side."""

    name: str
    event: int
    phase: arb | None = None
    side: int = 0


NOTHING = Zero("", -1)


@dataclass(frozen=True)
class Condition:
    """An inequality f > 0 on the open interval of a flight (or, without `function`, a number `value` that must be positive).

    `pace` is the time per radian of the phase. `start` and `end` count how many of f, f', f'' vanish exactly at the start and end of the flight;
    `touch` is a phase inside the flight at which f and f' vanish exactly.
    """

    name: str
    event: int
    value: arb | None = None
    side: int = 0
    function: Callable[[arb], Rates] | None = field(default=None, repr=False)
    phases: tuple[arb, arb] | None = None
    pace: arb | int = 1
    start: int = 0
    end: int = 0
    touch: arb | None = None


@dataclass(frozen=True)
class Reality:
    """Verdict on whether an orbit is real: True (all conditions are proved), False (`broken` is proved to be violated), None (those in `open` are undecided)."""

    real: bool | None
    broken: Condition | None = None
    open: tuple[Condition, ...] = ()

    def obstacles(self) -> list[Obstacle]:
        """Return an `Obstacle` for each undecided condition."""
        if self.real is not None:
            return []
        return [Obstacle(Step.ADMISSIBILITY, Remedy.BORDER, c.event, c.name) for c in self.open]


def examine(motif: Motif, p: Mapping[str, arb], nodes: Nodes, zero: Zero = NOTHING) -> Reality:
    """Decide whether all solutions with nodes in these balls are real.

    Parameters
    ----------
    motif : Motif
    p : dict of str to arb
        Parameters.
    nodes : list (l) of lists (n) of arb
    zero : Zero
        At a border, the margin that vanishes exactly, which is not examined.
    """
    if not well_formed(motif):
        return Reality(False, Condition("word", 0))
    undecided = []
    for condition in conditions(motif, p, nodes, zero):
        holds = _decide(condition)
        if holds is False:
            return Reality(False, condition)
        if holds is None:
            undecided.append(condition)
    return Reality(None if undecided else True, None, tuple(undecided))


def well_formed(motif: Motif) -> bool:
    """Whether each event is possible between the modes before and after it."""
    if motif.frictionless:
        return all(letter in WALLS for letter in motif.events)
    for i, letter in enumerate(motif.events):
        before, after = motif.incoming(i), motif.modes[i]
        fits = {
            "L": before == 1 and after == -1,
            "R": before == -1 and after == 1,
            "t": before in (-1, 1) and after == -before,
            "s": before in (-1, 1) and after == 0,
            "u": before == 0 and after in (-1, 1),
        }
        if not fits.get(letter, False):
            return False
    return len(motif) > 0


def conditions(motif: Motif, p: Mapping[str, arb], nodes: Nodes, zero: Zero = NOTHING) -> Iterator[Condition]:
    """Yield all inequalities of a real orbit; the margin that vanishes at a border is omitted, or marked by `start`, `end` or `touch`."""
    flights = motif.flights(p)
    for i in range(len(motif)):
        following = motif.after(i, nodes, p)
        flight = flights.launch(motif.events[i], motif.modes[i], nodes[i])
        phases = (nodes[i][0], following[0])
        for condition in _at_event(motif, i, flight(nodes[i][0]), nodes[i], flights):
            if zero.event != i or not _vanishes(condition, zero):
                yield condition
        yield Condition("duration", i, phases[1] - phases[0])
        if zero.event == i and zero.phase is not None:  # the phase must lie inside this flight
            yield Condition("touch", i, zero.phase - phases[0])
            yield Condition("touch", i, phases[1] - zero.phase)
        yield from _in_flight(motif, i, flight, phases, flights, zero)


def _vanishes(condition: Condition, zero: Zero) -> bool:
    """Whether a condition at the event of a border is the vanishing margin."""
    return condition.name == zero.name and (zero.name not in ("wall", "stick") or condition.side == zero.side)


def _at_event(
    motif: Motif, i: int, motion: Motion, node: Sequence[arb], machine: Flights
) -> Iterator[Condition]:
    """Yield the inequalities at event i."""
    letter = motif.events[i]
    if letter in WALLS:
        # w'- = -w'+/r: the absorber approached the wall before if it leaves it after
        yield Condition("approach", i, -WALLS[letter] * motion.w1)
        return
    for side in (1, -1):
        yield Condition("wall", i, machine.room[side] - side * node[1], side=side)
    mode = motif.modes[i]
    if letter == "t":
        yield Condition("turn", i, mode * motion.push - machine.limit[mode])
    elif letter == "s":
        for side in (1, -1):
            yield Condition("stick", i, machine.limit[side] - side * motion.push, side=side)
    else:
        yield Condition("slip", i, mode * motion.push1)


def _in_flight(
    motif: Motif, i: int, flight: Flight, phases: tuple[arb, arb], machine: Flights, zero: Zero
) -> Iterator[Condition]:
    """Yield the inequalities inside flight i: distance to the walls, friction margin while sticking, or direction of sliding."""
    pace = 1 / machine.omega
    letter, mode = motif.events[i], motif.modes[i]
    arrival, after = motif.arrival(i)
    following = (i + 1) % len(motif)
    touching = zero.phase if zero.event == i else None
    if motif.frictionless:
        for side, wall in ((1, "L"), (-1, "R")):

            def room(phase: arb, side: int = side) -> Rates:
                m = flight(phase)
                return machine.room[side] - side * m.w, -side * m.w1, -side * m.w2, -side * m.w3

            graze = zero.name == "approach"
            start = 0 if letter != wall else 2 if graze and zero.event == i else 1
            end = 0 if arrival != wall else 2 if graze and zero.event == following else 1
            touch = touching if zero.name == "reversal" and zero.side == side else None
            yield Condition("wall", i, None, 0, room, phases, pace, start, end, touch)
    elif mode == 0:
        for side in (after, -after):

            def hold(phase: arb, side: int = side) -> Rates:
                m = flight(phase)
                return machine.limit[side] - side * m.push, -side * m.push1, -side * m.push2, None

            held = zero.name == "stick" and zero.event == i and side == zero.side
            touch = touching if zero.name == "hold" and zero.side == side else None
            yield Condition(
                "hold", i, None, 0, hold, phases, pace, 1 if held else 0, 1 if side == after else 0, touch
            )
    else:

        def slide(phase: arb) -> Rates:
            m = flight(phase)
            return mode * m.w1, mode * m.w2, mode * m.w3, None

        start = {"t": 1, "u": 2}.get(letter, 0)
        end = 1 if arrival in "ts" else 0
        if zero.event == i and zero.name in ("turn", "approach", "slip"):
            start += 1
        if zero.event == following and zero.name == "approach":
            end = 1
        yield Condition(
            "flight", i, None, 0, slide, phases, pace, start, end, touching if zero.name == "flight" else None
        )


def _decide(condition: Condition) -> bool | None:
    """Return True if the condition is proved, False if it is proved to be violated somewhere, None if neither."""
    if condition.function is None:
        value = condition.value
        assert value is not None
        return True if value > 0 else False if value < 0 else None
    return _positive(condition)


def _positive(c: Condition) -> bool | None:
    """Decide f > 0 on a flight by bisection."""
    assert c.function is not None and c.phases is not None
    arb = library().arb
    first, span = c.phases[0], c.phases[1] - c.phases[0]
    half = arb(1) / 2
    todo = [(arb(0), arb(1), 0)]
    doubtful = False
    for _ in range(EVALUATIONS):
        if not todo:
            return None if doubtful else True
        low, high, depth = todo.pop()
        middle = (low + high) * half
        at = first + span * middle
        over = first + span * interval(low, high)
        value = c.function(at)[0]
        if value < 0:
            return False
        if c.touch is not None and over.overlaps(c.touch):
            over = interval(over, c.touch)
            rates = c.function(over)
            if rates[2] is not None and rates[2] > 0:
                continue
        else:
            rates = c.function(over)
            if _holds(rates, value, at, over, c, low, high):
                continue
        if depth > 60:
            doubtful = True
            continue
        todo += [(low, middle, depth + 1), (middle, high, depth + 1)]
    return None


def _holds(rates: Rates, value: arb, at: arb, over: arb, c: Condition, low: arb, high: arb) -> bool:
    """Whether f > 0 is proved on a subinterval: by its range, by the mean value form, or beside an end by a derivative."""
    if rates[0] > 0 or value + rates[1] * (over - at) * c.pace > 0:
        return True
    if low == 0 and c.start and rates[c.start] is not None and rates[c.start] > 0:
        return True
    if high == 1 and c.end:
        rate = rates[c.end]
        return rate is not None and bool((-rate if c.end == 1 else rate) > 0)
    return False
