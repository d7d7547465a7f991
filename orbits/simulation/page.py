"""Event-driven simulation of declared machines: exact event lists, and the motion between the events."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from orbits.contacts.letters import HIT, HOLD, RELEASE
from orbits.contacts.wall import HELD, Wall
from orbits.flows.page.stepper import TWO_PI, Stepper
from orbits.flows.page.variations import Variations
from orbits.flows.protocol import Record, SimulationError, checked_start
from orbits.machines.page.machine import Machine

if TYPE_CHECKING:
    from orbits.words import Word

REACHED, FULL, STILL = 0, 1, 2
AWAY = 1e3  # clock without an event of a cycle after which a motion does not come back to it
FOREVER = 1e5  # clock after which a run that waits for events gives up


@dataclass(frozen=True, eq=False)
class PageTrajectory:
    """A simulated motion of a declared machine.

    Attributes
    ----------
    machine : Machine
    params : float array (P,)
    clocks : float array (m + 1,)
        Phase (or time) of the start and of every event, counted through.
    states : float array (m + 1, n)
        At the start, and just after every event.
    modes : list of tuple of int, m + 1 entries
        After them.
    events : list of (contact, kind, sign), m entries
    end : float
        Clock at which the run ended.
    last : float array (n,)
        State then.
    status : int
        REACHED the wanted time; FULL: as many events as were asked for; STILL: nothing happened for very long.
    """

    machine: Machine
    params: np.ndarray
    clocks: np.ndarray
    states: np.ndarray
    modes: list[tuple[int, ...]]
    events: list[tuple[int, int, int]]
    end: float
    last: np.ndarray
    status: int

    def __len__(self) -> int:
        return len(self.events)

    @property
    def letters(self) -> list[str]:
        """The events as they are written; "(R" and "R)" are where wall R begins and ends to hold."""
        return [letter_of(self.machine, event) for event in self.events]

    @property
    def impacts(self) -> int:
        """Number of impacts."""
        return sum(kind == HIT for _, kind, _ in self.events)

    @property
    def impact_times(self) -> np.ndarray:
        """Instants of the impacts, in the machine's time."""
        hits = [kind == HIT for _, kind, _ in self.events]
        return self.clocks[1:][hits] / self.machine.phase_speed(self.params)

    @property
    def chatters(self) -> int:
        """How often infinitely many impacts piled up and a wall held the body."""
        return sum(kind == HOLD for _, kind, _ in self.events)

    @property
    def held(self) -> bool:
        """Whether one of the walls holds the body from the beginning to the end."""
        walls = [j for j, contact in enumerate(self.machine.contacts) if isinstance(contact, Wall)]
        return any(all(mode[j] == HELD for mode in self.modes) for j in walls)

    @property
    def ended(self) -> str:
        """Why the run ended, and whether impacts piled up on the way."""
        sentence = (
            "the requested time was reached",
            "the requested number of events was reached",
            f"no further event within {FOREVER:g} of the clock",
        )[self.status]
        if self.chatters:
            times = "once" if self.chatters == 1 else f"{self.chatters} times"
            sentence += f"; impacts piled up and a wall held the body {times}"
        return sentence

    def coordinates(self, times: np.ndarray) -> np.ndarray:
        """The states at these times (forcing periods, or time over 2 pi), shape (m, n)."""
        return self.sample(TWO_PI * times)

    def onwards(self, clocks: np.ndarray) -> np.ndarray:
        """States, shape (m, n), so long after the end of a run of a self-excited machine, in its last mode and without events."""
        compiled, mode = self.machine.compiled, self.modes[-1]
        watch = compiled.watch(self.machine.equations.pattern_key(mode))
        return watch.path(self.last, clocks, compiled.numbers(self.params, mode))

    def sample(self, clocks: np.ndarray) -> np.ndarray:
        """States, shape (m, n), at increasing clocks within the run."""
        clocks = np.asarray(clocks, dtype=float)
        out = np.empty((len(clocks), self.machine.size))
        segment = np.clip(np.searchsorted(self.clocks, clocks, side="right") - 1, 0, len(self.clocks) - 1)
        compiled, e = self.machine.compiled, self.machine.equations
        for i in np.unique(segment):
            places = np.flatnonzero(segment == i)
            watch = compiled.watch(e.pattern_key(self.modes[i]))
            numbers = compiled.numbers(self.params, self.modes[i])
            first = self.clocks[i]
            offset = TWO_PI * math.floor(first / TWO_PI) if self.machine.forced else first
            grid = np.concatenate([[first], clocks[places]]) - offset
            out[places] = watch.path(self.states[i], grid, numbers)[1:]
        return out


def letter_of(machine: Machine, event: tuple[int, int, int]) -> str:
    """How an event is written."""
    contact, kind, sign = event
    if kind == HOLD:
        return f"({machine.contacts[contact].letter}"
    if kind == RELEASE:
        return f"{machine.contacts[contact].letter})"
    return machine.alphabet.text_of(contact, kind, sign)


def outside(stepper: Stepper, state: np.ndarray, clock: float) -> np.ndarray:
    """A state moved out of the walls that lie over it, shape (S,)."""
    machine, state = stepper.machine, np.array(state, dtype=float)
    stepper.state, stepper.clock = state, clock
    stepper.modes = machine.rest_mode(stepper.params, state, stepper.clock)
    for _ in range(200):  # walls that push against one another are left in turn
        gaps = stepper.contact_values()
        deep = [j for j, c in enumerate(machine.contacts) if isinstance(c, Wall) and gaps[j] < 0.0]
        if not deep:
            break
        slopes = machine.compiled.gap_slopes(deep[0])(
            state[None],
            np.array([stepper.clock]),
            machine.compiled.numbers(stepper.params, stepper.modes)[None],
        )[0]
        state += (1e-12 - gaps[deep[0]]) * slopes / float(slopes @ slopes)
    return state


def collect(stepper: Stepper, length: float, most: int) -> PageTrajectory:
    """Run on for a length of the clock, or so many events."""
    clocks = [stepper.base + stepper.clock]
    states, modes, events = [stepper.state.copy()], [stepper.modes], []
    until = clocks[0] + (FOREVER if math.isinf(length) else length)
    status = FULL
    while len(events) < most:
        event = stepper.advance(until)
        if event is None:
            status = STILL if math.isinf(length) else REACHED
            break
        clocks.append(stepper.base + stepper.clock)
        states.append(stepper.state.copy())
        modes.append(stepper.modes)
        events.append(event)
        if math.isinf(length):
            until = clocks[-1] + FOREVER
    return PageTrajectory(
        stepper.machine,
        stepper.params,
        np.array(clocks),
        np.array(states),
        modes,
        events,
        stepper.base + stepper.clock,
        stepper.state.copy(),
        status,
    )


class PageSimulator:
    """A page's motion on its way; see the contract at the top of `orbits.flows.protocol`."""

    watched = (3000.0, 3000)

    def __init__(self, machine: Machine, params: np.ndarray) -> None:
        self.model = self.machine = machine
        self.params = params
        self.stepper = Stepper(machine, params)
        self.forced, self.names = machine.forced, machine.states
        self.hard = np.zeros(machine.size, dtype=bool)  # a start within a wall is refused

    @property
    def mirrored(self) -> bool:
        """Whether the machine equals its mirror image."""
        return self.machine.has_mirror(self.params)

    def image(self, point: np.ndarray) -> np.ndarray:
        """A point mirrored about the origin."""
        return -point

    @property
    def time(self) -> float:
        """Forcing periods; of a self-excited machine its time over 2 pi."""
        return (self.stepper.base + self.stepper.clock) / TWO_PI

    @property
    def point(self) -> np.ndarray:
        """The states."""
        return self.stepper.state.copy()

    def start(self, point: np.ndarray, time: float = 0.0, modes: tuple[int, ...] | None = None) -> None:
        """Begin at a point."""
        self.stepper.start(point, TWO_PI * time, modes)

    def put(self, start: Mapping[str, float] | np.ndarray | None) -> None:
        """Begin at a start by names, or at clock and states."""
        state = self.state_of(start)
        self.stepper.start(state[1:], float(state[0]))

    def state_of(self, start: Mapping[str, float] | np.ndarray | None) -> np.ndarray:
        """Clock and states of a start, shape (n + 1,); it may lie within a wall."""
        if isinstance(start, np.ndarray):
            return start
        names = self.machine.states
        given = checked_start(dict(start or {}), [*names, *(["phase"] if self.forced else [])])
        return np.array([given.get("phase", 0.0), *(given.get(name, 0.0) for name in names)])

    @property
    def state(self) -> np.ndarray:
        """Clock and states, shape (n + 1,), from which another simulation goes on."""
        return np.append(self.stepper.clock, self.stepper.state)

    def go_on(self, state: np.ndarray, nudge: float = 0.0) -> None:
        """Begin where another simulation has ended, moved out of walls that are elsewhere now, its last state changed a little."""
        clock = float(state[0])
        self.stepper.start(outside(self.stepper, state[1:], clock), clock)
        self.stepper.state[-1] += nudge

    def begin(self, word: Word, node: np.ndarray) -> None:
        """Just after the first event of a cycle."""
        self.stepper.start(node[1:], float(node[0]) if self.forced else 0.0, word.modes[0])

    def follow(self, until: float) -> None:
        """Move on."""
        while self.stepper.advance(TWO_PI * until) is not None:
            pass

    def go_round(self, word: Word, periods: int, index: int | None = None) -> tuple[np.ndarray, np.ndarray]:
        """Move on by a period of a cycle, with derivatives; NaN where a wall has held the body."""
        stepper, n = self.stepper, self.machine.size
        mover = stepper if index is None else Variations(stepper, index)
        if self.forced:
            until = stepper.base + stepper.clock + TWO_PI * periods
            while mover.advance(until) is not None:
                pass
        else:
            letters = [word.letter(i) for i in range(len(word))]
            first = (letters[0].contact, letters[0].kind)
            left = sum((letter.contact, letter.kind) == first for letter in letters)
            while left:
                found = mover.advance(stepper.base + stepper.clock + AWAY)
                if found is None:
                    raise SimulationError("the event of the section does not come again")
                left -= found[:2] == first
        if isinstance(mover, Variations):
            return mover.derivatives
        return np.full((n, n), np.nan), np.full(n, np.nan)

    def run(self, periods: float, most: int) -> PageTrajectory:
        """Move on and keep the motion."""
        return collect(self.stepper, TWO_PI * periods, most)

    def record(self, until: float, most: int) -> Record:
        """Move on and list the events."""
        run = self.run(until - self.time, most)
        kinds = np.array([kind for _, kind, _ in run.events], dtype=int)
        events = [*zip(run.letters, run.modes[1:])]
        piled = (kinds == HOLD) | (kinds == RELEASE)
        return Record(
            run.clocks[1:] / TWO_PI, run.states[1:], events, kinds == HIT, piled, run.status == REACHED, run
        )

    def struck(self, point: np.ndarray, near: float) -> tuple[np.ndarray, np.ndarray] | None:
        """Of a point at a wall the other one there, just after the impact or just before it, and the direction away from the wall; None elsewhere.

        Where the forcing passes phase zero; the points just after the events of a self-excited machine are not distinguished.
        """
        if not self.forced:
            return None
        machine, here = self.machine, np.array(point, dtype=float)
        compiled = machine.compiled
        numbers = compiled.numbers(self.params, machine.rest_mode(self.params, here, 0.0))
        gaps = compiled.contact_values().one(here, 0.0, numbers)
        for j, contact in enumerate(machine.contacts):
            if not isinstance(contact, Wall):
                continue
            slopes = compiled.gap_slopes(j).one(here, 0.0, numbers)
            steep = float(np.linalg.norm(slopes))
            if not abs(gaps[j]) < near * steep:
                continue
            here = here - gaps[j] * slopes / steep**2
            row = compiled.impact_map(j).one(here, 0.0, numbers)
            jump, rate = row[: machine.size] - here, row[machine.size]
            if rate > 0.0:  # after an impact: the impulse was larger by 1/restitution and the other way round
                jump = jump / compiled.rebound(j).one(here, 0.0, numbers)[1]
            if rate != 0.0 and np.all(np.isfinite(jump)):
                return here + jump, slopes / steep
        return None
