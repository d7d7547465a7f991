"""The equations F(u, p) = 0 of a declared machine's orbits with one word: unknowns, data, kernels in plain Python round compiled flights."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from contvines.core.library import native
from orbits.contacts.dry_friction import STUCK, DryFriction
from orbits.contacts.letters import HIT, STICK, STROBE, Letter
from orbits.flows.page import flights, sampling
from orbits.flows.page.margins import fill_margins, owned
from orbits.flows.plain_kernels import PlainKernels
from orbits.flows.protocol import PLAIN, Approach
from orbits.integrators.expressions import variables_of
from orbits.machines.page.machine import Machine
from orbits.machines.path import along
from orbits.numbers import Reals
from orbits.settings import SOLVING
from orbits.words import Word

if TYPE_CHECKING:
    from orbits.integrators.expressions import Values
    from orbits.integrators.protocol import Watch
    from orbits.machines.page.patterns import Guard

TURN_OF_PHASE = 2.0 * np.pi
STROBED = Letter("", -1, STROBE)


class PageKernels(PlainKernels["PageEquations", flights.Work]):
    """The functions that a continuation calls; plain Python round integrated flights."""

    column = 3
    accepted = SOLVING.residual
    patience = 0.5

    def linearise(self, data: PageEquations, u: np.ndarray, p: float, work: flights.Work) -> float:
        """See `orbits.flows.page.flights.linearise`."""
        return flights.linearise(data, u, p, work)

    def bordered(
        self,
        data: PageEquations,
        work: flights.Work,
        border: np.ndarray,
        target: float,
        step: np.ndarray,
        tangent: np.ndarray,
    ) -> float:
        """Of a long cycle by blocks."""
        if data.dimension > flights.CYCLIC and not data.pinned and native():
            return flights.by_blocks(data, work, border, target, step, tangent)
        return super().bordered(data, work, border, target, step, tangent)

    def fill(self, data: PageEquations, work: flights.Work, matrix: np.ndarray) -> None:
        """See `orbits.flows.page.flights.fill`."""
        flights.fill(data, work, matrix)

    def assign(self, data: PageEquations, other: PageEquations, value: float) -> None:
        """Give the parameter that varies in ``other`` a value in ``data``, in place."""
        data.params[other.index] = value
        data.base_numbers[:, other.index] = value

    def flip(self, data: PageEquations, work: flights.Work, sign: float) -> None:
        """Turn F_u to perturbations that change sign over the period (sign = -1), and back (sign = 1)."""
        work.following[-1] *= -1.0

    def transpose(
        self, data: PageEquations, work: flights.Work, column: np.ndarray, other: flights.Work
    ) -> None:
        """The transposed F_u, with another last column, into another workspace."""
        for name in ("own", "following", "drift", "still", "numbers"):
            getattr(other, name)[:] = getattr(work, name)
        other.derivative.reshape(-1)[:] = column
        other.turned[0] = 1.0

    def matrix(self, data: PageEquations, work: flights.Work) -> np.ndarray:
        """F_u as it stands in a workspace, shape (N, N)."""
        found = np.zeros((data.dimension, data.dimension))
        flights.fill(data, work, found)
        return found

    def inspect(
        self, data: PageEquations, u: np.ndarray, p: float, work: flights.Work, row: np.ndarray
    ) -> None:
        """Multipliers as (re, im) pairs, then the margins, into `row`."""
        m = data.n_multipliers
        values = flights.multipliers(data, work)
        row[0 : 2 * m : 2], row[1 : 2 * m : 2] = np.real(values), np.imag(values)
        fill_margins(data, u, work, row[2 * m :])


KERNELS = PageKernels()


def loose_states(machine: Machine, word: Word) -> tuple[int, ...]:
    """States along which any motion with this word may be shifted: no rate and no event of the word knows them (an absorber that slides between its
    walls while another one hits its own)."""
    e, names = machine.equations, machine.equations.layout.states
    known: set[str] = set()
    for i, mode in enumerate(word.modes):
        pattern = e.pattern(e.pattern_key(mode))
        known |= set().union(*(variables_of(rate) for rate in pattern.rates))
        for guard in pattern.guards:
            if guard.kind != HIT:
                known |= variables_of(guard.value)
        if len(word) and word.letter(i).kind == HIT:
            known |= e.deciding(word.letter(i).contact)
    return tuple(j for j, name in enumerate(names) if name not in known)


class PageEquations:
    """Periodic orbits with a given word, against one parameter of a declared machine.

    Parameters
    ----------
    machine : Machine
    word : Word
        Of the whole cycle.
    periods : int
        Forcing periods of the whole cycle; 1 for a self-excited machine, whose period is unknown.
    parameter : str
    params : float array (P,)
        The entry of `parameter` is the starting value only.
    symmetric : bool
        Solve for symmetric orbits, on half the word.

    Raises
    ------
    ValueError
        If the parameter is unknown, or `symmetric` is asked of a word whose halves are not mirror images.
    """

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
        if symmetric and not (word.mirror_symmetric_halves and (periods % 2 == 1 or not machine.forced)):
            raise ValueError(f"word {word.text!r} with periods = {periods} has no symmetric orbits")
        if symmetric and not machine.has_mirror(np.array(params, dtype=float), parameter):
            raise ValueError(
                f"the machine {machine.name!r} has no mirror image along {parameter}, so no symmetric orbits"
            )
        self.machine, self.word, self.periods = machine, word, int(periods)
        self.parameter, self.params = parameter, np.array(params, dtype=float)
        self.symmetric, self.forced = bool(symmetric), machine.forced
        self.mirrored = machine.has_mirror(self.params, parameter)
        self.size, self.contacts = machine.size, len(machine.contacts)
        # a forced motion without events has a node for each of its forcing periods: doubled it is one with twice as many
        whole = len(word) or (self.periods if self.forced and not symmetric else 1)
        self.length = whole // 2 if symmetric and len(word) else whole
        self.dimension = self.length * (self.size + 1)
        self.twist = -1.0 if symmetric else 1.0
        self.shift = (0.5 if symmetric else 1.0) * TURN_OF_PHASE * self.periods if self.forced else 0.0
        self.loose = loose_states(machine, word)
        self.pinned = () if symmetric else self.loose
        self.movable = self.symmetric and bool(self.loose)
        self.unit, self.units, self.path = (
            np.ones((whole, self.size + 1)),
            PLAIN,
            machine.path(parameter, self.params),
        )
        self.began = float(self.params[self.index])
        stuck = [
            j
            for j, contact in enumerate(machine.contacts)
            if isinstance(contact, DryFriction) and all(mode[j] == STUCK for mode in word.modes)
        ]
        self.trivial = len(self.loose) + len(stuck)
        self.still = () if symmetric else self._still(stuck)
        self.anywhere = self._anywhere(stuck)
        self.n_multipliers = (self.size if self.forced else self.size - 1) - self.trivial
        self.n_margins = len(word.alphabet.columns) * self.length
        self.period_shift = np.zeros(self.dimension) if self.forced else None
        if self.period_shift is not None:
            self.period_shift[:: self.size + 1] = TURN_OF_PHASE
        self.turned = np.full(self.size + 1, self.twist)
        self.turned[0] = 1.0
        self.identity = np.eye(self.size)
        self.minus = np.zeros((self.size + 1, self.size + 1))
        self.minus[1:, 1:] = -self.identity
        self.kernels, self.data = KERNELS, self
        self._assign()

    def _still(self, frictions: Sequence[int]) -> tuple[tuple[int, Values], ...]:
        """For each friction that sticks for ever: the state whose closing its velocity replaces, and the velocity compiled."""
        e, found, taken = self.machine.equations, [], set(self.loose)
        for j in frictions:
            known = variables_of(e.velocity[j])
            places = [k for k, name in enumerate(e.layout.states) if name in known and k not in taken]
            taken.add(places[-1])
            letter = Letter("", j, STICK)
            key = e.pattern_key(self.word.modes[0])
            found.append((places[-1], self.machine.compiled.event(letter, 0, key, (self.index,))))
        return tuple(found)

    def _anywhere(self, frictions: Sequence[int]) -> tuple[str, ...]:
        """Names of the frictions that stick for ever where nothing says at which place: its rate is a velocity that is zero all along."""
        e, names = self.machine.equations, self.machine.equations.layout.states
        patterns = [e.pattern(e.pattern_key(mode)) for mode in dict.fromkeys(self.word.modes)]
        found = []
        for j in frictions:
            velocity = variables_of(e.velocity[j]) & set(names)
            places = [k for k, name in enumerate(names) if k not in self.loose and name not in velocity]
            if any(all(variables_of(pattern.rates[k]) == velocity for pattern in patterns) for k in places):
                found.append(self.machine.contacts[j].name)
        return tuple(found)

    def _assign(self) -> None:
        """Flights, events and guards of the word, grouped so that equal ones are evaluated together."""
        compiled, e, word = self.machine.compiled, self.machine.equations, self.word
        modes = [word.modes[i % len(word.modes)] for i in range(self.length)]
        keys = [e.pattern_key(mode) for mode in modes]
        active = (self.index,)
        self.base_numbers = np.array([compiled.numbers(self.params, mode) for mode in modes])
        self.letters = [word.letter(i) if len(word) else STROBED for i in range(self.length + 1)]
        self.owned = [owned(word, i) for i in range(self.length + 1)]
        self.slips = [
            word.modes[i % len(word.modes)][letter.contact] if letter.contact >= 0 else 0
            for i, letter in enumerate(self.letters)
        ]
        self.flight_groups = []
        for key in dict.fromkeys(keys):
            places = np.array([i for i in range(self.length) if keys[i] == key])
            many = (
                compiled.flights(key, active)
                if compiled.engine.LANES > 1 and len(places) >= flights.TOGETHER
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
        compiled, e = self.machine.compiled, self.machine.equations
        return [
            (
                compiled.guards(key),
                e.pattern(key).guards,
                compiled.watch(key),
                [i for i in range(self.length) if self._keys[i] == key],
            )
            for key in dict.fromkeys(self._keys)
        ]

    # ------------------------------------------------------------------ numerics
    @cached_property
    def scratch(self) -> flights.Work:
        """A workspace for single calls, whose contents nobody relies on."""
        return self.workspace()

    def smooth_margin(self, j: int) -> int:
        """The margin to follow where margin `j` vanishes: itself."""
        return j

    def workspace(self) -> flights.Work:
        """Arrays for the kernels."""
        return flights.workspace(self.length, self.size, self.base_numbers.shape[1])

    def values(self, p: float | np.ndarray) -> np.ndarray:
        """The parameter vector at parameter value `p`, shape (P,); (m, P) for an array of values."""
        return along(self.path, self.params, p)

    def value(self, params: np.ndarray) -> float:
        """The value of the parameter that varies in a parameter vector."""
        return float(params[self.index])

    def allowed(self, p: float) -> bool:
        """Whether the parameter may have this value."""
        return not (self.machine.phase_rate == self.parameter and p <= 0.0)

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
        return self.machine.phase_speed(numbers)

    def approach(self, u: np.ndarray, p: float, place: int, near: float) -> Approach:
        """Of the impact at a place: the rate of its wall's gap; the wall's push changes it."""
        compiled, d = self.machine.compiled, self.size + 1
        node = u[place * d : (place + 1) * d]
        numbers = compiled.numbers(self.values(p), self.word.modes[place])
        clock = node[:1] if self.forced else np.zeros(1)
        row = compiled.approach(self.letters[place].contact)(node[None, 1:], clock, numbers[None])[0]
        return Approach(float(row[0]), np.append(0.0, row[1:d]), 0.0, np.append(0.0, row[d:]))

    def through_flights(self, u: np.ndarray, p: float) -> tuple[np.ndarray, None] | None:
        """Derivatives of each node by the one before, the mirror in the last."""
        if not np.isfinite(flights.linearise(self, u, p, self.scratch)):
            return None
        with np.errstate(all="ignore"):
            return flights.factors(self, self.scratch), None

    def to_multipliers(self, spectrum: np.ndarray) -> np.ndarray:
        """Multipliers of the full period from those of the closure map (half maps: squared)."""
        spectrum = np.asarray(spectrum, dtype=complex)
        return spectrum**2 if self.symmetric else spectrum

    # ------------------------------------------------------------------ shapes
    def expand(self, u: np.ndarray, p: float | np.ndarray | None = None) -> np.ndarray:
        """Nodes of the whole cycle, shape (..., L, n + 1)."""
        u = np.asarray(u, dtype=float)
        nodes = u.reshape(*u.shape[:-1], self.length, self.size + 1)
        if not self.symmetric or not len(self.word):
            return nodes
        return np.concatenate([nodes, self._image(nodes)], axis=-2)

    def _image(self, nodes: np.ndarray) -> np.ndarray:
        image = -nodes
        image[..., 0] = nodes[..., 0] + self.shift
        return image

    def reduce(self, nodes: np.ndarray) -> np.ndarray:
        """Unknowns, shape (N,), from the nodes of the whole cycle; of a motion without events the first node tells the others."""
        if len(nodes) < self.length:
            nodes = sampling.strobed(self.machine, self.word, self.periods, nodes[0], self.params)[:-1]
        return np.array(nodes[: self.length], dtype=float, order="C").ravel()
