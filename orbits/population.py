"""What many starts settle on: a machine's attractors at one value, each solved once, with the starts that reach it."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from contvines.shared.near_names import no_parameter
from orbits.attractors.attractor import Attractor
from orbits.attractors.batches import AT_REST, LOST, SETTLED, WANDERING, lyapunov, settle_all
from orbits.attractors.distinct import alike, distinct
from orbits.attractors.embedded import embedded_cycles
from orbits.attractors.low_discrepancy import low_discrepancy
from orbits.attractors.motion import RARE, SOLVED, Motion, wandering
from orbits.attractors.recurrence import recurring, settle
from orbits.attractors.returning import returning_cycles
from orbits.attractors.sweep import described
from orbits.flows.protocol import Record
from orbits.machines.notation import STARTS
from orbits.machines.stepping import MODE, PSI, RATE, TURNS, V, W
from orbits.orbit import Orbit
from orbits.simulation.driver import SimulationError, machine, skip
from orbits.simulation.native import NativeSimulator
from orbits.starts.closed import closed_orbits

TRANSIENTS = (40.0, 160.0, 640.0, 2560.0)  # forcing periods, each for those that do not recur before
LONGEST = 24  # forcing periods of the longest recurrence looked for
EMBEDDED = 6  # forcing periods of the longest unstable cycle looked for
TOLERANCE = 1e-8  # difference of two states that counts as a return
PATIENCE = 3  # times a motion that does not recur is looked at again
LATE = 3000.0  # forcing periods between two such looks
GROWTH = 4000  # forcing periods over which the growth of small differences is followed
RECOGNISED = 1e-7  # difference of two nodes that counts as a return of a single motion
CLOSED = 1e-8  # largest residual of a cycle
NEAR = 1e-3  # a settled state lies so near to the solved motion that it belongs to
BRIEF = (5, 48)  # values, and starts at each, of a brief look
SPEEDS = 2.5  # a box of starts: relative velocities up to so many times the cavity's, and at least this


class Population:
    """Starts of a machine and what they settle on, against one of its parameters.

    Parameters
    ----------
    model : Model
    parameter : str
        The one that varies.
    parameters : mapping
        All that are no fields of the machine, or replace them.
    workers : int, optional
        Threads; all cores by default. Results do not depend on it.

    Raises
    ------
    ValueError
        If the machine has no such parameter.
    """

    def __init__(
        self,
        model: Any,
        parameter: str,
        parameters: Mapping[str, float] | None = None,
        workers: int | None = None,
    ) -> None:
        if parameter not in model.amount_names:
            names = model.amount_names
            raise SimulationError(no_parameter(repr(parameter), f"the model {model.name!r}", names))
        self.model, self.parameter = model, parameter
        self.parameters = dict(parameters or {})
        self.workers = (
            workers or len(os.sched_getaffinity(0))
            if hasattr(os, "sched_getaffinity")
            else os.cpu_count() or 1
        )
        self.engine = machine(model.name)
        self.work = 0.0
        """Forcing periods simulated so far, those that solve for cycles included."""

    @property
    def about(self) -> dict[str, Any]:
        """The machine's name and settings."""
        return self.model.settings()

    notation = STARTS
    leftward = "w"  # w = +1 is the left wall, and stands on the left

    across = 200
    """Starts across and up in a picture of basins where no number is given."""

    @property
    def brief(self) -> tuple[int, int]:
        """Values, and starts at each, of a brief look."""
        return BRIEF

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the coordinates in which starts are given: phase, w, w_rate, and v, v_rate of the coupled machine."""
        return ("phase", *self.engine.coordinates)

    @property
    def units(self) -> dict[str, str]:
        """Units of parameters and measures by name; none where all are plain numbers."""
        return self.model.units

    def gauges(self, names: Sequence[str], p: float) -> dict[str, tuple[float, str]]:
        """What one of these coordinates is in the unit that is shown, and that unit; plain numbers have none."""
        params = self.model.vector_at(self.parameter, p, self.parameters)
        return self.model.gauges([name for name in names if name != "phase"], params)

    def box(self, p: float) -> np.ndarray:
        """Smallest and largest coordinate of the starts, shape (n, 2): the cavity, and the velocities its walls can give."""
        params = self.model.vector_at(self.parameter, p, self.parameters)
        shaking = self._shaking(params)
        left, right = (float(wall) for wall in self.model.walls(params))
        rate = SPEEDS * max(1.0, shaking)
        rows = [[0.0, 2.0 * np.pi], [right, left], [-rate, rate]]
        if self.model.moving_cavity:
            reach = 2.0 * max(1.0, shaking)
            rows += [[-reach, reach], [-reach, reach]]
        return np.array(rows)

    def starts(self, count: int, seed: int, p: float) -> np.ndarray:
        """Low-discrepancy starts over the box, shape (count, n)."""
        box = self.box(p)
        return box[:, 0] + low_discrepancy(len(box), count, seed) * (box[:, 1] - box[:, 0])

    def settle(self, starts: np.ndarray, p: float) -> tuple[list[Motion], np.ndarray, np.ndarray]:
        """Simulate all starts and recognise what they settle on.

        Parameters
        ----------
        starts : float array (m, n)
        p : float

        Returns
        -------
        motions : list of Motion
            In the order of their first start.
        index : int array (m,)
            Which motion each start reaches.
        mirrored : bool array (m,)
            Whether it reaches the mirror image of that motion.
        """
        params = self.model.vector_at(self.parameter, p, self.parameters)
        states = self._states(starts)
        result = settle_all(
            self.model.name,
            states,
            params,
            transients=TRANSIENTS,
            longest=LONGEST,
            tolerance=TOLERANCE,
            workers=self.workers,
        )
        self.work += float(states[:, TURNS].sum())
        return _Sorting(self, params, p, states, result).sorted()

    def embedded(self, state: np.ndarray, p: float) -> list[tuple[Any, np.ndarray]]:
        """Unstable cycles that the chaotic motion through a state passes near, each once, as problems with their unknowns.

        Parameters
        ----------
        state : float array (S,)
            `Motion.state` of a chaotic motion.
        p : float
        """
        params = self.model.vector_at(self.parameter, p, self.parameters)
        simulator = NativeSimulator(self.model, params)
        simulator.state = state.copy()
        simulator.state[TURNS] = 0.0
        cycles = list(embedded_cycles(simulator, EMBEDDED, self._solver(params)))
        self.work += simulator.time + SOLVED * len(cycles)
        return distinct(cycles, self.parameter, p)

    def _solver(self, params: np.ndarray) -> Callable[[Record, int, int, int], Any]:
        """What makes a cycle of a piece of a record."""

        def solve(record: Record, first: int, last: int, periods: int) -> Any:
            codes, modes, rows = (part[first:last] for part in record.source)
            if not np.any(codes < 2):
                return None
            found = recurring(self.model, self.engine, params, codes, modes, rows, periods)
            return found.orbit.root() if found.residual < CLOSED and found.word is not None else None

        return solve

    def returning(self, starts: np.ndarray, p: float) -> list[tuple[Any, np.ndarray]]:
        """Cycles, stable or not, that are known in closed form or to which Newton's method leads from starts, each once.

        Rest and sliding between the walls are in closed form: their mean position is free, so no start leads Newton's method to them.

        Parameters
        ----------
        starts : float array (m, n)
        p : float
        """
        params = self.model.vector_at(self.parameter, p, self.parameters)
        simulator = NativeSimulator(self.model, params)
        cycles = list(returning_cycles(simulator, starts, self.box(p), EMBEDDED, self._solver(params)))
        self.work += SOLVED * (len(starts) + len(cycles))
        closed = closed_orbits(self.model, params, Orbit)
        return distinct((*closed, *cycles), self.parameter, p)

    def closed(self, p: float) -> list[tuple[Any, np.ndarray]]:
        """The real motions known in closed form, stable or not: rest, sliding between the walls, symmetric impacts."""
        params = self.model.vector_at(self.parameter, p, self.parameters)
        return distinct(closed_orbits(self.model, params, Orbit), self.parameter, p)

    def observed(self, state: np.ndarray | None, p: float) -> dict[str, float]:
        """Measures, in the machine's units, of the motion through a state; see `orbits.attractors.sweep.measure_names`."""
        if state is None:
            return {}
        params = self.model.vector_at(self.parameter, p, self.parameters)
        found = settle(self.model, self.engine, params, state.copy(), 0.0, LONGEST, patience=0)
        return described(found)[1]

    def _states(self, starts: np.ndarray) -> np.ndarray:
        """States of the simulation, shape (m, S)."""
        states = np.zeros((len(starts), self.engine.state))
        states[:, [PSI, *self.engine.places]] = starts
        return states

    def _shaking(self, params: np.ndarray) -> float:
        """Largest velocity of the cavity's centre that the excitation gives, as far as it is known beforehand."""
        names = self.model.parameter_names
        if "amplitude" in names:
            return float(params[names.index("amplitude")] * params[names.index("frequency")])
        return 1.0


class _Sorting:
    """The starts of one census, sorted by the motions they reach."""

    def __init__(
        self,
        population: Population,
        params: np.ndarray,
        p: float,
        states: np.ndarray,
        result: dict[str, np.ndarray],
    ) -> None:
        self.population, self.params, self.p = population, params, p
        self.model, self.engine = population.model, population.engine
        self.states, self.result = states, result
        self.motions: list[Motion] = []
        self.index = np.full(len(states), -1)
        self.mirrored = np.zeros(len(states), dtype=bool)
        self.images: list[
            tuple[np.ndarray, np.ndarray, bool]
        ] = []  # of each motion: states, mirrored ones, free mean

    def sorted(self) -> tuple[list[Motion], np.ndarray, np.ndarray]:
        outcome = self.result["outcome"]
        for i in range(len(self.states)):
            if self.index[i] >= 0:
                continue
            if outcome[i] == AT_REST:
                self._take(Motion("stuck", "", 1, *self._stuck()), outcome == AT_REST)
            elif outcome[i] == LOST:
                self._take(Motion("escaped"), outcome == LOST)
            elif outcome[i] == SETTLED:
                self._settled(i)
            else:
                self._unsettled(i)
        return self._in_order()

    def _take(self, motion: Motion, members: np.ndarray) -> None:
        self.index[members & (self.index < 0)] = len(self.motions)
        self.motions.append(motion)
        self.images.append((np.empty((0, 0)), np.empty((0, 0)), False))

    def _stuck(self) -> tuple[Any, Any]:
        orbit = Orbit.at_rest(self.model, self.params)
        if not orbit.real:
            return None, None
        problem = orbit.problem(self.population.parameter)
        return problem, orbit.seed(problem)[0]

    def _settled(self, i: int) -> None:
        self._add(self._looked_at(self.states[i].copy(), 8.0, LONGEST, 1), i)

    def _looked_at(self, state: np.ndarray, transient: float, longest: int, patience: int) -> Attractor:
        """What a motion settles on; its work is counted."""
        found = settle(self.model, self.engine, self.params, state, transient, longest, RECOGNISED, patience)
        self.population.work += float(state[TURNS]) + SOLVED
        return found

    def _unsettled(self, i: int) -> None:
        """A motion that does not recur: looked at with patience once, then told by its growth of small differences."""
        state = self.states[i].copy()
        for _ in range(PATIENCE):  # a chaotic transient may end late
            found = self._looked_at(state, 200.0, LONGEST, 2)
            if found.recurrent:
                self._add(found, i)
                return
            exponent, error = lyapunov(self.model.name, state, self.params, GROWTH)
            skip(self.engine, state, self.params, state[TURNS] + LATE, 10**9)
            self.population.work += 2.0 * GROWTH + LATE
        kind = wandering(exponent, error, self.model.moving_cavity)  # two frequencies need four dimensions
        if kind == "slow":  # neighbours come together: it may recur, but late
            found = self._looked_at(state, 0.0, RARE, 1)
            if found.recurrent:
                self._add(found, i)
                return
        known = next((k for k, m in enumerate(self.motions) if m.kind == kind and not m.word), None)
        others = (self.index < 0) & (self.result["outcome"] == 0)
        others &= np.arange(len(others)) >= i
        gaps = self.result["gaps"]
        alike = others & (np.abs(np.log10(np.maximum(gaps, 1e-300) / max(gaps[i], 1e-300))) < 1.5)
        alike[i] = True
        if known is not None:
            self.index[alike] = known
        else:
            self._take(Motion(kind, exponent=exponent, error=error, state=self.states[i].copy()), alike)

    def _add(self, found: Attractor, i: int) -> None:
        """Put an attractor on the list, unless it is there, and give it all starts whose states lie on it."""
        own, image, free = self._on(found)
        here = self._members(own, image, free, found.periods)
        here[i] = True
        problem = u = None
        word = found.text
        if found.word is not None and found.kind != "stuck" and len(found.codes):
            orbit = found.orbit.root()
            problem = orbit.problem(self.population.parameter)
            u = orbit.seed(problem)[0]
            word = orbit.spelling
        elif found.kind == "stuck":
            problem, u = self._stuck()
        for k, motion in enumerate(self.motions):
            if (
                motion.kind == found.kind
                and motion.periods == found.periods
                and self._same(motion, problem, u)
            ):
                self._assign(here, k, self.images[k], found.symmetric)
                return
        self._assign(here, len(self.motions), (own, image, free), found.symmetric)
        self.motions.append(Motion(found.kind, word, found.periods, problem, u, state=found.state.copy()))
        self.images.append((own, image, free))

    def _assign(
        self, here: np.ndarray, k: int, images: tuple[np.ndarray, np.ndarray, bool], symmetric: bool
    ) -> None:
        """Give motion k, which has these images, the starts that are `here` and free; each reaches it or its mirror image."""
        here = here & (self.index < 0)
        if not symmetric:
            self.mirrored[here] = self._nearer_image(*images)[here]
        self.index[here] = k

    def _same(self, motion: Motion, problem: Any, u: Any) -> bool:
        if motion.problem is None or problem is None:
            return motion.problem is problem
        return alike(motion.problem.canonical(motion.u, self.p), problem.canonical(u, self.p))

    def _on(self, found: Attractor) -> tuple[np.ndarray, np.ndarray, bool]:
        """States of the attractor at whole forcing periods, of its mirror image, and whether its mean is free."""
        state = found.state.copy()
        now = np.floor(state[TURNS] + state[PSI] / (2.0 * np.pi)) + 1.0
        skip(self.engine, state, self.params, now, 100_000)
        whole, half = [], []
        for k in range(max(found.periods, 1)):
            whole.append(self._vector(state))
            skip(self.engine, state, self.params, now + k + 0.5, 100_000)
            half.append(-self._vector(state))
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
        return near & recurs & (self.index < 0)

    def _nearer_image(self, own: np.ndarray, image: np.ndarray, free: bool) -> np.ndarray:
        return self._distances(image, free) < self._distances(own, free)

    def _in_order(self) -> tuple[list[Motion], np.ndarray, np.ndarray]:
        first = [
            int(np.flatnonzero(self.index == k)[0]) if np.any(self.index == k) else 1 << 60
            for k in range(len(self.motions))
        ]
        order = sorted((k for k in range(len(self.motions)) if first[k] < 1 << 60), key=first.__getitem__)
        place = {k: i for i, k in enumerate(order)}
        return [self.motions[k] for k in order], np.array([place[int(k)] for k in self.index]), self.mirrored
