"""Measures of the orbits of a declared machine, for arrays of solutions."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from orbits.contacts import HIT, Letter
from orbits.flows.page.pieces import flown
from orbits.machines.measures import loads, way_out
from orbits.machines.page.machine import Machine
from orbits.machines.page.si import CONTACT, OF_A_STATE
from orbits.settings import EVENTS, SOLVING
from orbits.words import Word


def names(model: Machine) -> tuple[str, ...]:
    """Return the names of all measures of a machine.

    - Of every state x: ``max_x``, ``min_x`` and ``max_abs_x`` over the period, ``first_x`` after the first event, ``strobe_x`` at phase zero.
    - ``phase`` of the first event, ``period``, ``rate`` (2 pi / period), ``approach_speed`` of the fastest impact.
    - Forces and energies at the contacts (`orbits.machines.page.patterns`); the energies are per period of the orbit.
    """
    kinds = OF_A_STATE if model.forced else OF_A_STATE[:-1]
    of_states = [f"{kind}_{state}" for state in model.states for kind in kinds]
    return (
        *of_states,
        *(["phase"] if model.forced else []),
        "period",
        "rate",
        *(["approach_speed"] if model.alphabet.walled else []),
        *model.load_names,
    )


def measure(
    model: Machine, word: Word, periods: int, nodes: np.ndarray, params: np.ndarray, wanted: Sequence[str]
) -> dict[str, np.ndarray]:
    """Return measures by name, each of shape (m,), of solutions with nodes (m, L, n + 1) and parameters (m, P).

    Raises
    ------
    KeyError
        If a name is unknown.
    """
    available = names(model)
    for name in wanted:
        if name not in available:
            raise KeyError(f"there is no measure {name!r}{way_out(name)}; choose from {', '.join(available)}")
    solutions = Solutions(model, word, periods, nodes, params)
    states = {f"{kind}_{state}": (kind, i) for i, state in enumerate(model.states) for kind in OF_A_STATE}
    result: dict[str, np.ndarray] = {}
    if not _LOADS.isdisjoint(name.partition("_")[0] for name in wanted):
        result |= solutions.loads({"friction_loss", "work_rate"}.intersection(wanted) != set())
    for name in wanted:
        kind, place = states.get(name, ("", 0))
        if name in result:
            continue
        if name == "phase":
            result[name] = np.mod(nodes[:, 0, 0], 2.0 * np.pi)
        elif name == "period":
            result[name] = solutions.period
        elif name == "rate":
            result[name] = 2.0 * np.pi / solutions.period
        elif name == "approach_speed":
            speeds = [impacts.speeds for impacts in solutions.impacts]
            result[name] = np.max([np.zeros(len(nodes)), *speeds], axis=0)
        elif kind == "first":
            result[name] = nodes[:, 0, 1 + place].copy()
        elif kind == "strobe":
            result[name] = solutions.strobed[:, place]
        else:
            high, low = (side[:, place] for side in solutions.extremes)
            result[name] = {"max": high, "min": low, "max_abs": np.maximum(high, -low)}[kind]
    return {name: result[name] for name in wanted}


_LOADS = frozenset(
    ("impact", "impulse", "friction", "mean", "work", "peak")
)  # first parts of the names of loads


@dataclass(frozen=True, eq=False)
class Solutions:
    """Solutions with one word, and intermediate results that several measures need."""

    machine: Machine
    word: Word
    periods: int
    nodes: np.ndarray
    params: np.ndarray

    @cached_property
    def period(self) -> np.ndarray:
        """Periods in the machine's time, shape (m,)."""
        if not self.machine.forced:
            return self.nodes[:, :, 0].sum(axis=1)
        return 2.0 * np.pi * self.periods / np.asarray(self.machine.phase_speed(self.params))

    @cached_property
    def impacts(self) -> list[Impacts]:
        """An entry for each impact of the word."""
        clocks = self.nodes[:, :, 0] if self.machine.forced else np.zeros(self.nodes.shape[:2])
        return [
            Impacts(self.machine, letter.contact, self.nodes[:, i, 1:], clocks[:, i].copy(), self.params)
            for i, letter in self._hits
        ]

    @property
    def _hits(self) -> list[tuple[int, Letter]]:
        letters = [(i, self.word.letter(i)) for i in range(len(self.word))]
        return [(i, letter) for i, letter in letters[: self.nodes.shape[1]] if letter.kind == HIT]

    def flights(self, k: int) -> Iterator[tuple[tuple[int, ...], np.ndarray, float, float]]:
        """Yield mode, first state, and clock at the beginning and the end of every flight of solution k."""
        nodes, begin = self.nodes[k], np.zeros(self.nodes.shape[1])
        end = nodes[:, 0]
        if self.machine.forced:
            begin, end = end, np.append(end[1:], end[0] + 2.0 * np.pi * self.periods)
        for i in range(len(nodes)):
            yield self.word.entries(i), nodes[i, 1:], float(begin[i]), float(end[i])

    def loads(self, rubbing: bool) -> dict[str, np.ndarray]:
        """Return the measures of `machine.load_names`, with losses of friction if `rubbing`; sums over impacts are taken wall by wall."""
        machine, params = self.machine, self.params
        walls, contact_time = [machine.contacts[j].letter for j in machine.equations.gap], None
        if "peak_force" in machine.load_names:
            contact_time = params[:, machine.parameter_names.index(CONTACT)] * machine.equations.factors.get(
                CONTACT, 1.0
            )
        speeds, restitution, mass = (
            np.array([getattr(one, name) for one in self.impacts]).reshape(-1, len(self.nodes)).T
            for name in ("speeds", "restitution", "mass")
        )
        at = [letter.text for _, letter in self._hits]
        found = loads(speeds, restitution, mass, at, walls, self.period, contact_time)
        if rubbing:
            rubbed = np.zeros(len(self.nodes))
            for k in range(len(self.nodes) if machine.equations.limit else 0):
                rubbed[k] = sum(friction_work(machine, *flight, params[k]) for flight in self.flights(k))
            found |= {"friction_loss": rubbed, "work_rate": (found["impact_loss"] + rubbed) / self.period}
        return found

    @cached_property
    def extremes(self) -> tuple[np.ndarray, np.ndarray]:
        """Largest and smallest value of every state over the period, shape (m, n): at the events and at zeros of the rate between them."""
        largest, smallest = self.nodes[:, :, 1:].max(axis=1), self.nodes[:, :, 1:].min(axis=1)
        for k in range(len(self.nodes)):
            for mode, state, begin, end in self.flights(k):
                if 0.0 < end - begin < SOLVING.longest_flight:
                    rows = farthest(self.machine, mode, state, begin, end, self.params[k])
                    largest[k] = np.maximum(largest[k], rows.max(axis=0))
                    smallest[k] = np.minimum(smallest[k], rows.min(axis=0))
        return largest, smallest

    @cached_property
    def strobed(self) -> np.ndarray:
        """States at the first passage of phase zero (a multiple of 2 pi) after the first event, shape (m, n)."""
        out, modes = np.empty((len(self.nodes), self.machine.size)), self.word.contact_modes
        for k, nodes in enumerate(self.nodes):
            begins = nodes[:, 0]
            target = 2.0 * np.pi * np.ceil(begins[0] / (2.0 * np.pi) - EVENTS.zero)
            place = np.clip(np.searchsorted(begins, [target], side="right") - 1, 0, len(begins) - 1)
            ahead = np.maximum(target - begins[place], 0.0)
            out[k] = flown(self.machine, self.params[k], modes, nodes[:, 1:], begins, place, ahead)[0]
        return out


def farthest(
    machine: Machine, mode: tuple[int, ...], state: np.ndarray, begin: float, end: float, params: np.ndarray
) -> np.ndarray:
    """Return the states at the ends of a flight and at zeros of a rate in between, shape (k, n)."""
    watch = machine.compiled.extremes(machine.equations.pattern_key(mode))
    numbers = machine.compiled.numbers(params, mode)
    rows = [state]
    clocks = np.linspace(begin, end, max(1, math.ceil((end - begin) / (2.0 * math.pi))) + 1)
    for one, other in pairwise(clocks.tolist() if end > begin else ()):
        rows += [row for _, _, row in watch(rows[-1], one, other, numbers)]
        rows.append(watch.final)
    return np.array(rows)


PLACES, WEIGHTS = np.polynomial.legendre.leggauss(16)
PIECE = 0.5 * math.pi  # longest interval of the clock for one quadrature rule


class Impacts:
    """Impacts on one wall: speeds before them [m/s], the wall's restitution, and masses of the relative motion [kg], as arrays."""

    def __init__(
        self, machine: Machine, wall: int, after: np.ndarray, clocks: np.ndarray, params: np.ndarray
    ) -> None:
        """Compute from states after the impacts (m, n), `clocks` (m,) and parameters (m, P); without a declared energy the masses are 1."""
        numbers = np.hstack([params, np.zeros((len(params), len(machine.equations.signed)))])
        has_energy = machine.equations.energy is not None
        rows = (machine.compiled.loads if has_energy else machine.compiled.rebound)(wall)(
            after, clocks, numbers
        )
        self.speeds, self.restitution = rows[:, 0] / rows[:, 1], rows[:, 1]
        self.mass = rows[:, 2] if has_energy else np.ones(len(rows))

    @property
    def impulses(self) -> np.ndarray:
        """(1 + r) m s [N s]."""
        return (1.0 + self.restitution) * self.mass * self.speeds

    @property
    def losses(self) -> np.ndarray:
        """Energy of the relative motion lost in each impact, (1 - r^2) m s^2/2 [J]."""
        return (1.0 - self.restitution**2) * (0.5 * self.mass * self.speeds**2)


def friction_work(
    machine: Machine, mode: tuple[int, ...], state: np.ndarray, begin: float, end: float, params: np.ndarray
) -> float:
    """Return the energy lost in frictions on a flight [J], by Gauss-Legendre quadrature on pieces of it."""
    key = machine.equations.pattern_key(mode)
    if not end > begin:
        return 0.0
    pieces = math.ceil((end - begin) / PIECE)
    half = 0.5 * (end - begin) / pieces
    middles = begin + half * (2.0 * np.arange(pieces) + 1.0)
    clocks = (middles[:, None] + half * PLACES).ravel()
    numbers = machine.compiled.numbers(params, mode)
    states = machine.compiled.watch(key).path(state, np.concatenate([[begin], clocks]), numbers)[1:]
    power = machine.compiled.friction_power(key)(states, clocks, np.tile(numbers, (len(clocks), 1)))[:, 0]
    return float(power @ np.tile(WEIGHTS, pieces)) * half / float(machine.phase_speed(params))
