"""The flights of the cycles with one word of a declared machine: what starts, flies and ends each of them, compiled, and states on the way."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from orbits.arguments import Reals
from orbits.contacts import HIT, STICK, STROBE, Letter
from orbits.contacts.dry_friction import SLIDE_BACK, SLIDE_ON, STUCK, DryFriction
from orbits.flows.equations import Equations
from orbits.flows.trajectory import TWO_PI
from orbits.integrators.expressions import variables_of
from orbits.machines.page.machine import Machine
from orbits.words import Word

if TYPE_CHECKING:
    from orbits.integrators.expressions import Values
    from orbits.integrators.protocol import Watch
    from orbits.machines.page.patterns import Guard

STROBED = Letter("", -1, STROBE)
TOGETHER = 4
"""Flights in one mode from which they are integrated side by side: a flight of two states then takes 11 to 15 us in place of 35 to 40, of four
states 11 to 17 in place of 24 to 35. With fewer, half empty vectors gain less than another integrator costs to compile."""


def owned(word: Word, place: int) -> frozenset[int]:
    """The contacts of which an event says itself what their guards are at it.

    Its own; those that an impact turns; and, where a crossing is next to an impact that may jump over it, that impact's wall: as
    the two fall together the distance vanishes with the time between them, which is watched. A crossing whose surface moves with the
    velocity of a friction watches that velocity itself, as its own strength; next to it, a turn or stick of that friction has the
    surface at a distance that vanishes with the time between them.
    """
    if not len(word):
        return frozenset()
    letter, flips = word.letter(place), word.alphabet.flips
    found = {letter.contact} | {j for (wall, j), sign in flips.items() if wall == letter.contact and sign}
    rides = word.alphabet.rides
    found |= {k for (switch, k) in rides if switch == letter.contact}
    for near in (word.letter(place - 1), word.letter(place + 1)):
        if (near.contact, letter.contact) in rides:
            found.add(near.contact)
        if flips.get((near.contact, letter.contact), 0) is None:
            found.add(near.contact)
    return frozenset(found)


def loose_states(machine: Machine, word: Word) -> tuple[int, ...]:
    """States along which any motion with this word may be shifted: no rate and no event of the word knows them (an absorber that slides between its
    walls while another one hits its own)."""
    e, names = machine.equations, machine.equations.layout.states
    known: set[str] = set()
    for i, mode in enumerate(word.contact_modes):
        pattern = e.pattern(e.pattern_key(mode))
        known |= set().union(*(variables_of(rate) for rate in pattern.rates))
        for guard in pattern.guards:
            if guard.kind != HIT:
                known |= variables_of(guard.value)
        if len(word) and word.letter(i).kind == HIT:
            known |= e.deciding(word.letter(i).contact)
    return tuple(j for j, name in enumerate(names) if name not in known)


def flown(
    machine: Machine,
    params: np.ndarray,
    modes: Sequence[Sequence[int]],
    states: np.ndarray,
    begins: np.ndarray,
    places: np.ndarray,
    ahead: np.ndarray,
) -> np.ndarray:
    """States, shape (m, n), so long (clock, shape (m,)) after the beginnings of flights `places`: flight i begins in states[i] at begins[i], in modes[i]."""
    compiled, e, out = machine.compiled, machine.equations, np.empty((len(ahead), machine.size))
    for i in np.unique(places).tolist():
        here = np.flatnonzero(places == i)
        here = here[np.argsort(ahead[here], kind="stable")]
        mode = modes[i % len(modes)]
        begin = begins[i] % TWO_PI if machine.forced else 0.0
        grid = begin + np.append(0.0, ahead[here])
        watch = compiled.watch(e.pattern_key(mode))
        out[here] = watch.path(states[i], grid, compiled.numbers(params, mode))[1:]
    return out


def strobed(
    machine: Machine, word: Word, periods: int, node: np.ndarray, params: np.ndarray, often: int = 1
) -> np.ndarray:
    """Nodes of a motion without events, so often per forcing period from one of them on to its return, shape (often periods + 1, n + 1)."""
    ahead = TWO_PI / often * np.arange(often * periods + 1)
    places = np.zeros(len(ahead), int)
    states = flown(machine, params, word.contact_modes, node[None, 1:], node[:1], places, ahead)
    return np.column_stack([node[0] + ahead, states])


class Work(NamedTuple):
    """Arrays of one linearisation: F, dF_i/dnode_i, dF_i/dnode_{i+1}, dF/dp; then states and rates at the ends of the flights."""

    residual: np.ndarray
    own: np.ndarray
    following: np.ndarray
    derivative: np.ndarray
    flown: np.ndarray
    arrival: np.ndarray
    first_rates: np.ndarray
    last_rates: np.ndarray
    end: np.ndarray
    numbers: np.ndarray
    drift: np.ndarray
    still: np.ndarray
    turned: np.ndarray  # 1 where F_u stands for its transpose


def workspace(length: int, states: int, numbers: int) -> Work:
    """Arrays for `length` nodes of `states` + 1 unknowns and one active parameter."""
    L, n, d = length, states, states + 1
    return Work(
        np.zeros((L, d)),
        np.zeros((L, d, d)),
        np.zeros((L, d, d)),
        np.zeros((L, d)),
        np.zeros((L, n + n * (n + 1))),
        np.zeros((L, n)),
        np.zeros((L, n)),
        np.zeros((L, n)),
        np.zeros(L),
        np.zeros((L, numbers)),
        np.zeros(n),
        np.zeros((n, d)),
        np.zeros(1),
    )


class Pieces(Equations[Machine]):
    """Flight by flight, in numpy; a page has no units of its own."""

    def __init__(
        self,
        machine: Machine,
        word: Word,
        periods: int,
        parameter: str,
        params: np.ndarray,
        symmetric: bool = False,
    ) -> None:
        self.index = machine.place_of(parameter)
        # a forced motion without events has a node for each of its forcing periods: doubled it is one with twice as many; for each half of them
        # where that is followed by its image
        mirrored = machine.has_mirror(np.array(params, dtype=float), parameter)
        halves = 2 if mirrored and word.mirror_symmetric_halves else 1
        whole = len(word) or (halves * int(periods) if machine.forced else 1)
        super().__init__(machine, word, periods, parameter, params, symmetric, whole)
        self.path = machine.path(parameter, self.params)
        self.size, self.contacts = machine.size, len(machine.contacts)
        self.loose = loose_states(machine, word)
        self.pinned = () if symmetric else self.loose
        self.movable = self.symmetric and bool(self.loose)
        stuck = [
            j
            for j, contact in enumerate(machine.contacts)
            if isinstance(contact, DryFriction) and all(mode[j] == STUCK for mode in word.contact_modes)
        ]
        resting = self._resting(stuck)
        self.trivial = len(self.loose) + len(stuck) + len(resting)
        self.still = () if symmetric else self._still(stuck)
        self.resting = () if symmetric else resting
        self.comes_back = not any(map(self._slips_one_way, range(self.contacts)))
        self.n_multipliers = (self.size if self.forced else self.size - 1) - self.trivial
        self.turned = np.full(self.size + 1, self.twist)
        self.turned[0] = 1.0
        self.identity = np.eye(self.size)
        self.minus = np.zeros((self.size + 1, self.size + 1))
        self.minus[1:, 1:] = -self.identity
        self._assign()

    def _still(self, frictions: Sequence[int]) -> tuple[tuple[int, Values], ...]:
        """For each friction that sticks for ever: the state whose closing its velocity replaces, and the velocity compiled."""
        e, found, taken = self.model.equations, [], set(self.loose)
        for j in frictions:
            known = variables_of(e.velocity[j])
            places = [k for k, name in enumerate(e.layout.states) if name in known and k not in taken]
            taken.add(places[-1])
            letter = Letter("", j, STICK)
            key = e.pattern_key(self.word.entries(0))
            found.append((places[-1], self.model.compiled.event(letter, 0, key, (self.index,))))
        return tuple(found)

    def _resting(self, frictions: Sequence[int]) -> tuple[int, ...]:
        """The places of what sticks for ever: states whose rate is a velocity that is zero all along. Their closing says nothing, and is
        replaced by that they stay where they are."""
        e, names = self.model.equations, self.model.equations.layout.states
        patterns = [e.pattern(e.pattern_key(mode)) for mode in dict.fromkeys(self.word.contact_modes)]
        velocities = [variables_of(e.velocity[j]) & set(names) for j in frictions]
        return tuple(
            k
            for k, name in enumerate(names)
            if k not in self.loose
            and any(
                name not in velocity
                and all(variables_of(pattern.rates[k]) == velocity for pattern in patterns)
                for velocity in velocities
            )
        )

    def _slips_one_way(self, j: int) -> bool:
        """Whether a friction slips, and always to the same side, though its velocity is the rate of a state, which then does not come back."""
        e = self.model.equations
        modes = {mode[j] for mode in self.word.contact_modes} - {STUCK}
        if j not in e.velocity or modes not in ({SLIDE_BACK}, {SLIDE_ON}):
            return False
        velocity = e.velocity[j]
        patterns = [e.pattern(e.pattern_key(mode)) for mode in dict.fromkeys(self.word.contact_modes)]
        return velocity.operation == "variable" and any(
            all((rate.operation, rate.operands) == ("variable", velocity.operands) for rate in rates)
            for rates in zip(*(pattern.rates for pattern in patterns))
        )

    def _assign(self) -> None:
        """Flights, events and guards of the word, grouped so that equal ones are evaluated together."""
        compiled, e, word = self.model.compiled, self.model.equations, self.word
        modes = [word.entries(i) for i in range(self.length)]
        keys = [e.pattern_key(mode) for mode in modes]
        active = (self.index,)
        self.base_numbers = np.array([compiled.numbers(self.params, mode) for mode in modes])
        self.letters = [word.letter(i) if len(word) else STROBED for i in range(self.length + 1)]
        self.owned = [owned(word, i) for i in range(self.length + 1)]
        self.slips = [
            word.entries(i)[letter.contact] if letter.contact >= 0 else 0
            for i, letter in enumerate(self.letters)
        ]
        self.flight_groups = []
        for key in dict.fromkeys(keys):
            places = np.array([i for i in range(self.length) if keys[i] == key])
            many = (
                compiled.flights(key, active)
                if compiled.engine.LANES > 1 and len(places) >= TOGETHER
                else None
            )
            self.flight_groups.append((compiled.flight(key, active), many, places))
        self.rate_groups = [
            (compiled.rates(key), np.array([i for i in range(self.length) if keys[i] == key]))
            for key in dict.fromkeys(keys)
        ]
        events: dict[int, tuple[Values | None, list[int], bool]] = {}
        for i in range(self.length):
            letter = self.letters[i + 1]
            if letter.kind == STROBE and not self.forced:
                values = compiled.extreme(keys[i], active)
                events[id(values)] = (values, [i], False)
                continue
            if letter.kind == STROBE:
                events[-1] = (None, [i], False)
                continue
            values = compiled.event(letter, self.slips[i + 1], keys[i], active)
            events.setdefault(id(values), (values, [], values.count > self.size + 3))[1].append(i)
        self.event_groups = [(values, np.array(places), jumps) for values, places, jumps in events.values()]
        self._keys = keys

    @cached_property
    def guard_groups(self) -> list[tuple[Values, list[Guard], Watch, list[int]]]:
        """(guards compiled, guards, watch, flights) per pattern."""
        compiled, e = self.model.compiled, self.model.equations
        return [
            (
                compiled.guards(key),
                e.pattern(key).guards,
                compiled.watch(key),
                [i for i in range(self.length) if self._keys[i] == key],
            )
            for key in dict.fromkeys(self._keys)
        ]

    def allowed(self, p: float) -> bool:
        """Whether there may be such motions at a value of the parameter."""
        return self.comes_back and not (self.model.phase_rate == self.parameter and p <= 0.0)

    def clocks(self, nodes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Clock at the beginning and the end of every flight, from the nodes (L, n + 1)."""
        if not self.forced:
            return np.zeros(self.length), nodes[:, 0].copy()
        begin = nodes[:, 0].copy()
        end = np.empty_like(begin)
        end[:-1] = begin[1:]
        end[-1] = begin[0] + self.shift
        return begin, end

    def clock_rate(self, numbers: np.ndarray) -> Reals:
        """Clock per unit of time, from runtime numbers (L, ...)."""
        return self.model.phase_speed(numbers)

    def workspace(self) -> Work:
        """Arrays for the kernels."""
        return workspace(self.length, self.size, self.base_numbers.shape[1])
