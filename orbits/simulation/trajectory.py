"""What a simulation returns: the exact list of events, and the motion between them in closed form."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from orbits.machines.states import event_states
from orbits.machines.stepping import HOLD, PSI, RATE, STATUS, TURNS, Machine

if TYPE_CHECKING:
    from orbits.machines.base import Model

TWO_PI = 2.0 * np.pi
LETTERS = "LRtsuH"
PLACED = 1e-8  # phases of a peak that differ by less: the peak itself is known to the square of that
MOST_STEPS = 60  # towards a peak


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
    """Where the energy went: change = excitation - damping - friction - impacts, up to `error`.

    `error` is relative to all work done, up or down, plus the kinetic energy that the cavity's speed stands for.
    """

    change: float
    excitation: float
    damping: float
    friction: float
    impacts: float
    error: float


@dataclass(frozen=True, eq=False)
class Trajectory:
    """A simulated motion.

    Attributes
    ----------
    model : Model
        The machine.
    params : ndarray, shape (P,)
        Parameter vector of the run.
    start, end : ndarray, shape (S,)
        First and last state; see :mod:`orbits.machines.stepping`.
    codes, modes : ndarray of int8, shape (n,)
        Event codes (L R t s u = 0 ... 4, H = 5: persistent contact begins) and the modes after the events.
    rows : ndarray, shape (n, ROW)
        Event rows; see :mod:`orbits.machines.stepping`.
    status : int
        Why the run ended; `ended` says it in words.
    """

    model: Model
    params: np.ndarray
    machine: Machine
    start: np.ndarray
    end: np.ndarray
    codes: np.ndarray
    modes: np.ndarray
    rows: np.ndarray
    status: int

    def __len__(self) -> int:
        return self.codes.size

    @property
    def ended(self) -> str:
        """Why the run ended, and whether impacts piled up on the way."""
        sentence = STATUS[self.status]
        contacts = int(np.count_nonzero(self.codes == HOLD))
        if contacts:
            times = "once" if contacts == 1 else f"{contacts} times"
            sentence += f"; impacts piled up into persistent contact {times}"
        return sentence

    @property
    def letters(self) -> str:
        """The events as one string."""
        return "".join(LETTERS[code] for code in self.codes)

    @property
    def impacts(self) -> int:
        """Number of impacts."""
        return int(np.count_nonzero(self.codes < 2))

    @property
    def phases(self) -> np.ndarray:
        """Phase Psi of every event, shape (n,), counted through: 2 pi per forcing period."""
        return self.rows[:, 0] + TWO_PI * self.rows[:, 1]

    @property
    def impact_times(self) -> np.ndarray:
        """Instants of the impacts, in the machine's time."""
        frequency = float(self.params[self.model.parameter_names.index("frequency")])
        return self.phases[self.codes < 2] / frequency * float(self.model.gauge("time", self.params))

    @cached_property
    def states(self) -> np.ndarray:
        """State at the start and after every event, shape (n + 1, S)."""
        return np.concatenate([self.start[None, :], event_states(self.machine, self.modes, self.rows)])

    @cached_property
    def lengths(self) -> np.ndarray:
        """Phase that passes in each segment, shape (n + 1,); the last one ends with the run."""
        psi = np.append(self.states[:, PSI], self.end[PSI])
        turns = np.append(self.states[:, TURNS], self.end[TURNS])
        return np.maximum(np.diff(psi) + TWO_PI * np.diff(turns), 0.0)

    def sample(self, phases: np.ndarray | None = None, per_period: int = 200) -> Samples:
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
        first, last = self._span()
        if phases is None:
            phases = self._grid(per_period)
        phases = np.atleast_1d(np.asarray(phases, dtype=float))
        slack = 1e-9 * max(1.0, abs(last))
        if phases.size and (phases.min() < first - slack or phases.max() > last + slack):
            raise ValueError(
                f"phases from {phases.min():g} to {phases.max():g} leave the run, which lasts "
                f"from {first:g} to {last:g}; simulate more periods"
            )
        begins = self.states[:, PSI] + TWO_PI * self.states[:, TURNS]
        place = np.clip(np.searchsorted(begins, phases, side="right") - 1, 0, len(begins) - 1)
        states = self.states[place]
        ahead = np.maximum((phases - TWO_PI * states[:, TURNS]) - states[:, PSI], 0.0)
        out = np.empty((phases.size, 4))
        self.machine.sample(states, self.params, ahead, out)
        w, w_rate, v, v_rate = out.T
        return Samples(phases, w, w_rate, v, v_rate, *self.model.bodies(w, v, self.params))

    def coordinates(self, times: np.ndarray) -> np.ndarray:
        """The simulator's coordinates at these times (forcing periods), shape (m, d)."""
        seen = self.sample(TWO_PI * times)
        return np.column_stack([getattr(seen, name) for name in self.machine.coordinates])

    def peak_cavity(self, per_period: int = 200) -> float:
        """Largest displacement |q1| of the cavity over the run: events, ends, and the zeros of q1' between samples."""
        grid = self._grid(per_period)
        marks = np.concatenate([grid, self.phases])
        marks = np.unique(marks[(marks >= grid[0]) & (marks <= grid[-1])])
        seen = self.sample(marks)
        speed, _ = self.model.bodies(seen.w_rate, seen.v_rate, self.params)
        turn = np.flatnonzero(speed[:-1] * speed[1:] < 0.0)
        high = np.abs(seen.cavity)
        peak = float(high.max())
        steep = np.maximum(np.abs(speed[turn]), np.abs(speed[turn + 1]))
        rise = steep * (marks[turn + 1] - marks[turn])  # q1' changes its sign there: q1 can gain no more
        turn = turn[np.maximum(high[turn], high[turn + 1]) + rise >= peak]
        lo, hi, below, above = marks[turn], marks[turn + 1], speed[turn], speed[turn + 1]
        before, place = np.zeros(turn.size, dtype=int), np.full(turn.size, np.inf)
        for _ in range(MOST_STEPS if turn.size else 0):  # the Illinois rule, for all at once
            last, place = place, np.clip(lo + (hi - lo) * below / (below - above), lo, hi)
            here = self.sample(place)
            rate, _ = self.model.bodies(here.w_rate, here.v_rate, self.params)
            peak = max(peak, float(np.abs(here.cavity).max()))
            if np.all((rate == 0.0) | (np.abs(place - last) < PLACED)):
                break
            side = np.where(rate * below > 0.0, 1, -1)
            share = np.where(side == before, 0.5, 1.0)  # an end that stays twice counts half
            lo, hi = np.where(side > 0, place, lo), np.where(side > 0, hi, place)
            below, above = (
                np.where(side > 0, rate, share * below),
                np.where(side > 0, share * above, rate),
            )
            before = side
        return peak

    def _span(self) -> tuple[float, float]:
        """Phases at which the run begins and ends, counted through."""
        return (
            float(self.start[PSI] + TWO_PI * self.start[TURNS]),
            float(self.end[PSI] + TWO_PI * self.end[TURNS]),
        )

    def _grid(self, per_period: int) -> np.ndarray:
        """Evenly spaced phases over the run."""
        first, last = self._span()
        return np.linspace(first, last, max(2, int(np.ceil((last - first) / TWO_PI * per_period)) + 1))

    def balance(self) -> Balance:
        """Energy balance over the run, in the energy that the model's kernels define."""
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
