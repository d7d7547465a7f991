"""A simulated motion of a built-in machine: exact events, and closed forms between them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from orbits import contacts as kinds
from orbits.flows.trajectory import TWO_PI, Trajectory
from orbits.machines.stepping import MODE, PSI, RATE, TURNS, Stepper, W
from orbits.settings import EVENTS, SIMULATING
from orbits.words import Word
from orbits.words.alphabet import shaken

if TYPE_CHECKING:
    pass

LETTERS = "LRtsuH"
KINDS = np.array([kinds.HIT, kinds.HIT, kinds.TURN, kinds.STICK, kinds.SLIP, kinds.HOLD])
MOST_STEPS = 60  # largest number of steps of the root search for a peak
PER_PERIOD = 200  # samples per forcing period
PER_OSCILLATION = (
    12  # samples per natural oscillation, between which extrema of q1 are searched; events are added
)


class Samples(NamedTuple):
    """The motion at given instants; arrays of shape (n,), lengths in units of the cavity's half-width."""

    phase: np.ndarray
    w: np.ndarray
    w_rate: np.ndarray
    v: np.ndarray
    v_rate: np.ndarray
    cavity: np.ndarray
    absorber: np.ndarray


class Balance(NamedTuple):
    """Energy balance: change = excitation - damping - friction - impacts, up to `error`.

    `error` is relative to the sum of all works in absolute value plus energies: those at the ends, and the kinetic energy at the cavity's speed.
    """

    change: float
    excitation: float
    damping: float
    friction: float
    impacts: float
    error: float


@dataclass(frozen=True, eq=False)
class NativeTrajectory(Trajectory):
    """A simulated motion of a built-in machine; see `orbits.flows.trajectory.Trajectory`.

    Attributes
    ----------
    machine : Stepper
        The machine's stepper.
    start, end : ndarray, shape (S,)
        First and last state; see :mod:`orbits.machines.stepping`.
    codes, modes : ndarray of int8, shape (n,)
        Event codes (L R t s u = 0 ... 4, H = 5: persistent contact begins) and the modes after the events.
    rows : ndarray, shape (n, ROW)
        Event rows; see :mod:`orbits.machines.stepping`.
    """

    machine: Stepper
    start: np.ndarray
    end: np.ndarray
    codes: np.ndarray
    modes: np.ndarray
    rows: np.ndarray

    @property
    def points(self) -> np.ndarray:
        """Positions and velocities just after the events, shape (n, d)."""
        return self.states[1:, list(self.machine.places)]

    @cached_property
    def letters(self) -> str:
        """The letters of the events as one string."""
        return "".join(LETTERS[code] for code in self.codes)

    @property
    def occurrences(self) -> list[tuple[str, int]]:
        """Letter and mode of each event."""
        return [*zip(map(LETTERS.__getitem__, self.codes.tolist()), self.modes.tolist())]

    @cached_property
    def labels(self) -> np.ndarray:
        """One number for each event, the same for equal events, int array (n,)."""
        return 3 * self.codes.astype(int) + self.modes

    @property
    def held(self) -> bool:
        """Whether the absorber rests on a wall during the whole run."""
        return not len(self) and self.start[MODE] == 0.0 and self.start[W] in self.machine.walls(self.params)

    @property
    def phases(self) -> np.ndarray:
        """Phase Psi of every event, shape (n,), counted through: 2 pi per forcing period."""
        return self.clocks[1:]

    @property
    def nodes(self) -> np.ndarray:
        """Unknowns of continuation at every event, shape (n, NODE)."""
        return self.machine.nodes_of(self.params, self.codes, self.modes, self.rows)

    def cycle(self, first: int, last: int) -> tuple[Word, np.ndarray]:
        """Return word and nodes of the cycle that consists of events `first` to `last` - 1.

        Mere touches of a wall are left out, and a cycle without impacts is placed in the middle of the cavity.
        """
        model, part = self.model, slice(first, last)
        codes, modes, rows = self.codes[part], self.modes[part], self.rows[part]
        nodes = self.machine.nodes_of(self.params, codes, modes, rows)
        speeds = np.abs(rows[:, 3]) / np.prod(model.natural_units(self.params))
        real_events = ~_touches(codes, nodes, speeds)
        codes, modes = codes[real_events], modes[real_events]
        alphabet = shaken(model.frictionless(self.params))
        word = Word(tuple(LETTERS[code] for code in codes), tuple(map(int, modes)), alphabet)
        return word, model.at_home(codes, nodes[real_events], self.params)

    def approaches(self, first: int = 0) -> np.ndarray:
        """Return |w'| just before the impacts from event `first` on."""
        return np.abs(self.rows[first:, 3][self.hits[first:]])

    def shown(self, first: int) -> list[float]:
        """Return B = (B+ - B-)/2 of the impacts, positive away from the wall: half the jump of -w', because v' does not jump."""
        part = self.rows[first:][self.hits[first:]]
        away = 1.0 - 2.0 * self.codes[first:][self.hits[first:]]  # L = 0, R = 1
        jumps = 0.5 * away * (part[:, 3] - part[:, 4])
        return (jumps * float(self.model.gauge("velocity", self.params))).tolist()

    def extremes(self, per_period: int = 0) -> dict[str, float]:
        """Return the largest |w|, and the largest displacement of an oscillator (reduced model: C2)."""
        reach = np.append(self.states[:, W], self.end[W])
        if self.model.frictionless(self.params):  # without friction turns are no events
            reach = np.append(reach, self.sample().w)
        left, right = self.machine.walls(self.params)
        far = min(max(left, -right), float(np.abs(reach).max()))
        if not self.machine.moving_cavity:
            amplitude = float(self.model.column(self.params, self.model.driven_by))
            return {"C2": amplitude**2, "max_abs_w": far}
        slow = max(1.0, 1.0 / float(self.model.phase_speed(self.params)))
        often = per_period or math.ceil(min(PER_PERIOD, PER_OSCILLATION * slow))
        return {"max_abs_q1": self.peak_cavity(often), "max_abs_w": far}

    def responses(self, per_period: int) -> tuple[np.ndarray, np.ndarray]:
        """Return phases, and |q1| at these phases."""
        samples = self.sample(per_period=per_period)
        return samples.phase, np.abs(samples.cavity)

    @cached_property
    def states(self) -> np.ndarray:
        """States at the start and after every event, shape (n + 1, S)."""
        return np.concatenate([self.start[None, :], self.machine.event_states(self.modes, self.rows)])

    @cached_property
    def lengths(self) -> np.ndarray:
        """Length of each flight in phase, shape (n + 1,); the last one ends with the run."""
        psi = np.append(self.states[:, PSI], self.end[PSI])
        turns = np.append(self.states[:, TURNS], self.end[TURNS])
        return np.maximum(np.diff(psi) + TWO_PI * np.diff(turns), 0.0)

    def sample(self, phases: np.ndarray | None = None, per_period: int = PER_PERIOD) -> Samples:
        """Evaluate the motion in closed form.

        Parameters
        ----------
        phases : ndarray, shape (n,), optional
            Phases Psi inside the run (radians, counted through); by default evenly spaced over the run.
        per_period : int
            Number of default instants per forcing period.

        Returns
        -------
        Samples

        Raises
        ------
        ValueError
            If a phase lies outside the run.
        """
        if phases is None:
            phases = self._grid(per_period)
        phases = np.atleast_1d(np.asarray(phases, dtype=float))
        w, w_rate, v, v_rate = self.at(phases).T
        return Samples(phases, w, w_rate, v, v_rate, *self.model.bodies(w, v, self.params))

    def flown(self, places: np.ndarray, ahead: np.ndarray) -> np.ndarray:
        """Return w, w', v, v' at clocks `ahead` after the start (place 0) or event `place`, shape (m, 4)."""
        out = np.empty((len(ahead), 4))
        self.machine.sample(self.states[places], self.params, ahead, out)
        return out

    def peak_cavity(self, per_period: int = PER_PERIOD) -> float:
        """Return the largest displacement |q1| of the cavity in the run: at events, ends, and zeros of q1' between samples."""
        grid = self._grid(per_period)
        marks = np.concatenate([grid, self.phases])
        marks = np.unique(marks[(marks >= grid[0]) & (marks <= grid[-1])])
        samples = self.sample(marks)
        speed, _ = self.model.bodies(samples.w_rate, samples.v_rate, self.params)
        turn = np.flatnonzero(speed[:-1] * speed[1:] < 0.0)
        high = np.abs(samples.cavity)
        peak = float(high.max())
        steep = np.maximum(np.abs(speed[turn]), np.abs(speed[turn + 1]))
        rise = steep * (marks[turn + 1] - marks[turn])  # largest possible gain of q1 up to the zero of q1'
        turn = turn[np.maximum(high[turn], high[turn + 1]) + rise >= peak]
        lo, hi, below, above = marks[turn], marks[turn + 1], speed[turn], speed[turn + 1]
        before, place = np.zeros(turn.size, dtype=int), np.full(turn.size, np.inf)
        for _ in range(MOST_STEPS if turn.size else 0):  # the Illinois rule, for all zeros together
            last, place = place, np.clip(lo + (hi - lo) * below / (below - above), lo, hi)
            at_zero = self.sample(place)
            rate, _ = self.model.bodies(at_zero.w_rate, at_zero.v_rate, self.params)
            peak = max(peak, float(np.abs(at_zero.cavity).max()))
            if np.all((rate == 0.0) | (np.abs(place - last) < SIMULATING.peak)):
                break
            side = np.where(rate * below > 0.0, 1, -1)
            share = np.where(side == before, 0.5, 1.0)  # an end kept twice gets half its weight
            lo, hi = np.where(side > 0, place, lo), np.where(side > 0, hi, place)
            below, above = (
                np.where(side > 0, rate, share * below),
                np.where(side > 0, share * above, rate),
            )
            before = side
        return peak

    def _grid(self, per_period: int) -> np.ndarray:
        """Return equally spaced phases over the run."""
        first, last = float(self.clocks[0]), self.finish
        return np.linspace(first, last, max(2, int(np.ceil((last - first) / TWO_PI * per_period)) + 1))

    def balance(self) -> Balance:
        """Return the energy balance of the run, with the energy as the model's kernels define it."""
        works = np.empty((len(self) + 1, 3))
        self.machine.works(self.states, self.params, self.lengths, works)
        before = self.states[1:].copy()
        before[:, RATE] = self.rows[:, 3]
        pre, post, ends = np.empty(len(self)), np.empty(len(self)), np.empty(2)
        self.machine.energies(before, self.params, pre)
        self.machine.energies(self.states[1:], self.params, post)
        self.machine.energies(np.stack([self.start, self.end]), self.params, ends)
        lost = np.where(self.codes < 2, pre - post, 0.0)
        excitation, damping, friction = works.sum(axis=0)
        change = float(ends[1] - ends[0])
        impacts = float(lost.sum())
        gap = change - (excitation - damping - friction - impacts)
        ahead = np.arange(8) * (TWO_PI / 8.0)
        cavity = np.empty((8, 4))
        self.machine.sample(np.tile(self.start, (8, 1)), self.params, ahead, cavity)
        scale = float(
            np.abs(works).sum() + np.abs(lost).sum() + ends.max() + 0.5 * np.square(cavity[:, 3]).max()
        )
        error = abs(gap) / scale if scale > 0.0 else 0.0
        return Balance(change, float(excitation), float(damping), float(friction), impacts, float(error))


def _touches(codes: np.ndarray, nodes: np.ndarray, speeds: np.ndarray) -> np.ndarray:
    """Return which events are mere touches of a wall that leave the absorber in place; only if the cycle has no other impacts.

    A stick-slip motion that overlaps a wall is pushed away by impacts until it only just reaches the wall. The impacts that remain are
    roundoff; the motion is a motion without impacts, somewhere in the cavity.
    """
    hits = codes < 2
    wait = (np.roll(nodes[:, 0], -1) - nodes[:, 0]) % TWO_PI
    soft = hits & (speeds < EVENTS.touch) & (np.roll(codes, -1) == 3) & (wait < SIMULATING.at_once)
    return soft if np.array_equal(soft, hits) else np.zeros_like(soft)
