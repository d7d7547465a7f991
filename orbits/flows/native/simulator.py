"""Simulator of the built-in machines (`orbits.flows.protocol.Simulator`), which uses the native core's stepper or its reference."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping, Sequence

import numpy as np

from orbits.flows.native.batches import GROWTH, lyapunov, settle_all
from orbits.flows.native.trajectory import KINDS, NativeTrajectory
from orbits.flows.protocol import Batch, SimulationError, Simulator, Waiting, checked_start
from orbits.flows.trajectory import TWO_PI
from orbits.machines.base import Model
from orbits.machines.native_stepper import stepper
from orbits.machines.stepping import (
    EVENTS_FULL,
    FAILED,
    HOLD,
    MODE,
    PSI,
    RATE,
    REST,
    TURNS,
    V_RATE,
    Stepper,
    V,
    W,
    buffers,
)
from orbits.settings import EVENTS, REPLAYING, SIMULATING
from orbits.words import Word

FIRST, CHUNK = 256, 16384  # events in the first and in every further buffer of a run
ROOM = 1024  # events in the buffer of a run that keeps none
MOST_EVENTS = 1_000_000
_KEYS = {"phase": PSI, "w": W, "w_rate": RATE, "v": V, "v_rate": V_RATE}
_BODIES = ("q1", "q2", "q1_rate", "q2_rate")
PER_PERIOD = 400  # largest number of events per forcing period
SPEEDS = (
    2.5  # box of starts: largest relative velocity over the cavity's largest velocity (or over 1, if larger)
)
TRANSIENTS = (
    40.0,
    160.0,
    640.0,
    2560.0,
)  # forcing periods left out for many starts, one after another for the motions that have not recurred
LOOKS = 40  # searches for a recurrence in a prolonged run; motions that have recurred are followed no further
FOREVER = 1_000_000.0  # longest run, in forcing periods; only a motion away from the walls lasts so long without events


class NativeSimulator(Simulator[Model, NativeTrajectory]):
    """Moves one motion of a built-in machine on; see `orbits.flows.protocol.Simulator`.

    Attributes
    ----------
    state : float array (S,)
        State of the stepper; layout in `orbits.machines.stepping`.
    """

    forced = True
    watched = (2000.0, 800_000)
    waiting = Waiting(
        300.0, 2, 2, 4, SIMULATING.returned, 0, 200_000.0, np.inf
    )  # weakly damped motions settle late
    observed, modulated = (4096.0, 16384.0), 512.0
    resting, wandering = "stuck", "chaotic"
    count = 0.0

    def __init__(self, model: Model, params: np.ndarray) -> None:
        self.model, self.params = model, np.asarray(params, dtype=float)
        self.engine = stepper(model.name)
        self.state = np.zeros(self.engine.state)
        self._places = list(self.engine.places)
        self.names = self.engine.coordinates
        self.roomy = self.engine.moving_cavity  # two frequencies need four dimensions
        self.hard = np.arange(len(self._places)) == 0

    @property
    def modes(self) -> int:
        """Mode of the friction."""
        return int(self.state[MODE])

    @property
    def time(self) -> float:
        """Time in forcing periods."""
        return float(self.state[TURNS]) + float(self.state[PSI]) / (2.0 * np.pi)

    @property
    def point(self) -> np.ndarray:
        """Present coordinates."""
        return self.state[self._places]

    def start(self, point: np.ndarray, time: float = 0.0, modes: tuple[int, ...] | None = None) -> None:
        """Begin at a point; the mode of the friction follows from it."""
        self.state = np.zeros(self.engine.state)
        self.state[PSI] = 2.0 * np.pi * time
        self.state[self._places] = point
        _check(self.state, self.engine.walls(self.params))
        self.engine.launch(self.state, self.params)

    def put(self, start: Mapping[str, float] | np.ndarray | None) -> None:
        """Begin at a start by names, or at a state."""
        self.state = self.state_of(start)

    def state_of(self, start: Mapping[str, float] | np.ndarray | None) -> np.ndarray:
        """Return the state of a start."""
        return first_state(self.model, self.engine, self.params, start)

    def go_on(self, state: np.ndarray, nudge: float = 0.0) -> None:
        """Begin at the final state of another simulation; `nudge` is added to the speed."""
        self.state = state.copy()
        if nudge and self.state[MODE] != 0.0:
            self.state[RATE] += nudge * np.sign(self.state[MODE])
        self.engine.launch(self.state, self.params)

    def begin(self, word: Word, node: np.ndarray) -> None:
        """Begin just after the first event of a cycle with this word, at the unknowns `node`."""
        self.state = self.engine.state_of(self.params, int(word.codes[0]), int(word.mode_codes[0]), node)
        left, right = self.engine.walls(self.params)
        self.state[W] = min(
            max(self.state[W], right), left
        )  # a cycle at other parameters may lie inside a wall

    def follow(self, until: float) -> None:
        """Move on to the time `until`.

        Raises
        ------
        SimulationError
            If the motion is not finite, or comes to rest for ever.
        """
        most = int(PER_PERIOD * max(until - self.time + 1.0, 1.0))
        status = skip(self.engine, self.state, self.params, until, most)
        if status == FAILED or not abs(self.time - until) < SIMULATING.whole_period:
            raise SimulationError(
                f"the motion of {self.model.name!r} does not go on to {until:g} forcing periods"
            )

    def run(self, periods: float, most: int = MOST_EVENTS) -> NativeTrajectory:
        """Move on by `periods` or at most `most` events, and return the motion.

        Raises
        ------
        SimulationError
            If the motion leaves the range of numbers.
        """
        begin, state = self.state.copy(), self.state
        until = self.time + min(periods, FOREVER)
        codes, modes, rows, status = collect(self.engine, state, self.params, until, most)
        if status == FAILED:
            raise SimulationError(
                f"the motion of {self.model.name!r} left the range of numbers: give parameters and a start of moderate size"
            )
        walls = self.engine.walls(self.params)
        if begin[MODE] == 0.0 and begin[W] not in walls and self.model.frictionless(self.params):
            # without friction nothing rests away from the walls, not even at an instant without force
            begin[MODE] = 1.0
        clocks = np.append(_clock(begin), rows[:, 0] + TWO_PI * rows[:, 1])
        ends = float(_clock(state)), KINDS[codes], status, self.engine, begin, state.copy()
        return NativeTrajectory(self.model, self.params, clocks, *ends, codes, modes, rows)

    def struck(self, point: np.ndarray, near: float) -> tuple[np.ndarray, np.ndarray] | None:
        """Return the counterpart, across the impact, of a point at a wall, and the direction away from the wall; None elsewhere."""
        walls, restitutions = self.engine.walls(self.params), self.model.restitutions(self.params)
        for wall, side, r in zip(walls, (1.0, -1.0), map(float, restitutions)):
            if abs(point[0] - wall) < near and point[1] != 0.0:
                other, away = np.array(point, dtype=float), np.zeros(len(point))
                other[0], other[1] = wall, -point[1] * r if side * point[1] > 0.0 else -point[1] / r
                away[0] = -side
                return (other, away) if np.all(np.isfinite(other)) else None
        return None

    # ------------------------------------------------------------------ settling
    def skip(self, count: float) -> bool:
        """Move on by `count` forcing periods without keeping events."""
        until = self.state[TURNS] + count
        status = skip(self.engine, self.state, self.params, until, int(PER_PERIOD * (count + 1.0)))
        if status == FAILED:
            raise SimulationError(
                f"the motion of {self.model.name!r} is not finite: give parameters of moderate size"
            )
        return True

    def look(self, longest: int) -> NativeTrajectory:
        """Run for a little more than two of the longest recurrences."""
        length = 2.0 * longest + 1.0
        return self.run(length, int(PER_PERIOD * length))

    def rests(self, run: NativeTrajectory, last: bool) -> bool | None:
        """Return whether the absorber sticks for good; None while an oscillator may still grow, or is between two beats."""
        begin = run.start
        if run.status != REST and (len(run) or begin[RATE] != 0.0 or begin[MODE] != 0.0):
            return False
        if last:
            self._oscillator_settles()
            return True
        rest = self.model.rest
        slips = rest.reserve(self.params, rest.solved(self.params)) <= -SIMULATING.may_hold
        return None if slips or not self._oscillator_settles() else True

    def _oscillator_settles(self) -> bool:
        """Follow the stuck absorber until its oscillator has settled; return False if it slips before."""
        if not self.engine.moving_cavity:
            return True  # the motion of the cavity is prescribed
        state, length = self.state, 64.0
        while state[TURNS] < self.waiting.slow:
            before = state.copy()
            skip(self.engine, state, self.params, self.time + length, 1)
            if state[MODE] != 0.0:
                return False
            if not np.abs(state[V:] - before[V:]).max() > SIMULATING.settled * np.abs(state[V:]).max():
                break
            length *= 2.0
        return True

    def move_on(self, run: NativeTrajectory, longest: int) -> bool:
        """Move a motion that creeps along the cavity close to a wall; return whether it was moved."""
        if self.engine.moving_cavity or not len(run):
            return False
        steps = creep(run.nodes, run.codes, run.modes, longest)
        if steps is None:
            return False
        left, right = self.engine.walls(self.params)
        places, drift = (
            run.nodes[-len(steps) :, 1],
            float(steps[-1]),
        )  # the extreme positions are turns and sticks
        room = left - places.max() if drift > 0.0 else right - places.min()
        times = math.floor(room / drift) - 1
        if times < 1:
            return False
        self.state[W] += times * drift
        return True

    def push(self) -> None:
        """Change the velocity a little."""
        self.state[RATE] *= 1.0 + REPLAYING.displaced

    def growth(self) -> tuple[float, float]:
        """Return the largest Lyapunov exponent and its error; see `orbits.flows.native.batches.lyapunov`."""
        return lyapunov(self.model.name, self.state, self.params)

    # ------------------------------------------------------------------ many starts
    def box(self) -> np.ndarray:
        """Return the box of starts: positions in the cavity, and velocities in proportion to those of the walls."""
        model, names = self.model, self.model.parameter_names
        shaking = 1.0  # largest velocity of the cavity's centre under the excitation; 1 if it cannot be computed in advance
        if "amplitude" in names:
            shaking = float(self.params[names.index("amplitude")] * model.phase_speed(self.params))
        left, right = (float(wall) for wall in self.engine.walls(self.params))
        rate, reach = SPEEDS * max(1.0, shaking), 2.0 * max(1.0, shaking)
        rows = [[0.0, 2.0 * math.pi], [right, left], [-rate, rate], [-reach, reach], [-reach, reach]]
        return np.array(rows[: 1 + len(self._places)])

    def settle_all(self, points: np.ndarray, longest: int, workers: int | None) -> Batch:
        """Run all starts until they recur; see `orbits.flows.native.batches.settle_all`."""
        states = np.zeros((len(points), self.engine.state))
        states[:, [PSI, *self._places]] = points
        return self._settled(states, TRANSIENTS, longest, workers)

    def settle_longer(
        self, batch: Batch, chosen: np.ndarray, longest: int, periods: float, workers: int | None
    ) -> None:
        """Run the motions `chosen` of a batch, which have not recurred, for up to `periods` more."""
        more = self._settled(batch.states[chosen], [periods / LOOKS] * LOOKS, longest, workers)
        for earlier, new in zip(batch[:6], more[:6]):
            earlier[chosen] = new

    def _settled(
        self, states: np.ndarray, transients: Sequence[float], longest: int, workers: int | None
    ) -> Batch:
        found = settle_all(
            self.model.name,
            states,
            self.params,
            transients=transients,
            longest=longest,
            tolerance=SIMULATING.returned_many,
            workers=workers or cores(),
        )
        columns = found["outcome"], found["periods"], found["gaps"]
        return Batch(*columns, states, states[:, self._places], states[:, TURNS].copy(), 2.0 * GROWTH)


def cores() -> int:
    """Return the number of processors that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _clock(state: np.ndarray) -> float:
    return state[PSI] + TWO_PI * state[TURNS]


def first_state(
    model: Model, engine: Stepper, params: np.ndarray, start: Mapping[str, float] | np.ndarray | None
) -> np.ndarray:
    """Return the state, shape (S,), of a start given by names or as a state.

    Raises
    ------
    SimulationError
        If the start is impossible.
    """
    state = np.zeros(engine.state)
    if isinstance(start, np.ndarray):
        if start.shape != state.shape:
            raise SimulationError(
                f"the start has shape {start.shape}: a state of {model.name!r} has {state.shape}"
            )
        state[:] = start
        _check(state, engine.walls(params))
        return state
    given = dict(start or {})
    allowed = [key for key, place in _KEYS.items() if place < engine.state]
    if engine.moving_cavity:
        allowed += _BODIES
        if any(key in given for key in _BODIES):
            q1, q2, q1_rate, q2_rate = (float(given.pop(key, 0.0)) for key in _BODIES)
            w, v = model.relative(q1, q2, params)
            w_rate, v_rate = model.relative(q1_rate, q2_rate, params)
            given = {"w": w, "w_rate": w_rate, "v": float(v), "v_rate": float(v_rate)} | given
    for key, value in checked_start(given, allowed).items():
        state[_KEYS[key]] = value
    _check(state, engine.walls(params))
    engine.launch(state, params)
    return state


def _check(state: np.ndarray, walls: tuple[float, float]) -> None:
    if not np.all(np.isfinite(state)):
        raise SimulationError("the start is not finite: give numbers for phase, w and w_rate")
    left, right = walls
    rounding = 16.0 * np.finfo(float).eps * (left - right)  # for a motion that begins at a wall
    if not right - rounding <= state[W] <= left + rounding:
        raise SimulationError(f"w = {state[W]:g} lies outside the cavity: give {right:g} <= w <= {left:g}")
    state[W] = min(max(state[W], right), left)


def collect(
    engine: Stepper, state: np.ndarray, params: np.ndarray, until: float, most: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray, int]:
    """Run on from `state` (changed in place) for at most `most` events; return codes, modes, rows and the status."""
    parts = []
    status = EVENTS_FULL
    left = most
    while left > 0 and status == EVENTS_FULL:
        size = min(left, CHUNK if parts else FIRST)  # most runs are short
        codes, modes, rows = buffers(engine, size)
        count, status = engine.advance(state, params, until, codes, modes, rows)
        parts.append((codes[:count], modes[:count], rows[:count]))
        left -= count
    if len(parts) == 1:
        return (*parts[0], status)
    codes, modes, rows = (np.concatenate(column) for column in zip(*(parts or [buffers(engine, 0)])))
    return codes, modes, rows, status


def skip(engine: Stepper, state: np.ndarray, params: np.ndarray, until: float, most: int) -> int:
    """Run on from `state` (changed in place) without keeping events; return the status."""
    room, status = buffers(engine, ROOM), EVENTS_FULL
    while most > 0 and status == EVENTS_FULL:
        count, status = engine.advance(state, params, until, *room)
        most -= count
    return status


def creep(nodes: np.ndarray, codes: np.ndarray, modes: np.ndarray, max_period: int) -> np.ndarray | None:
    """Return the displacements of the last recurrence's events since the one before, shape (events of a recurrence,); None without creep.

    A motion without impacts creeps if it recurs after some periods except for a small displacement along the cavity. This happens if
    friction holds less in one direction than in the other (on a slope, for example): the absorber slips a little further in every period.
    As long as the cavity moves as prescribed, all places between the walls are equivalent and each displacement is the same. So the motion may
    be moved on by as many displacements as there is space for: the attractor is decided only at the wall.

    Parameters
    ----------
    nodes : ndarray, shape (n, NODE)
        Nodes of a motion, phases counted through.
    codes, modes : ndarray of int, shape (n,)
    max_period : int
        Longest recurrence, in forcing periods.
    """
    n = len(codes)
    if n < 2 or codes.min() < 2 or codes.max() >= HOLD:
        return None
    for length in range(1, n // 2 + 1):
        latest, before = slice(n - length, n), slice(n - 2 * length, n - length)
        if not (
            np.array_equal(codes[latest], codes[before]) and np.array_equal(modes[latest], modes[before])
        ):
            continue
        shift = nodes[latest, :2] - nodes[before, :2]
        periods = round(float(shift[-1, 0]) / TWO_PI)
        if periods > max_period:
            return None
        drift = float(shift[-1, 1])
        late = np.abs(shift[:, 0] - TWO_PI * periods).max()
        uneven = np.abs(shift[:, 1] - drift).max()
        if periods and abs(drift) > EVENTS.zero and max(late, uneven) < SIMULATING.steady * abs(drift):
            return shift[:, 1]
    return None
