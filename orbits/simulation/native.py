"""A built-in machine's motion on its way: the simulator (`orbits.flows.protocol`) round the native core's stepper or its reference."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from orbits.flows.protocol import Record, SimulationError
from orbits.machines.catalogue import stepper
from orbits.machines.states import event_states, state_of
from orbits.machines.stepping import FAILED, HOLD, MODE, PSI, RATE, TURNS, W
from orbits.simulation.driver import MOST_EVENTS, buffers, collect, first_state, skip
from orbits.simulation.trajectory import LETTERS, Trajectory

if TYPE_CHECKING:
    from orbits.machines.base import Model
    from orbits.words import Word

PER_PERIOD = 400  # events
FOREVER = 1e6  # periods: only a motion that keeps off the walls lasts so long without events


class NativeSimulator:
    """See the contract at the top of `orbits.flows.protocol`.

    Attributes
    ----------
    state : float array (S,)
        As `orbits.machines.stepping` has it.
    """

    forced = True
    watched = (2000.0, 800_000)

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
        self.state = state_of(self.engine, self.params, int(word.codes[0]), int(word.mode_codes[0]), node)
        left, right = self.engine.walls(self.params)
        self.state[W] = min(
            max(self.state[W], right), left
        )  # of a cycle of other parameters it may lie within a wall

    def follow(self, until: float) -> None:
        """Move on; `SimulationError` if the motion is not finite or comes to rest for ever."""
        most = int(PER_PERIOD * max(until - self.time + 1.0, 1.0))
        status = skip(self.engine, self.state, self.params, until, most, self._scratch)
        if status == FAILED or not abs(self.time - until) < 1e-9:
            raise SimulationError(
                f"the motion of {self.model.name!r} does not go on to {until:g} forcing periods"
            )

    def go_round(self, word: Word, periods: int, index: int | None = None) -> tuple[np.ndarray, np.ndarray]:
        """Move on by a period of a cycle, without derivatives."""
        self.follow(self.time + periods)
        n = len(self._places)
        return np.full((n, n), np.nan), np.full(n, np.nan)

    def run(self, periods: float, most: int = MOST_EVENTS) -> Trajectory:
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
        return Trajectory(
            self.model, self.params, self.engine, begin, state.copy(), codes, modes, rows, status
        )

    def record(self, until: float, most: int) -> Record:
        """Move on and list the events."""
        codes, modes, rows, _ = collect(self.engine, self.state, self.params, until, most)
        states = event_states(self.engine, modes, rows)
        return Record(
            states[:, TURNS] + states[:, PSI] / (2.0 * np.pi),
            states[:, self._places],
            [*zip(map(LETTERS.__getitem__, codes.tolist()), modes.tolist())],
            codes < 2,
            codes == HOLD,
            bool(abs(self.time - until) < 1e-9),
            (codes, modes, rows),
        )

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
