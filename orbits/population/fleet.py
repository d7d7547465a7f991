"""Simulate many starts and sort them by the motions they reach, each motion solved once."""

from __future__ import annotations

from collections.abc import Hashable, Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np

from contvines.shared.motions import Motion, wandering
from orbits.attractors.attractor import Attractor
from orbits.attractors.search import attracted, recurring, returns
from orbits.flows.protocol import Batch, Outcome, SimulationError, Simulator
from orbits.flows.trajectory import TWO_PI
from orbits.orbit import Orbit
from orbits.settings import SIMULATING

if TYPE_CHECKING:
    from orbits.flows.trajectory import Trajectory


BLOCKS = (10, 10, 20, 40, 80, 160, 320, 640, 1280)
"""Forcing periods (or events) between two searches for a return, of a motion simulated alone."""
CHECK_PERIODS = 8.0  # forcing periods after which a settled motion is solved for
PATIENCE = 3  # further searches for a return of a motion that has not settled, unless similar motions have settled late
ENOUGH = 20_000  # forcing periods, of all similar chaotic motions together, after which they count as chaotic; events of a motion simulated alone
LATE = 3000.0  # forcing periods between two such searches
# searches after which a motion that has not settled is identified with a known one that does not
SEARCHES = 6
UNENDING = ("chaotic", "quasi-periodic", "slow")


SOLVED = 1000.0  # forcing periods whose simulation costs about as much as Newton's method for a cycle
RARE = 32  # longest cycle, in forcing periods, sought of a motion whose neighbours converge to it


Form = tuple[Hashable, np.ndarray]
"""Canonical form of a motion: two motions are the same if their forms are `alike`."""


class Problem(Protocol):
    """A problem with a canonical form of its solutions, equal for all descriptions of one motion."""

    def canonical(self, u: np.ndarray, p: float) -> Form: ...


def distinct(cycles: Iterable[Orbit], parameter: str, p: float) -> list[tuple[Problem, np.ndarray]]:
    """Problems and unknowns of orbits at a parameter value, each motion once."""
    found: list[tuple[Problem, np.ndarray]] = []
    forms: list[Form] = []
    for orbit in cycles:
        problem = orbit.problem(parameter)
        u = orbit.seed(problem)[0]
        form = problem.canonical(u, p)
        if not any(alike(form, other) for other in forms):
            forms.append(form)
            found.append((problem, u))
    return found


def alike(one: Form, other: Form) -> bool:
    """Whether two canonical forms belong to the same motion."""
    return one[0] == other[0] and np.allclose(one[1], other[1], atol=SIMULATING.same)


@dataclass(frozen=True, eq=False)
class _Marks:
    """Section points of a known motion and of its mirror image, to recognise other motions that lie on it."""

    place: int  # index in `Fleet.motions`
    own: dict[str, np.ndarray]
    """Points (m, d) by event, of a self-excited machine; of a forced one at whole forcing periods, with the key ""."""
    image: dict[str, np.ndarray]
    counted: np.ndarray  # 1 for coordinates that are compared, 0 for free ones

    def distances(self, event: str, points: np.ndarray) -> np.ndarray:
        """Distances of points (n, d) from the motion and from its mirror image, shape (2, n)."""
        rows = [table.get(event, np.empty((0, points.shape[-1]))) for table in (self.own, self.image)]
        gaps = [(np.abs(points[:, None] - marks) * self.counted).max(axis=2) for marks in rows]
        return np.array([gap.min(axis=1, initial=np.inf) for gap in gaps])


class Fleet:
    """Starts of a machine, sorted by the motions they reach; each motion is kept once.

    If the flow can simulate all starts at once (`Simulator.settle_all`), a motion is solved for when its start has settled. Otherwise each start is
    simulated alone, until it comes close to a known motion or returns to itself.

    Attributes
    ----------
    motions : list of Motion
    index : int array (n,)
        Motion that each start reaches; -1 while it is not known.
    mirrored : bool array (n,)
        Whether the start reaches the mirror image of that motion.
    work : float
        Forcing periods simulated, with an equivalent for each solved cycle.
    """

    def __init__(
        self,
        simulator: Simulator,
        points: np.ndarray,
        longest: int,
        workers: int | None,
        parameter: str,
        p: float,
    ) -> None:
        self.simulator, self.points, self.longest, self.workers = simulator, points, longest, workers
        self.model, self.params, self.parameter, self.p = simulator.model, simulator.params, parameter, p
        self.motions: list[Motion[Problem]] = []
        self.index, self.mirrored = np.full(len(points), -1), np.zeros(len(points), dtype=bool)
        self.free = simulator.free(points)
        self.batch: Batch | None = simulator.settle_all(points, longest, workers)
        self.work = 0.0 if self.batch is None else float(self.batch.lasted.sum())
        self._forms: list[Form | None] = []
        self._all_marks: list[_Marks] = []
        self._started = 0.0

    def sorted(self) -> tuple[list[Motion[Problem]], np.ndarray, np.ndarray]:
        """Return the motions in the order of their first start, `index` and `mirrored`."""
        for i in range(len(self.index)):
            if self.index[i] < 0:
                self._sort(i)
        first = [int(np.flatnonzero(self.index == k)[0]) for k in range(len(self.motions))]
        order = sorted(range(len(first)), key=first.__getitem__)
        return [self.motions[k] for k in order], np.argsort(order)[self.index], self.mirrored

    def _sort(self, i: int) -> None:
        """Find the motion that start i reaches, and assign to it all starts of the batch that lie on the same motion."""
        if not self.free[i]:
            return self._assign(i, Motion("impossible"))
        simulator, point = self.simulator, self.points[i]
        self._started = simulator.time
        try:
            if self.batch is not None:
                return self._of_batch(i, self.batch)
            clock, point = (point[0], point[1:]) if self.model.forced else (0.0, point)
            simulator.start(point, clock / TWO_PI)
            self._started = simulator.time
            return self._followed(i)
        except SimulationError:
            return self._assign(i, Motion("escaped"))
        finally:
            self.work += simulator.time - self._started

    # ------------------------------------------------------------------ one of many
    def _of_batch(self, i: int, batch: Batch) -> None:
        outcome = batch.outcomes[i]
        if outcome == Outcome.AT_REST:
            rest = Orbit.at_rest(self.model, self.params)
            motion = Motion("stuck", "", 1, *self._solution(rest if rest.real else None))
            return self._assign(batch.outcomes == outcome, motion)
        if outcome == Outcome.LOST:
            return self._assign(batch.outcomes == outcome, Motion("escaped"))
        self.simulator.go_on(batch.states[i])
        self._started = self.simulator.time
        if outcome == Outcome.SETTLED:
            return self._found(self._attractor_reached(CHECK_PERIODS, self.longest, 1), i)
        return self._unsettled(i, batch)

    def _attractor_reached(self, transient: float, longest: int, patience: int) -> Attractor:
        """Attractor reached from the simulator's state."""
        self.work += SOLVED
        return attracted(self.simulator, transient, longest, SIMULATING.one, patience)

    def _unsettled(self, i: int, batch: Batch) -> None:
        """Classify a motion that has not settled by its largest Lyapunov exponent; if it may still settle, simulate on.

        A chaotic transient ends at a rate that does not depend on its age (T. Tel and Y.-C. Lai, Transient Chaos, 2011), so n motions that have
        not settled in T periods give the same evidence as one that has not settled in n T. If similar starts have settled late, their number gives
        the mean life of a transient: one motion is simulated for several mean lives, and if it settles, all are.
        """
        similar = (self.index < 0) & (batch.outcomes == Outcome.WANDERING)
        similar &= np.arange(len(similar)) >= i
        gaps = np.maximum(batch.gaps, np.finfo(float).tiny)
        similar &= np.abs(np.log10(gaps / gaps[i])) < 1.5
        similar[i] = True
        kind, exponent, error = self._growth()
        ended = (batch.outcomes == Outcome.SETTLED) & (batch.lasted > SIMULATING.late * batch.lasted[i])
        total, lives = float(batch.lasted[similar].sum()), 0.0
        if kind == "chaotic" and ended.any():
            life = (total + float(batch.lasted[ended].sum())) / np.count_nonzero(ended)
            lives = min(SIMULATING.lives * life, self.simulator.waiting.slow)
        followed, needed, looks = (0.0, lives, 0) if lives else (total, ENOUGH, 0)
        while looks < PATIENCE or (lives and followed < needed):
            if kind == "chaotic" and followed >= needed:
                break
            looks, start_time = looks + 1, self.simulator.time
            found = self._attractor_reached(200.0, self.longest, 2)
            if found.recurrent:
                if lives:
                    self._simulate_on(batch, similar, lives)
                return self._found(found, i)
            self.simulator.skip(LATE)
            followed += self.simulator.time - start_time
        if kind != "chaotic":  # again, nearer to the attractor
            kind, exponent, error = self._growth()
        if kind == "slow":  # neighbours converge to it: it may be a long cycle
            found = self._attractor_reached(0.0, RARE, 1)
            if found.recurrent:
                return self._found(found, i)
        state = batch.states[i].copy()
        return self._assign(similar, Motion(kind, exponent=exponent, error=error, state=state))

    def _simulate_on(self, batch: Batch, similar: np.ndarray, periods: float) -> None:
        """Simulate chaotic motions on, after one of them has settled."""
        before = float(batch.lasted.sum())
        self.simulator.settle_longer(batch, similar, self.longest, periods, self.workers)
        self.work += float(batch.lasted.sum()) - before

    # ------------------------------------------------------------------ followed alone
    def _followed(self, i: int) -> None:
        simulator, start_count = self.simulator, self.simulator.count
        unending = [m.kind in UNENDING for m in self.motions]
        before: tuple[_Marks | None, float] = (None, np.inf)
        for looks, block in enumerate(BLOCKS):
            goes_on = simulator.skip(block)
            marks, gap, mirrored = self._nearest()
            near = marks is not None and gap < SIMULATING.falling
            if marks is not None and (
                gap < SIMULATING.one or (near and marks is before[0] and gap < 0.5 * before[1])
            ):
                return self._assign(i, marks.place, mirrored)
            before = marks, gap
            if goes_on and (looks < 2 or (near and looks < 5)):
                continue
            run = simulator.look(self.longest)
            if not run.held and simulator.rests(run, True):
                return self._assign(
                    i, Motion("stuck", "", 0, *self._equilibrium(run), state=simulator.state.copy())
                )
            if self._recurs(i, run, self.longest):
                return None
            if run.held:
                return self._assign(i, Motion("stuck", state=simulator.state.copy()))
            if run.chatters and next(returns(run, self.longest, simulator.waiting.returned), None):
                return self._assign(i, Motion("chatter", state=simulator.state.copy()))
            if (looks >= SEARCHES and any(unending)) or simulator.count - start_count > ENOUGH:
                break
        if any(unending):
            return self._assign(i, unending.index(True))
        kind, exponent, error = self._growth()
        state = simulator.state.copy()
        # if neighbours converge to it, it may be a long cycle
        if kind == "slow" and self._recurs(i, simulator.look(RARE), RARE):
            return None
        return self._assign(i, Motion(kind, exponent=exponent, error=error, state=state))

    def _recurs(self, i: int, run: Trajectory, longest: int) -> bool:
        """Whether a run ends with a cycle, which is added to the motions."""
        orbit = recurring(self.simulator, run, longest, SIMULATING.nearly)
        if orbit is not None:
            self._add(i, orbit, orbit.flow.kind(orbit), orbit.periods, orbit.spelling)
        return orbit is not None

    def _equilibrium(self, run: Trajectory) -> tuple[Problem | None, np.ndarray | None]:
        """Equilibrium near the last state of a self-excited motion without events, as problem and unknowns; None if there is none."""
        from orbits.flows.page.simulator import PageTrajectory
        from orbits.flows.page.smooth import rest_near

        if not isinstance(run, PageTrajectory):
            return None, None
        rest = rest_near(run.model, run.modes[-1], run.params, run.last)
        return (None, None) if rest is None else (rest.problem(self.parameter), rest.state)

    def _growth(self) -> tuple[str, float, float]:
        """Kind of a motion that has not settled, its largest Lyapunov exponent per forcing period and the standard error."""
        exponent, error = self.simulator.growth()
        self.work += 0.0 if self.batch is None else self.batch.growth
        return wandering(exponent, error, self.simulator.roomy), exponent, error

    def _nearest(self) -> tuple[_Marks | None, float, bool]:
        """The known motion nearest to the next section point, the distance relative to 1 + points, and whether its mirror image is the nearer one."""
        best: tuple[_Marks | None, float, bool] = (None, np.inf, False)
        if not self._all_marks:
            return best
        event, point = self.simulator.section()
        size = 1.0 + float(np.abs(point).max())
        for marks in self._all_marks:
            own, image = marks.distances(event, point[None])[:, 0] / size
            if min(own, image) < best[1]:
                best = marks, float(min(own, image)), bool(image < own)
        return best

    # ------------------------------------------------------------------ motions
    def _assign(
        self, members: np.ndarray | int, motion: Motion[Problem] | int, mirrored: np.ndarray | bool = False
    ) -> None:
        """Assign starts that have none yet to a motion or its mirror image."""
        k = motion if isinstance(motion, int) else self._place(motion)
        chosen = np.zeros(len(self.index), dtype=bool)
        chosen[members] = True
        chosen &= self.index < 0
        self.mirrored[chosen] = np.broadcast_to(mirrored, chosen.shape)[chosen]
        self.index[chosen] = k

    def _place(self, motion: Motion[Problem]) -> int:
        """Index of a motion, which is added if it is new."""
        form = None
        if motion.problem is not None and motion.u is not None:
            form = motion.problem.canonical(motion.u, self.p)
        for k, (earlier, other) in enumerate(zip(self.motions, self._forms)):
            one = alike(form, other) if form is not None and other is not None else form is other
            if one and earlier.kind == motion.kind and earlier.periods == motion.periods:
                return k
        self.motions.append(motion)
        self._forms.append(form)
        return len(self.motions) - 1

    def _solution(self, orbit: Orbit | None) -> tuple[Problem | None, np.ndarray | None]:
        """Problem and unknowns of an orbit; None without one."""
        if orbit is None:
            return None, None
        problem = orbit.problem(self.parameter)
        return problem, orbit.seed(problem)[0]

    def _found(self, found: Attractor, i: int) -> None:
        """Add the attractor reached by start i of a batch."""
        orbit, periods = found.orbit, found.periods
        if found.kind == self.simulator.resting:
            orbit, periods = (orbit if orbit is not None and orbit.real else None), 1
        self._add(i, orbit, found.kind, periods, found.text, free=not found.impacts)

    def _add(
        self, i: int, orbit: Orbit | None, kind: str, periods: int, word: str, free: bool = False
    ) -> None:
        """Add the simulator's motion unless it is known, and assign to it all starts whose points lie on it."""
        k = self._place(
            Motion(kind, word, periods, *self._solution(orbit), state=self.simulator.state.copy())
        )
        marks = next((marks for marks in self._all_marks if marks.place == k), None)
        if marks is None:
            marks = self._marks(k, orbit, max(periods, 1), free)
            self._all_marks.append(marks)
        batch = self.batch
        if batch is None:
            nearest, _, mirrored = self._nearest()
            return self._assign(i, k, nearest is marks and mirrored)
        own, image = marks.distances("", batch.points)
        recurs = (batch.outcomes == Outcome.SETTLED) & (batch.periods == max(periods, 1))
        if periods > self.longest:
            recurs = batch.outcomes == Outcome.WANDERING
        on_motion = (np.minimum(own, image) < SIMULATING.nearly) & recurs
        on_motion[i] = True
        return self._assign(on_motion, k, image < own)

    def _marks(self, place: int, orbit: Orbit | None, periods: int, free: bool) -> _Marks:
        """Section points of an orbit, or in a batch of the simulator's motion, and of its mirror image if that is another motion."""
        simulator, model = self.simulator, self.model
        mirrored = model.has_mirror(self.params) and not (orbit is not None and orbit.symmetric)
        counted = np.ones(len(simulator.names))
        if orbit is not None:
            counted[[entry - 1 for entry in orbit.flow.loose(model, orbit.word)]] = 0.0
        if free:
            counted[0] = 0.0  # the mean position of a motion without impacts is free
        if orbit is not None and not model.forced:
            image = _after_events(orbit.mirror()) if mirrored else {}
            return _Marks(place, _after_events(orbit), image, counted)
        state, start_time = simulator.state.copy(), simulator.time
        if orbit is not None and self.batch is None:
            simulator.begin(orbit.word, orbit.nodes[0])
        own, image, first = [], [], np.floor(simulator.time) + 1.0
        simulator.follow(first)
        for k in range(periods):
            own.append(simulator.point)
            simulator.follow(first + k + 0.5)
            image.append(simulator.image(simulator.point))
            simulator.follow(first + k + 1.0)
        simulator.go_on(state)
        self._started += simulator.time - start_time
        return _Marks(place, {"": np.array(own)}, {"": np.array(image)} if mirrored else {}, counted)


def _after_events(orbit: Orbit) -> dict[str, np.ndarray]:
    """States of an orbit's nodes, by event."""
    letters, states = np.array(orbit.word.events), orbit.nodes[:, 1:]
    return {str(letter): states[letters == letter] for letter in np.unique(letters)}
