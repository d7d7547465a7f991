"""Simulator of declared machines (`orbits.flows.protocol.Simulator`), and their simulated motions with exact events."""

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

SAMPLES = 2000  # samples of a run, for its extremes
AWAY = 1000.0  # longest clock without the section's event before a motion counts as not returning
LONGEST_WORD = 400  # events of the longest cycle of a self-excited machine
REACH = 2.0  # box of starts relative to the reach of the motion from rest
WARM = 60.0  # length of the motion from rest that sets the box of starts, in forcing periods
LATE = 50  # samples that decide whether a self-excited motion has come to rest
FOREVER = 100_000.0  # longest clock without an event in a run of unlimited length


@dataclass(frozen=True, eq=False)
class PageTrajectory(Trajectory):
    """A simulated motion of a declared machine; see `orbits.flows.trajectory.Trajectory`.

    Attributes
    ----------
    states : float array (m + 1, n)
        States at the start and just after every event.
    modes : list of tuple of int, m + 1 entries
        Modes after the start and after every event.
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
        """The states just after the events, shape (m, n)."""
        return self.states[1:]

    @property
    def nodes(self) -> np.ndarray:
        """Unknowns of continuation at every event of a forced machine, shape (m, n + 1)."""
        return np.column_stack([self.clocks[1:], self.points])

    @cached_property
    def letters(self) -> list[str]:
        """Letters of the events; "(R" and "R)" are begin and end of a hold on wall R."""
        return [letter_of(self.model, event) for event in self.events]

    @property
    def occurrences(self) -> list[tuple[str, tuple[int, ...]]]:
        """Letter of each event with the modes after it."""
        return [*zip(self.letters, self.modes[1:])]

    @property
    def held(self) -> bool:
        """Whether one of the walls holds the body during the whole run."""
        return any(all(mode[j] == HELD for mode in self.modes) for j in self.model.equations.gap)

    @property
    def reason(self) -> str:
        """The reason for the end of the run."""
        return f"no further event within {FOREVER:g} of the clock" if self.stopped else super().reason

    def cycle(self, first: int, last: int) -> tuple[Word, np.ndarray]:
        """Return word and nodes of the cycle that consists of events `first` to `last` - 1.

        The nodes of a self-excited machine hold durations; the last one, that of the closing flight, is the time since the event before `first`.
        """
        part = slice(first, last)
        modes = self.modes[1:][part]
        word = Word(tuple(self.letters[part]), tuple(modes), self.model.alphabet)
        clocks = self.clocks[1:][part]
        if not self.model.forced:
            clocks = np.append(np.diff(clocks), clocks[0] - self.clocks[first])
        return word, np.column_stack([clocks, self.points[part]])

    def approaches(self, first: int = 0) -> np.ndarray:
        """Return the approach speeds of the impacts: the gap's rate after each impact over the restitution."""
        compiled, speeds = self.model.compiled, []
        for k in first + np.flatnonzero(self.hits[first:]):
            contact, clock = self.events[k][0], float(self.clocks[k + 1]) if self.model.forced else 0.0
            numbers = compiled.numbers(self.params, self.modes[k + 1])
            rate, restitution = compiled.rebound(contact).one(self.states[k + 1], clock, numbers)
            speeds.append(float(rate / restitution))
        return np.array(speeds)

    def extremes(self, per_period: int = 0) -> dict[str, float]:
        """Return largest and smallest value, and largest absolute value, of the first state."""
        x = self.sample(np.linspace(self.clocks[0], self.finish, SAMPLES))[:, 0]
        first = self.model.states[0]
        return {
            f"max_{first}": float(x.max()),
            f"min_{first}": float(x.min()),
            f"max_abs_{first}": float(np.abs(x).max()),
        }

    def responses(self, per_period: int) -> tuple[np.ndarray, np.ndarray]:
        """Return clocks, and the first state there (its absolute value if that is the machine's response)."""
        count = max(2, math.ceil(per_period * self.lasted))
        clocks = np.linspace(self.clocks[0], self.finish, count, endpoint=False)
        x, first = self.sample(clocks)[:, 0], self.model.states[0]
        return clocks, np.abs(x) if self.model.response == f"max_abs_{first}" else x

    def sample(self, clocks: np.ndarray) -> np.ndarray:
        """Return the states, shape (m, n), at clocks within the run."""
        return self.at(np.asarray(clocks, dtype=float))

    def flown(self, places: np.ndarray, ahead: np.ndarray) -> np.ndarray:
        """Return the states at clocks `ahead` after the start (place 0) or event `place`, shape (m, n)."""
        return flown(self.model, self.params, self.modes, self.states, self.clocks, places, ahead)


def letter_of(machine: Machine, event: tuple[int, int, int]) -> str:
    """Return the letter of an event."""
    contact, kind, sign = event
    if kind == HOLD:
        return f"({machine.contacts[contact].letter}"
    if kind == RELEASE:
        return f"{machine.contacts[contact].letter})"
    return machine.alphabet.text_of(contact, kind, sign)


def outside(stepper: Stepper, state: np.ndarray, clock: float) -> np.ndarray:
    """Return a state moved out of the walls that it penetrates, shape (S,)."""
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
    """Run on for a length of the clock or at most `most` events, and return the motion."""
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
    start = stepper.machine, stepper.params, np.array(clocks), stepper.base + stepper.clock, kinds, status
    return PageTrajectory(*start, np.array(states), modes, events, stepper.state.copy())


class PageSimulator(Simulator[Machine, PageTrajectory]):
    """Moves one motion of a declared machine on; see `orbits.flows.protocol.Simulator`."""

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
        self.hard = np.zeros(machine.size, dtype=bool)  # a start within a wall raises an error

    @property
    def modes(self) -> tuple[int, ...]:
        """Modes of the contacts."""
        return self.stepper.modes

    @property
    def count(self) -> float:  # type: ignore[override]
        """Events so far."""
        return float(self.stepper.count)

    @property
    def time(self) -> float:
        """Time: forcing periods, or time over 2 pi of a self-excited machine."""
        return (self.stepper.base + self.stepper.clock) / TWO_PI

    @property
    def point(self) -> np.ndarray:
        """Present states."""
        return self.stepper.state.copy()

    def start(self, point: np.ndarray, time: float = 0.0, modes: tuple[int, ...] | None = None) -> None:
        """Begin at a point; the modes follow from it if they are not given."""
        self.stepper.start(point, TWO_PI * time, modes)

    def put(self, start: Mapping[str, float] | np.ndarray | None) -> None:
        """Begin at a start by names, or at clock and states."""
        state = self.state_of(start)
        self.stepper.start(state[1:], float(state[0]))

    def state_of(self, start: Mapping[str, float] | np.ndarray | None) -> np.ndarray:
        """Return clock and states of a start, shape (n + 1,); the start may lie within a wall."""
        if isinstance(start, np.ndarray):
            return start
        names = self.model.states
        given = checked_start(dict(start or {}), [*names, *(["phase"] if self.forced else [])])
        return np.array([given.get("phase", 0.0), *(given.get(name, 0.0) for name in names)])

    @property
    def state(self) -> np.ndarray:  # type: ignore[override]
        """Clock and states, shape (n + 1,), from which another simulation can continue."""
        return np.append(self.stepper.clock, self.stepper.state)

    def go_on(self, state: np.ndarray, nudge: float = 0.0) -> None:
        """Begin at the final state of another simulation, moved out of walls that have moved; `nudge` is added to the last state."""
        clock = (
            float(state[0]) if len(state) > self.model.size else 0.0
        )  # older files hold no clock for self-excited machines
        self.stepper.start(outside(self.stepper, state[-self.model.size :], clock), clock)
        self.stepper.state[-1] += nudge

    def begin(self, word: Word, node: np.ndarray) -> None:
        """Begin just after the first event of a cycle with this word, at the unknowns `node`."""
        self.stepper.start(node[1:], float(node[0]) if self.forced else 0.0, word.entries(0))

    def follow(self, until: float) -> None:
        """Move on to the time `until`."""
        follow(self.stepper, TWO_PI * until)

    def go_round(self, word: Word, periods: int, index: int | None = None) -> tuple[np.ndarray, np.ndarray]:
        """Move on by one period of a cycle, and return derivatives; NaN if a wall has held the body."""
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
        """Move on by `periods` or at most `most` events, and return the motion."""
        return collect(self.stepper, TWO_PI * periods, most)

    def struck(self, point: np.ndarray, near: float) -> tuple[np.ndarray, np.ndarray] | None:
        """Return the counterpart, across the impact, of a point at a wall, and the direction away from the wall; None elsewhere.

        Only for points of a forced machine at phase zero: points of a self-excited machine are taken just after events.
        """
        if not self.forced:
            return None
        machine, state = self.model, np.array(point, dtype=float)
        compiled = machine.compiled
        numbers = compiled.numbers(self.params, machine.rest_mode(self.params, state, 0.0))
        gaps = compiled.contact_values().one(state, 0.0, numbers)
        for j in machine.equations.gap:
            slopes = compiled.gap_slopes(j).one(state, 0.0, numbers)
            steep = float(np.linalg.norm(slopes))
            if not abs(gaps[j]) < near * steep:
                continue
            state = state - gaps[j] * slopes / steep**2
            row = compiled.impact_map(j).one(state, 0.0, numbers)
            jump, rate = row[: machine.size] - state, row[machine.size]
            if (
                rate > 0.0
            ):  # just after an impact: the impulse back has the opposite sign and is larger by 1/restitution
                jump = jump / compiled.rebound(j).one(state, 0.0, numbers)[1]
            if rate != 0.0 and np.all(np.isfinite(jump)):
                return state + jump, slopes / steep
        return None

    # ------------------------------------------------------------------ settling
    def skip(self, count: float) -> bool:
        """Move on by `count` forcing periods (self-excited: events); return whether that many happened."""
        stepper = self.stepper
        if self.forced:
            self.follow(self.time + int(count))
            return True
        return all(
            stepper.advance(stepper.base + stepper.clock + SIMULATING.wait) is not None
            for _ in range(int(count))
        )

    def look(self, longest: int) -> PageTrajectory:
        """Run for a little more than two of the longest recurrences (self-excited: as many events)."""
        if self.forced:
            return collect(self.stepper, TWO_PI * (2 * longest + 1), 50 * longest + 2000)
        return collect(self.stepper, SIMULATING.wait, min(2 * LONGEST_WORD, 50 * longest))

    def rests(self, run: PageTrajectory, last: bool) -> bool:
        """Return whether a wall holds the body, or a self-excited machine has stopped moving."""
        if len(run):
            return False
        if run.held or self.forced:
            return run.held
        clocks, place = np.linspace(0.0, TWO_PI, LATE), np.zeros(LATE, dtype=int)
        states = flown(self.model, self.params, run.modes[-1:], run.last[None], clocks[:1], place, clocks)
        size = 1.0 + np.abs(states).max(axis=0)
        return bool((np.ptp(states, axis=0) <= self.waiting.returned * size).all())

    def push(self) -> None:
        """Do nothing: a body that sticks must not be moved, and leaves unstable motions by itself."""

    def growth(self) -> tuple[float, float]:
        """Return the largest Lyapunov exponent and its error; see `orbits.flows.page.variations.growth`."""
        return growth(self.stepper)

    def section(self) -> tuple[str, np.ndarray]:
        """Move on to the next whole forcing period (self-excited: the next event)."""
        if self.forced:
            return super().section()
        event = self.stepper.advance(self.stepper.base + self.stepper.clock + SIMULATING.wait)
        return "" if event is None else letter_of(self.model, event), self.point

    # ------------------------------------------------------------------ many starts
    def box(self) -> np.ndarray:
        """Return the machine file's box of starts; for other states, twice the reach of the motion from rest in sixty periods."""
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
        if largest < SIMULATING.resting * room:  # the machine stays at rest
            return np.full(self.model.size, room)
        return np.maximum(reach, 0.1 * largest if largest > 0.0 else 1.0)

    def _room(self) -> float:
        """Return the widest gap of a wall at the present state; 0 without walls."""
        values = self.stepper.contact_values()
        return max((float(values[j]) for j in self.model.equations.gap), default=0.0)

    def free(self, points: np.ndarray) -> np.ndarray:
        """Return which starts have no negative gaps, bool array (m,)."""
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
