"""A built-in machine's motion on its way: the simulator (`orbits.flows.protocol`) round the native core's stepper or its reference."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from orbits.flows.protocol import Batch, SimulationError, Waiting
from orbits.machines.native_stepper import stepper
from orbits.machines.stepping import FAILED, MODE, PSI, RATE, REST, TURNS, V, W
from orbits.settings import REPLAYING, SIMULATING
from orbits.simulation.batches import GROWTH, lyapunov, settle_all
from orbits.simulation.creeping import move_on
from orbits.simulation.driver import MOST_EVENTS, buffers, collect, first_state, skip
from orbits.simulation.native_trajectory import NativeTrajectory

if TYPE_CHECKING:
    from orbits.machines.base import Model
    from orbits.words import Word

PER_PERIOD = 400  # events
SPEEDS = 2.5  # a box of starts: relative velocities up to so many times the cavity's, and at least this
TRANSIENTS = (
    40.0,
    160.0,
    640.0,
    2560.0,
)  # forcing periods of many starts, each for those that do not recur before
FOREVER = 1_000_000.0  # periods: only a motion that keeps off the walls lasts so long without events


class NativeSimulator:
    """See the contract at the top of `orbits.flows.protocol`.

    Attributes
    ----------
    state : float array (S,)
        As `orbits.machines.stepping` has it.
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
        self._scratch = buffers(self.engine, 64)

    @property
    def names(self) -> tuple[str, ...]:
        """Position and velocity in the cavity, then those of the centre of mass."""
        return self.engine.coordinates

    @property
    def mirrored(self) -> bool:
        """Whether the machine equals its mirror image."""
        return self.model.has_mirror(self.params)

    def image(self, point: np.ndarray) -> np.ndarray:
        """A point mirrored about the middle between the walls."""
        image = -point
        image[0] += 2.0 * float(self.model.middle(self.params))
        return image

    @property
    def modes(self) -> int:
        """What the friction does."""
        return int(self.state[MODE])

    @property
    def roomy(self) -> bool:
        """Two frequencies need four dimensions."""
        return self.model.moving_cavity

    @property
    def hard(self) -> np.ndarray:
        """The walls limit the position in the cavity."""
        return np.arange(len(self._places)) == 0

    @property
    def time(self) -> float:
        """Forcing periods."""
        return float(self.state[TURNS]) + float(self.state[PSI]) / (2.0 * np.pi)

    @property
    def point(self) -> np.ndarray:
        """The coordinates."""
        return self.state[self._places]

    def start(self, point: np.ndarray, time: float = 0.0, modes: tuple[int, ...] | None = None) -> None:
        """Begin at a point; the mode follows from it."""
        self.state = np.zeros(self.engine.state)
        self.state[PSI] = 2.0 * np.pi * time
        self.state[self._places] = point
        left, right = self.engine.walls(self.params)
        if not right <= self.state[W] <= left:
            raise SimulationError(
                f"w = {self.state[W]:g} lies outside the cavity: give {right:g} <= w <= {left:g}"
            )
        self.engine.launch(self.state, self.params)

    def put(self, start: Mapping[str, float] | np.ndarray | None) -> None:
        """Begin at a start by names, or at a state."""
        self.state = self.state_of(start)

    def state_of(self, start: Mapping[str, float] | np.ndarray | None) -> np.ndarray:
        """The state of a start."""
        return first_state(self.model, self.engine, self.params, start)

    def go_on(self, state: np.ndarray, nudge: float = 0.0) -> None:
        """Begin where another simulation has ended, its velocity changed a little."""
        self.state = state.copy()
        if nudge and self.state[MODE] != 0.0:
            self.state[RATE] += nudge * np.sign(self.state[MODE])
        self.engine.launch(self.state, self.params)

    def begin(self, word: Word, node: np.ndarray) -> None:
        """Just after the first event of a cycle."""
        self.state = self.engine.state_of(self.params, int(word.codes[0]), int(word.mode_codes[0]), node)
        left, right = self.engine.walls(self.params)
        self.state[W] = min(
            max(self.state[W], right), left
        )  # of a cycle of other parameters it may lie within a wall

    def follow(self, until: float) -> None:
        """Move on; `SimulationError` if the motion is not finite or comes to rest for ever."""
        most = int(PER_PERIOD * max(until - self.time + 1.0, 1.0))
        status = skip(self.engine, self.state, self.params, until, most, self._scratch)
        if status == FAILED or not abs(self.time - until) < SIMULATING.whole:
            raise SimulationError(
                f"the motion of {self.model.name!r} does not go on to {until:g} forcing periods"
            )

    def go_round(self, word: Word, periods: int, index: int | None = None) -> tuple[np.ndarray, np.ndarray]:
        """Move on by a period of a cycle, without derivatives."""
        self.follow(self.time + periods)
        n = len(self._places)
        return np.full((n, n), np.nan), np.full(n, np.nan)

    def run(self, periods: float, most: int = MOST_EVENTS) -> NativeTrajectory:
        """Move on and keep the motion; `SimulationError` if it leaves the range of numbers."""
        begin, state = self.state.copy(), self.state
        until = self.time + min(periods, FOREVER)
        codes, modes, rows, status = collect(self.engine, state, self.params, until, most)
        if status == FAILED:
            raise SimulationError(
                f"the motion of {self.model.name!r} left the range of numbers: give parameters and a start of moderate size"
            )
        walls = self.engine.walls(self.params)
        if begin[MODE] == 0.0 and begin[W] not in walls and self.model.frictionless(self.params):
            # off the walls nothing rests without friction, not even at the instant at which nothing pushes
            begin[MODE] = 1.0
        events = codes, modes, rows, status
        return NativeTrajectory.of(self.model, self.params, self.engine, begin, state.copy(), events)

    def struck(self, point: np.ndarray, near: float) -> tuple[np.ndarray, np.ndarray] | None:
        """Of a point at a wall the other one there and the direction away from the wall; None elsewhere."""
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
        """Move on by so many forcing periods."""
        until = self.state[TURNS] + count
        status = skip(self.engine, self.state, self.params, until, int(PER_PERIOD * (count + 1.0)))
        if status == FAILED:
            raise SimulationError(
                f"the motion of {self.model.name!r} is not finite: give parameters of moderate size"
            )
        return True

    def look(self, longest: int) -> NativeTrajectory:
        """Run on for two of the longest recurrences."""
        length = 2.0 * longest + 1.0
        return self.run(length, int(PER_PERIOD * length))

    def rests(self, run: NativeTrajectory, last: bool) -> bool | None:
        """Whether the absorber sticks for good; an oscillator may still be growing, or between two beats."""
        begin, rest = run.start, self.model.rest
        if run.status != REST and (len(run) or begin[RATE] != 0.0 or begin[MODE] != 0.0):
            return False
        if last:
            self._oscillator_settles()
            return True
        slips = rest.reserve(self.params, rest.solved(self.params)) <= -SIMULATING.held
        return None if slips or not self._oscillator_settles() else True

    def _oscillator_settles(self) -> bool:
        """Wait, with the absorber stuck, until its oscillator has settled; False if it slips meanwhile."""
        if not self.engine.moving_cavity:
            return True  # its cavity moves as prescribed
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
        """Move a motion that creeps along the cavity to a wall; see `orbits.simulation.creeping`."""
        if self.engine.moving_cavity or not len(run):
            return False
        return move_on(self.engine, self.params, self.state, run.nodes, run.codes, run.modes, longest)

    def push(self) -> None:
        """Change its velocity a little."""
        self.state[RATE] *= 1.0 + REPLAYING.displaced

    def growth(self) -> tuple[float, float]:
        """See `orbits.simulation.batches.lyapunov`."""
        return lyapunov(self.model.name, self.state, self.params)

    def section(self) -> tuple[str, np.ndarray]:
        """Move on to the next whole forcing period."""
        self.follow(math.floor(self.time) + 1.0)
        return "", self.point

    # ------------------------------------------------------------------ many starts
    def box(self) -> np.ndarray:
        """The cavity, and the velocities its walls can give."""
        model, names = self.model, self.model.parameter_names
        shaking = 1.0  # largest velocity of the cavity's centre that the excitation gives, as far as it is known beforehand
        if "amplitude" in names:
            shaking = float(self.params[names.index("amplitude")] * model.phase_speed(self.params))
        left, right = (float(wall) for wall in self.engine.walls(self.params))
        rate, reach = SPEEDS * max(1.0, shaking), 2.0 * max(1.0, shaking)
        rows = [[0.0, 2.0 * math.pi], [right, left], [-rate, rate], [-reach, reach], [-reach, reach]]
        return np.array(rows[: 1 + len(self._places)])

    def free(self, points: np.ndarray) -> np.ndarray:
        """The box lies between the walls."""
        return np.ones(len(points), dtype=bool)

    def settle_all(self, points: np.ndarray, longest: int, workers: int | None) -> Batch:
        """See `orbits.simulation.batches.settle_all`."""
        states = np.zeros((len(points), self.engine.state))
        states[:, [PSI, *self._places]] = points
        found = settle_all(
            self.model.name,
            states,
            self.params,
            transients=TRANSIENTS,
            longest=longest,
            tolerance=SIMULATING.returned_many,
            workers=workers or cores(),
        )
        work, followed = float(states[:, TURNS].sum()), sum(TRANSIENTS)
        columns = found["outcome"], found["periods"], found["gaps"]
        return Batch(*columns, states, states[:, self._places], work, followed, 2.0 * GROWTH)


def cores() -> int:
    """Processors that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
