"""A page's motion on its way (`orbits.flows.protocol`), round the stepper, and as it is kept: exact event lists, and the motion between them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from orbits.contacts import HOLD, RELEASE
from orbits.contacts.wall import HELD
from orbits.flows.page.pieces import flown
from orbits.flows.page.stepper import TWO_PI, Stepper
from orbits.flows.page.variations import Variations, growth
from orbits.flows.protocol import SimulationError, Simulator, Waiting, checked_start
from orbits.flows.trajectory import Trajectory
from orbits.machines.page.machine import Machine
from orbits.machines.stepping import EVENTS_FULL, REST, TIME_REACHED
from orbits.settings import EVENTS, SIMULATING
from orbits.words import Word

SAMPLES = 2000  # of a run, for its extremes
AWAY = 1000.0  # clock without an event of a cycle after which a motion does not come back to it
LONGEST_WORD = 400  # events of its longest cycle
REACH = 2.0  # a box of starts: so many times what the motion from rest reaches
WARM = 60.0  # forcing periods (or as much time) that tell what a machine reaches
LATE = 50  # instants of its motion by which it is told whether it has come to rest
FOREVER = 100_000.0  # clock after which a run that waits for events gives up


@dataclass(frozen=True, eq=False)
class PageTrajectory(Trajectory):
    """A simulated motion of a declared machine; see `orbits.flows.trajectory.Trajectory`.

    Attributes
    ----------
    states : float array (m + 1, n)
        At the start, and just after every event.
    modes : list of tuple of int, m + 1 entries
        After them.
    events : list of (contact, kind, sign), m entries
    last : float array (n,)
        State at the end.
    """

    states: np.ndarray
    modes: list[tuple[int, ...]]
    events: list[tuple[int, int, int]]
    last: np.ndarray

    @property
    def points(self) -> np.ndarray:
        """The states just after the events."""
        return self.states[1:]

    @property
    def nodes(self) -> np.ndarray:
        """What continuation solves for, at every event of a forced machine, shape (m, n + 1)."""
        return np.column_stack([self.clocks[1:], self.points])

    @cached_property
    def letters(self) -> list[str]:
        """The events as they are written; "(R" and "R)" are where wall R begins and ends to hold."""
        return [letter_of(self.model, event) for event in self.events]

    @property
    def occurrences(self) -> list[tuple[str, tuple[int, ...]]]:
        """Letters and modes."""
        return [*zip(self.letters, self.modes[1:])]

    @property
    def held(self) -> bool:
        """Whether one of the walls holds the body from the beginning to the end."""
        return any(all(mode[j] == HELD for mode in self.modes) for j in self.model.equations.gap)

    @property
    def reason(self) -> str:
        """Why the run ended."""
        return f"no further event within {FOREVER:g} of the clock" if self.stopped else super().reason

    def cycle(self, first: int, last: int) -> tuple[Word, np.ndarray]:
        """Word and nodes; of a self-excited machine the first duration is that since the event before, or the cycle's last one again."""
        part = slice(first, last)
        modes = self.modes[1:][part]
        word = Word(tuple(self.letters[part]), tuple(modes), self.model.alphabet)
        clocks = self.clocks[1:][part]
        if not self.model.forced:
            clocks = np.append(np.diff(clocks), clocks[0] - self.clocks[first])
        return word, np.column_stack([clocks, self.points[part]])

    def approaches(self, first: int = 0) -> np.ndarray:
        """The gap's rate after each impact over restitution."""
        compiled, speeds = self.model.compiled, []
        for k in first + np.flatnonzero(self.hits[first:]):
            contact, clock = self.events[k][0], float(self.clocks[k + 1]) if self.model.forced else 0.0
            numbers = compiled.numbers(self.params, self.modes[k + 1])
            rate, restitution = compiled.rebound(contact).one(self.states[k + 1], clock, numbers)
            speeds.append(float(rate / restitution))
        return np.array(speeds)

    def extremes(self, per_period: int = 0) -> dict[str, float]:
        """Largest and least first state, and the larger of their sizes."""
        x = self.sample(np.linspace(self.clocks[0], self.finish, SAMPLES))[:, 0]
        first = self.model.states[0]
        return {
            f"max_{first}": float(x.max()),
            f"min_{first}": float(x.min()),
            f"max_abs_{first}": float(np.abs(x).max()),
        }

    def responses(self, per_period: int) -> tuple[np.ndarray, np.ndarray]:
        """The first state over the phase; its size where this is what the machine shows."""
        count = max(2, math.ceil(per_period * self.lasted))
        clocks = np.linspace(self.clocks[0], self.finish, count, endpoint=False)
        x, first = self.sample(clocks)[:, 0], self.model.states[0]
        return clocks, np.abs(x) if self.model.response == f"max_abs_{first}" else x

    def sample(self, clocks: np.ndarray) -> np.ndarray:
        """States, shape (m, n), at clocks within the run."""
        return self.at(np.asarray(clocks, dtype=float))

    def flown(self, places: np.ndarray, ahead: np.ndarray) -> np.ndarray:
        """States."""
        return flown(self.model, self.params, self.modes, self.states, self.clocks, places, ahead)


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
        deep = [j for j in machine.equations.gap if gaps[j] < 0.0]
        if not deep:
            break
        numbers = machine.compiled.numbers(stepper.params, stepper.modes)
        slopes = machine.compiled.gap_slopes(deep[0]).one(state, stepper.clock, numbers)
        state += (EVENTS.zero - gaps[deep[0]]) * slopes / float(slopes @ slopes)
    return state


def follow(mover: Stepper | Variations, until: float) -> None:
    """Move on to a clock."""
    while mover.advance(until) is not None:
        pass


def collect(stepper: Stepper, length: float, most: int) -> PageTrajectory:
    """Run on for a length of the clock, or so many events."""
    clocks = [stepper.base + stepper.clock]
    states, modes, events = [stepper.state.copy()], [stepper.modes], []
    until = clocks[0] + (FOREVER if math.isinf(length) else length)
    status = EVENTS_FULL
    while len(events) < most:
        event = stepper.advance(until)
        if event is None:
            status = REST if math.isinf(length) else TIME_REACHED
            break
        clocks.append(stepper.base + stepper.clock)
        states.append(stepper.state.copy())
        modes.append(stepper.modes)
        events.append(event)
        if math.isinf(length):
            until = clocks[-1] + FOREVER
    kinds = np.array([kind for _, kind, _ in events], dtype=int)
    begun = stepper.machine, stepper.params, np.array(clocks), stepper.base + stepper.clock, kinds, status
    return PageTrajectory(*begun, np.array(states), modes, events, stepper.state.copy())


class PageSimulator(Simulator[Machine, PageTrajectory]):
    """See the contract at the top of `orbits.flows.protocol`."""

    watched = (3000.0, 3000)
    waiting = Waiting(100.0, 4, 0, 2, SIMULATING.returned_page, 5, 0.0, 50_000.0)
    observed, modulated = (0.0, 0.0), 0.0
    resting, wandering = "rest", "aperiodic"

    def __init__(self, machine: Machine, params: np.ndarray) -> None:
        self.model = machine
        self.params = params
        self.stepper = Stepper(machine, params)
        self.forced, self.names = machine.forced, machine.states
        self.roomy = machine.size > 2
        self.hard = np.zeros(machine.size, dtype=bool)  # a start within a wall is refused

    @property
    def modes(self) -> tuple[int, ...]:
        """What the contacts do."""
        return self.stepper.modes

    @property
    def count(self) -> float:  # type: ignore[override]
        """Events so far."""
        return float(self.stepper.count)

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
        names = self.model.states
        given = checked_start(dict(start or {}), [*names, *(["phase"] if self.forced else [])])
        return np.array([given.get("phase", 0.0), *(given.get(name, 0.0) for name in names)])

    @property
    def state(self) -> np.ndarray:  # type: ignore[override]
        """Clock and states, shape (n + 1,), from which another simulation goes on."""
        return np.append(self.stepper.clock, self.stepper.state)

    def go_on(self, state: np.ndarray, nudge: float = 0.0) -> None:
        """Begin where another simulation has ended, moved out of walls that are elsewhere now, its last state changed a little."""
        clock = (
            float(state[0]) if len(state) > self.model.size else 0.0
        )  # older files have no clock of a self-excited machine
        self.stepper.start(outside(self.stepper, state[-self.model.size :], clock), clock)
        self.stepper.state[-1] += nudge

    def begin(self, word: Word, node: np.ndarray) -> None:
        """Just after the first event of a cycle."""
        self.stepper.start(node[1:], float(node[0]) if self.forced else 0.0, word.entries(0))

    def follow(self, until: float) -> None:
        """Move on."""
        follow(self.stepper, TWO_PI * until)

    def go_round(self, word: Word, periods: int, index: int | None = None) -> tuple[np.ndarray, np.ndarray]:
        """Move on by a period of a cycle, with derivatives; NaN where a wall has held the body."""
        stepper, n = self.stepper, self.model.size
        mover = stepper if index is None else Variations(stepper, index)
        if self.forced:
            follow(mover, stepper.base + stepper.clock + TWO_PI * periods)
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

    def struck(self, point: np.ndarray, near: float) -> tuple[np.ndarray, np.ndarray] | None:
        """Of a point at a wall the other one there, just after the impact or just before it, and the direction away from the wall; None elsewhere.

        Where the forcing passes phase zero; the points just after the events of a self-excited machine are not distinguished.
        """
        if not self.forced:
            return None
        machine, here = self.model, np.array(point, dtype=float)
        compiled = machine.compiled
        numbers = compiled.numbers(self.params, machine.rest_mode(self.params, here, 0.0))
        gaps = compiled.contact_values().one(here, 0.0, numbers)
        for j in machine.equations.gap:
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

    # ------------------------------------------------------------------ settling
    def skip(self, count: float) -> bool:
        """Move on by so many forcing periods; of a self-excited machine, by so many events, and say whether there were as many."""
        stepper = self.stepper
        if self.forced:
            self.follow(self.time + int(count))
            return True
        return all(
            stepper.advance(stepper.base + stepper.clock + SIMULATING.wait) is not None
            for _ in range(int(count))
        )

    def look(self, longest: int) -> PageTrajectory:
        """Run on for two of the longest recurrences; events of a self-excited machine."""
        if self.forced:
            return collect(self.stepper, TWO_PI * (2 * longest + 1), 50 * longest + 2000)
        return collect(self.stepper, SIMULATING.wait, min(2 * LONGEST_WORD, 50 * longest))

    def rests(self, run: PageTrajectory, last: bool) -> bool:
        """Whether a wall holds the body, or a self-excited machine does not move any more."""
        if len(run):
            return False
        if run.held or self.forced:
            return run.held
        clocks, place = np.linspace(0.0, TWO_PI, LATE), np.zeros(LATE, dtype=int)
        states = flown(self.model, self.params, run.modes[-1:], run.last[None], clocks[:1], place, clocks)
        size = 1.0 + np.abs(states).max(axis=0)
        return bool((np.ptp(states, axis=0) <= self.waiting.returned * size).all())

    def push(self) -> None:
        """What sticks must not be moved: it leaves by itself."""

    def growth(self) -> tuple[float, float]:
        """See `orbits.flows.page.variations.growth`."""
        return growth(self.stepper)

    def section(self) -> tuple[str, np.ndarray]:
        """Move on to the next whole forcing period, or event."""
        if self.forced:
            return super().section()
        event = self.stepper.advance(self.stepper.base + self.stepper.clock + SIMULATING.wait)
        return "" if event is None else letter_of(self.model, event), self.point

    # ------------------------------------------------------------------ many starts
    def box(self) -> np.ndarray:
        """What the page says, else twice what the motion from rest reaches in sixty periods."""
        given, names = self.model.starts, self.model.states
        reached = self._reached() if any(name not in given for name in names) else np.zeros(len(names))
        rows = [[0.0, TWO_PI]] if self.forced else []
        rows += [list(given.get(name, (-REACH * far, REACH * far))) for name, far in zip(names, reached)]
        return np.array(rows)

    def _reached(self) -> np.ndarray:
        """Largest absolute value of each state on the motion from rest (moved out of the walls), shape (S,)."""
        zero = np.zeros(self.model.size)
        self.start(outside(self.stepper, zero, 0.0))
        try:
            run = self.run(WARM, 5000)
            reach = np.abs(run.sample(np.linspace(run.clocks[0], run.finish, SAMPLES))).max(axis=0)
        except SimulationError:
            reach = zero
        largest, room = float(reach.max()), self._room()
        if largest < SIMULATING.resting * room:  # it stays where it is
            return np.full(self.model.size, room)
        return np.maximum(reach, 0.1 * largest if largest > 0.0 else 1.0)

    def _room(self) -> float:
        """The widest gap of a wall at the state; 0 without walls."""
        values = self.stepper.contact_values()
        return max((float(values[j]) for j in self.model.equations.gap), default=0.0)

    def free(self, points: np.ndarray) -> np.ndarray:
        """Which starts have all gaps open, bool array (m,)."""
        machine = self.model
        walls = [*machine.equations.gap]
        if not walls:
            return np.ones(len(points), dtype=bool)
        clocks = points[:, 0] if self.forced else np.zeros(len(points))
        states = np.ascontiguousarray(points[:, 1:] if self.forced else points)
        numbers = np.concatenate([self.params, np.zeros(len(machine.equations.signed))])
        rows = np.repeat(numbers[None], len(points), axis=0)
        values = machine.compiled.contact_values()(states, np.ascontiguousarray(clocks), rows)
        return np.all(values[:, walls] >= 0.0, axis=1)
