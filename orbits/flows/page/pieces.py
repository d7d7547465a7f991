"""The parts of the cycles with one word of a declared machine: compiled starts, flights and events, and states between them."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from orbits.arguments import Reals
from orbits.contacts import HIT, STICK, STROBE, SWITCH, Letter
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
"""Smallest number of flights in one mode that are integrated together in vectors: a flight of two states then takes 11 to 15 us in place
of 35 to 40, of four states 11 to 17 in place of 24 to 35. With fewer flights the gain is less than the compilation of another integrator."""


def owned(word: Word, place: int) -> frozenset[int]:
    """Return the contacts whose guards are known to vanish or change at an event, so that their values there are no margins.

    These are:

    - the event's own contact;
    - contacts whose sign the impact sets;
    - at a crossing of a switch next to an impact: that impact's wall, unless the impact sets the switch's sign; and at an impact next to a
      crossing over which it does not jump: the switch. As crossing and impact coincide, these distances vanish with the time between
      them, which has a margin of its own;
    - at an event of a switch whose surface moves with a friction's velocity: that friction, because the velocity is the strength of the
      crossing; and at a turn or stick of the friction next to the crossing: the switch, whose distance vanishes with the time between them.
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
        hit, crossing = (near, letter) if near.kind == HIT else (letter, near)
        if (hit.kind, crossing.kind) == (HIT, SWITCH):
            pair = hit.contact, crossing.contact
            if pair not in flips or (near is hit and flips[pair] is None):
                found.add(near.contact)
    return frozenset(found)


def loose_states(machine: Machine, word: Word) -> tuple[int, ...]:
    """Return the states along which every motion with this word can be shifted: no rate and no event of the word depends on them.

    An example is an absorber that slides between its walls while another one hits its own.
    """
    e, names = machine.equations, machine.equations.layout.states
    used: set[str] = set()
    for i, mode in enumerate(word.contact_modes):
        pattern = e.pattern(e.pattern_key(mode))
        used |= set().union(*(variables_of(rate) for rate in pattern.rates))
        for guard in pattern.guards:
            if guard.kind != HIT:
                used |= variables_of(guard.value)
        if len(word) and word.letter(i).kind == HIT:
            used |= e.deciding(word.letter(i).contact)
    return tuple(j for j, name in enumerate(names) if name not in used)


def flown(
    machine: Machine,
    params: np.ndarray,
    modes: Sequence[Sequence[int]],
    states: np.ndarray,
    begins: np.ndarray,
    places: np.ndarray,
    ahead: np.ndarray,
) -> np.ndarray:
    """Return states, shape (m, n), at clocks `ahead` (m,) after the beginnings of the flights `places` (m,).

    Flight i begins in states[i] at the clock begins[i], in modes[i].
    """
    compiled, e, out = machine.compiled, machine.equations, np.empty((len(ahead), machine.size))
    for i in np.unique(places).tolist():
        chosen = np.flatnonzero(places == i)
        chosen = chosen[np.argsort(ahead[chosen], kind="stable")]
        mode = modes[i % len(modes)]
        begin = begins[i] % TWO_PI if machine.forced else 0.0
        grid = begin + np.append(0.0, ahead[chosen])
        watch = compiled.watch(e.pattern_key(mode))
        out[chosen] = watch.path(states[i], grid, compiled.numbers(params, mode))[1:]
    return out


def strobed(
    machine: Machine, word: Word, periods: int, node: np.ndarray, params: np.ndarray, often: int = 1
) -> np.ndarray:
    """Return nodes of a motion without events, `often` per forcing period from `node` to its return, shape (often periods + 1, n + 1)."""
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
    turned: np.ndarray  # 1 if the blocks stand for the transposed F_u


def workspace(length: int, states: int, numbers: int) -> Work:
    """Return arrays for `length` nodes of `states` + 1 unknowns and one active parameter."""
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
    """Parts of the equations of one word's cycles, flight by flight, in numpy; unknowns are in the machine's own units."""

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
        # a forced motion without events has a node for each of its forcing periods, so that a doubled motion has twice as many; if each half
        # period may be followed by its mirror image, a node for each half period
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
        self.still = () if symmetric else self._stuck_closures(stuck)
        self.resting = () if symmetric else resting
        self.comes_back = not any(map(self._slips_one_way, range(self.contacts)))
        self.n_multipliers = (self.size if self.forced else self.size - 1) - self.trivial
        self.turned = np.full(self.size + 1, self.twist)
        self.turned[0] = 1.0
        self.identity = np.eye(self.size)
        self.minus = np.zeros((self.size + 1, self.size + 1))
        self.minus[1:, 1:] = -self.identity
        self._assign()

    def _stuck_closures(self, frictions: Sequence[int]) -> tuple[tuple[int, Values], ...]:
        """Return, for each friction that sticks for ever, the state whose closure its velocity replaces, and the compiled velocity."""
        e, found, taken = self.model.equations, [], set(self.loose)
        for j in frictions:
            used = variables_of(e.velocity[j])
            places = [k for k, name in enumerate(e.layout.states) if name in used and k not in taken]
            taken.add(places[-1])
            letter = Letter("", j, STICK)
            key = e.pattern_key(self.word.entries(0))
            found.append((places[-1], self.model.compiled.event(letter, 0, key, (self.index,))))
        return tuple(found)

    def _resting(self, frictions: Sequence[int]) -> tuple[int, ...]:
        """Return the positions that rest for ever: states whose rate is a velocity that is zero all the time.

        Their closure is always fulfilled; it is replaced by the condition that they keep their values.
        """
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
        """Return whether a friction only slips, always in one direction, while its velocity is the rate of a state, which cannot return."""
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
        """Compile flights, events and guards of the word, in groups that are evaluated together."""
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
        """(compiled guards, guards, watch, flights) for each pattern."""
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
        """Return whether motions with this word are possible at a value of the parameter."""
        return self.comes_back and not (self.model.phase_rate == self.parameter and p <= 0.0)

    def clocks(self, nodes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the clocks at the beginning and the end of every flight, from the nodes (L, n + 1)."""
        if not self.forced:
            return np.zeros(self.length), nodes[:, 0].copy()
        begin = nodes[:, 0].copy()
        end = np.empty_like(begin)
        end[:-1] = begin[1:]
        end[-1] = begin[0] + self.shift
        return begin, end

    def clock_rate(self, numbers: np.ndarray) -> Reals:
        """Return the clock per unit of time, from runtime numbers (L, ...)."""
        return self.model.phase_speed(numbers)

    def workspace(self) -> Work:
        """Return new arrays for the kernels."""
        return workspace(self.length, self.size, self.base_numbers.shape[1])
