"""Starts of a built-in machine: where they are drawn, and what they settle on, all at once."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from contvines.shared.near_names import no_parameter
from orbits.attractors.attractor import Attractor
from orbits.attractors.batches import AT_REST, LOST, SETTLED, WANDERING, lyapunov, settle_all
from orbits.attractors.motion import RARE, SOLVED, Motion, wandering
from orbits.attractors.recurrence import recurring, settle
from orbits.flows.protocol import Record, SimulationError
from orbits.machines.catalogue import stepper as machine
from orbits.machines.notation import STARTS
from orbits.machines.stepping import MODE, PSI, RATE, TURNS, V, W
from orbits.orbit import Orbit
from orbits.population.sorting import Sorting
from orbits.simulation.driver import skip
from orbits.simulation.native import NativeSimulator

if TYPE_CHECKING:
    from orbits.machines.base import Model

TRANSIENTS = (40.0, 160.0, 640.0, 2560.0)  # forcing periods, each for those that do not recur before
LONGEST = 24  # forcing periods of the longest recurrence looked for
EMBEDDED = 6  # forcing periods of the longest unstable cycle looked for
TOLERANCE = 1e-8  # difference of two states that counts as a return
PATIENCE = 3  # times at most a motion that does not recur is looked at again
ENOUGH = 20_000.0  # forcing periods that chaotic motions, all those alike together, have not ended in
LATE = 3000.0  # forcing periods between two such looks
GROWTH = 4000  # forcing periods over which the growth of small differences is followed
RECOGNISED = 1e-7  # difference of two nodes that counts as a return of a single motion
CLOSED = 1e-8  # largest residual of a cycle
NEAR = 1e-3  # a settled state lies so near to the solved motion that it belongs to
BRIEF = (5, 48)  # values, and starts at each, of a brief look
SPEEDS = 2.5  # a box of starts: relative velocities up to so many times the cavity's, and at least this


class NativeStarts:
    """What `orbits.population.population.Population` asks of a built-in machine's starts."""

    across = 200
    brief = BRIEF
    price = 1.0
    longest = EMBEDDED
    notation = STARTS
    leftward = "w"  # w = +1 is the left wall, and stands on the left

    def __init__(self, model: Model, parameter: str, parameters: Mapping[str, float]) -> None:
        if parameter not in model.amount_names:
            names = model.amount_names
            raise SimulationError(no_parameter(repr(parameter), f"the model {model.name!r}", names))
        self.model, self.parameter, self.parameters = model, parameter, parameters
        self.engine = machine(model.name)
        self.names = ("phase", *self.engine.coordinates)
        self.gauges = model.gauges

    def vector(self, p: float) -> np.ndarray:
        """The parameter vector."""
        return self.model.vector_at(self.parameter, p, self.parameters)

    def box(self, p: float) -> np.ndarray:
        """The cavity, and the velocities its walls can give."""
        params = self.vector(p)
        shaking = self._shaking(params)
        left, right = (float(wall) for wall in self.model.walls(params))
        rate = SPEEDS * max(1.0, shaking)
        rows = [[0.0, 2.0 * np.pi], [right, left], [-rate, rate]]
        if self.model.moving_cavity:
            reach = 2.0 * max(1.0, shaking)
            rows += [[-reach, reach], [-reach, reach]]
        return np.array(rows)

    def _shaking(self, params: np.ndarray) -> float:
        """Largest velocity of the cavity's centre that the excitation gives, as far as it is known beforehand."""
        names = self.model.parameter_names
        if "amplitude" in names:
            return float(params[names.index("amplitude")] * params[names.index("frequency")])
        return 1.0

    def free(self, points: np.ndarray, params: np.ndarray) -> np.ndarray:
        """The box lies between the walls."""
        return np.ones(len(points), dtype=bool)

    def simulator(self, params: np.ndarray, state: np.ndarray | None = None) -> NativeSimulator:
        """A simulator, on a motion if a state of it is given."""
        simulator = NativeSimulator(self.model, params)
        if state is not None:
            simulator.state = state.copy()
            simulator.state[TURNS] = 0.0
        return simulator

    def solver(self, params: np.ndarray, wide: bool = False) -> Callable[[Record, int, int, int], Any]:
        """What makes a cycle of a piece of a record."""

        def solve(record: Record, first: int, last: int, periods: int):
            codes, modes, rows = (part[first:last] for part in record.source)
            if not np.any(codes < 2):
                return None
            found = recurring(self.model, self.engine, params, codes, modes, rows, periods)
            return found.orbit.root() if found.residual < CLOSED and found.word is not None else None

        return solve

    def closed(self, params: np.ndarray) -> Iterable[Any]:
        """The orbits known in closed form."""
        from orbits.starts.closed import closed_orbits

        return closed_orbits(self.model, params, Orbit)

    def observed(self, state: np.ndarray, p: float) -> dict[str, float]:
        """Measures of the motion through a state."""
        from orbits.attractors.search import described

        params = self.vector(p)
        found = settle(self.model, self.engine, params, state.copy(), 0.0, LONGEST, patience=0)
        return described(found)[1]

    def fleet(self, points: np.ndarray, params: np.ndarray, workers: int | None) -> NativeFleet:
        """Starts under way."""
        return NativeFleet(self.model, params, points, workers or cores())


def cores() -> int:
    """Processors that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


class NativeFleet:
    """Starts of a built-in machine, run all at once until they recur."""

    def __init__(self, model: Model, params: np.ndarray, points: np.ndarray, workers: int) -> None:
        self.model, self.params, self.engine = model, params, machine(model.name)
        self.states = np.zeros((len(points), self.engine.state))
        self.states[:, [PSI, *self.engine.places]] = points
        self.result = settle_all(
            model.name,
            self.states,
            params,
            transients=TRANSIENTS,
            longest=LONGEST,
            tolerance=TOLERANCE,
            workers=workers,
        )
        self.work = float(self.states[:, TURNS].sum())
        self.images: dict[
            int, tuple[np.ndarray, np.ndarray, bool]
        ] = {}  # of each motion: states, mirrored ones, free mean

    def sort(self, i: int, sorting: Sorting) -> None:
        """Which motion start number i reaches, and with it all others whose states lie on that."""
        outcome = self.result["outcome"]
        if outcome[i] == AT_REST:
            rest = self._rest()
            _, problem, u = sorting.known(rest, "stuck", 1)
            k = sorting.add(rest, Motion("stuck", "", 1, problem, u))
            sorting.assign(outcome == AT_REST, k)
        elif outcome[i] == LOST:
            sorting.plain(outcome == LOST, "escaped")
        elif outcome[i] == SETTLED:
            self._add(self._looked_at(self.states[i].copy(), 8.0, LONGEST, 1), i, sorting)
        else:
            self._unsettled(i, sorting)

    def _rest(self):
        orbit = Orbit.at_rest(self.model, self.params)
        return orbit if orbit.real else None

    def _looked_at(self, state: np.ndarray, transient: float, longest: int, patience: int) -> Attractor:
        """What a motion settles on; its work is counted."""
        found = settle(self.model, self.engine, self.params, state, transient, longest, RECOGNISED, patience)
        self.work += float(state[TURNS]) + SOLVED
        return found

    def _unsettled(self, i: int, sorting: Sorting) -> None:
        """A motion that does not recur, judged by its growth of small differences; where it may still recur it is looked at again.

        A chaotic transient ends at a rate that does not depend on its age (T. Tel and Y.-C. Lai, Transient Chaos, 2011): that many motions have
        not ended together tells as much as that one has not in as many times the periods.
        """
        state = self.states[i].copy()
        others = (sorting.index < 0) & (self.result["outcome"] == WANDERING)
        others &= np.arange(len(others)) >= i
        gaps = self.result["gaps"]
        alike = others & (np.abs(np.log10(np.maximum(gaps, 1e-300) / max(gaps[i], 1e-300))) < 1.5)
        alike[i] = True
        kind, exponent, error = self._grown(state)
        followed = np.count_nonzero(alike) * sum(TRANSIENTS)
        for _ in range(PATIENCE):
            if kind == "chaotic" and followed >= ENOUGH:
                break
            found = self._looked_at(state, 200.0, LONGEST, 2)
            if found.recurrent:
                return self._add(found, i, sorting)
            skip(self.engine, state, self.params, state[TURNS] + LATE, 10**9)
            self.work += LATE
            followed += state[TURNS]
        if kind != "chaotic":  # now that it is nearer to what it settles on
            kind, exponent, error = self._grown(state)
        if kind == "slow":  # neighbours come together: it may recur, but late
            found = self._looked_at(state, 0.0, RARE, 1)
            if found.recurrent:
                return self._add(found, i, sorting)
        sorting.plain(alike, kind, exponent=exponent, error=error, state=self.states[i].copy())
        return None

    def _grown(self, state: np.ndarray) -> tuple[str, float, float]:
        """Kind of a motion that does not recur, its Lyapunov exponent per forcing period and the error of that."""
        exponent, error = lyapunov(self.model.name, state, self.params, GROWTH)
        self.work += 2.0 * GROWTH
        # two frequencies need four dimensions
        return wandering(exponent, error, self.model.moving_cavity), exponent, error

    def _add(self, found: Attractor, i: int, sorting: Sorting) -> None:
        """Put an attractor on the list, unless it is there, and give it all starts whose states lie on it."""
        own, image, free = self._on(found)
        here = self._members(own, image, free, found.periods) & (sorting.index < 0)
        here[i] = True
        orbit, word = None, found.text
        if found.kind == "stuck":
            orbit = self._rest()
        elif found.word is not None and len(found.codes):
            orbit = found.orbit.root()
            word = orbit.spelling
        k, problem, u = sorting.known(orbit, found.kind, found.periods)
        if k < 0:
            motion = Motion(found.kind, word, found.periods, problem, u, state=found.state.copy())
            k = sorting.add(orbit, motion)
            self.images[k] = own, image, free
        own, image, free = self.images.get(k, (own, image, free))
        nearer = False if found.symmetric else self._distances(image, free) < self._distances(own, free)
        sorting.assign(here, k, nearer)

    def _on(self, found: Attractor) -> tuple[np.ndarray, np.ndarray, bool]:
        """States of the attractor at whole forcing periods, of its mirror image, and whether its mean is free."""
        state = found.state.copy()
        now = np.floor(state[TURNS] + state[PSI] / (2.0 * np.pi)) + 1.0
        skip(self.engine, state, self.params, now, 100_000)
        whole, half = [], []
        for k in range(max(found.periods, 1)):
            whole.append(self._vector(state))
            skip(self.engine, state, self.params, now + k + 0.5, 100_000)
            image = -self._vector(state)
            image[0] += 2.0 * float(self.model.middle(self.params))
            half.append(image)
            skip(self.engine, state, self.params, now + k + 1.0, 100_000)
        mirror = np.array(half) if self.model.has_mirror(self.params) else np.empty((0, len(whole[0])))
        return np.array(whole), mirror, found.impacts == 0

    def _vector(self, states: np.ndarray) -> np.ndarray:
        """w, w', mode, and v, v' of states (..., S)."""
        places = [W, RATE, MODE, *range(V, self.engine.state)]
        return states[..., places]

    def _distances(self, images: np.ndarray, free: bool) -> np.ndarray:
        """Of every settled state to the nearest of some states, shape (n,)."""
        if not len(images):
            return np.full(len(self.states), np.inf)
        gaps = np.abs(self._vector(self.states)[:, None, :] - images[None, :, :])
        if free:
            gaps[..., 0] = 0.0  # a motion without impacts may lie anywhere between the walls
        return gaps.max(axis=2).min(axis=1)

    def _members(self, own: np.ndarray, image: np.ndarray, free: bool, periods: int) -> np.ndarray:
        near = np.minimum(self._distances(own, free), self._distances(image, free)) < NEAR
        recurs = (self.result["outcome"] == SETTLED) & (self.result["periods"] == max(periods, 1))
        if periods > LONGEST:
            recurs = self.result["outcome"] == WANDERING
        return near & recurs
