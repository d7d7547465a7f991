"""Many starts under way, and the motions they are found to reach, each once."""

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
"""Forcing periods (or events) between two looks at a motion that is followed alone."""
AGAIN = 8.0  # forcing periods after which a settled motion is looked at
PATIENCE = (
    3  # times at most a motion that does not recur is looked at again, unless others like it are seen to end
)
ENOUGH = 20_000  # forcing periods that chaotic motions, all those alike together, have not ended in; events of a motion that is followed alone
LATE = 3000.0  # forcing periods between two such looks
TOLD = 6  # looks after which a motion that does not recur is taken for the one that is known not to
UNENDING = ("chaotic", "quasi-periodic", "slow")


SOLVED = 1000.0  # forcing periods whose simulation takes about as long as Newton's method for a cycle
RARE = 32  # forcing periods of the longest recurrence looked for where neighbours come together


Form = tuple[Hashable, np.ndarray]
"""A motion, so that two are one if theirs are `alike`."""


class Problem(Protocol):
    """What is asked of a motion's problem: the form of a solution that all descriptions of one motion share."""

    def canonical(self, u: np.ndarray, p: float) -> Form: ...


def distinct(cycles: Iterable[Orbit], parameter: str, p: float) -> list[tuple[Problem, np.ndarray]]:
    """Problems and unknowns of orbits at a value of a parameter, each motion once."""
    found: list[tuple[Problem, np.ndarray]] = []
    forms: list[Form] = []
    for orbit in cycles:
        problem = orbit.problem(parameter)
        u = orbit.seed(problem)[0]
        form = problem.canonical(u, p)
        if not any(alike(form, known) for known in forms):
            forms.append(form)
            found.append((problem, u))
    return found


def alike(one: Form, other: Form) -> bool:
    """Whether two canonical forms are those of one motion."""
    return one[0] == other[0] and np.allclose(one[1], other[1], atol=SIMULATING.same)


@dataclass(frozen=True, eq=False)
class _Marks:
    """Where a known motion passes the section, and its mirror image, by which another motion is seen to lie on it."""

    place: int  # among the motions
    own: dict[str, np.ndarray]
    """By the event of a self-excited machine, (m, d); "" of a forced one, at whole forcing periods."""
    image: dict[str, np.ndarray]
    counted: np.ndarray  # which coordinates are known

    def distances(self, event: str, points: np.ndarray) -> np.ndarray:
        """Of points (n, d) to the motion and to its mirror image, shape (2, n)."""
        rows = [table.get(event, np.empty((0, points.shape[-1]))) for table in (self.own, self.image)]
        gaps = [(np.abs(points[:, None] - known) * self.counted).max(axis=2) for known in rows]
        return np.array([gap.min(axis=1, initial=np.inf) for gap in gaps])


class Fleet:
    """Starts of a machine, sorted by the motions they reach, each of which is kept once. Those of a flow that runs them all at once until they recur
    are looked at when they have; else each is followed alone, and no further than until it falls onto a known motion.

    Attributes
    ----------
    motions : list of Motion
    index : int array (n,)
        Which of them each start reaches; -1 while that is not known.
    mirrored : bool array (n,)
        Whether it reaches the mirror image of that motion.
    work : float
        Forcing periods simulated, those that solve for cycles included.
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
        self._known: list[_Marks] = []
        self._begun = 0.0

    def sorted(self) -> tuple[list[Motion[Problem]], np.ndarray, np.ndarray]:
        """Motions in the order of their first start, then `index` and `mirrored`."""
        for i in range(len(self.index)):
            if self.index[i] < 0:
                self._sort(i)
        first = [int(np.flatnonzero(self.index == k)[0]) for k in range(len(self.motions))]
        order = sorted(range(len(first)), key=first.__getitem__)
        return [self.motions[k] for k in order], np.argsort(order)[self.index], self.mirrored

    def _sort(self, i: int) -> None:
        """Which motion start number i reaches, or its mirror image; with it all others of a batch whose points lie on that."""
        if not self.free[i]:
            return self._assign(i, Motion("impossible"))
        simulator, point = self.simulator, self.points[i]
        self._begun = simulator.time
        try:
            if self.batch is not None:
                return self._of_batch(i, self.batch)
            clock, point = (point[0], point[1:]) if self.model.forced else (0.0, point)
            simulator.start(point, clock / TWO_PI)
            self._begun = simulator.time
            return self._followed(i)
        except SimulationError:
            return self._assign(i, Motion("escaped"))
        finally:
            self.work += simulator.time - self._begun

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
        self._begun = self.simulator.time
        if outcome == Outcome.SETTLED:
            return self._found(self._looked_at(AGAIN, self.longest, 1), i)
        return self._unsettled(i, batch)

    def _looked_at(self, transient: float, longest: int, patience: int) -> Attractor:
        """What the motion settles on."""
        self.work += SOLVED
        return attracted(self.simulator, transient, longest, SIMULATING.one, patience)

    def _unsettled(self, i: int, batch: Batch) -> None:
        """A motion that does not recur, judged by its growth of small differences; where it may still recur it is looked at again.

        A chaotic transient ends at a rate that does not depend on its age (T. Tel and Y.-C. Lai, Transient Chaos, 2011): that many motions have
        not ended together tells as much as that one has not in as many times the periods. Where others did end, late, one is followed for
        several of the lives which that lets expect; if it ends, too, all are followed as long.
        """
        alike = (self.index < 0) & (batch.outcomes == Outcome.WANDERING)
        alike &= np.arange(len(alike)) >= i
        gaps = np.maximum(batch.gaps, np.finfo(float).tiny)
        alike &= np.abs(np.log10(gaps / gaps[i])) < 1.5
        alike[i] = True
        kind, exponent, error = self._grown()
        ended = (batch.outcomes == Outcome.SETTLED) & (batch.lasted > SIMULATING.late * batch.lasted[i])
        together, lives = float(batch.lasted[alike].sum()), 0.0
        if kind == "chaotic" and ended.any():
            life = (together + float(batch.lasted[ended].sum())) / np.count_nonzero(ended)
            lives = min(SIMULATING.lives * life, self.simulator.waiting.slow)
        followed, enough, looks = (0.0, lives, 0) if lives else (together, ENOUGH, 0)
        while looks < PATIENCE or (lives and followed < enough):
            if kind == "chaotic" and followed >= enough:
                break
            looks, begun = looks + 1, self.simulator.time
            found = self._looked_at(200.0, self.longest, 2)
            if found.recurrent:
                if lives:
                    self._longer(batch, alike, lives)
                return self._found(found, i)
            self.simulator.skip(LATE)
            followed += self.simulator.time - begun
        if kind != "chaotic":  # now that it is nearer to what it settles on
            kind, exponent, error = self._grown()
        if kind == "slow":  # neighbours come together: it may recur, but late
            found = self._looked_at(0.0, RARE, 1)
            if found.recurrent:
                return self._found(found, i)
        state = batch.states[i].copy()
        return self._assign(alike, Motion(kind, exponent=exponent, error=error, state=state))

    def _longer(self, batch: Batch, alike: np.ndarray, periods: float) -> None:
        """Follow chaotic motions that one of them has shown to end."""
        before = float(batch.lasted.sum())
        self.simulator.settle_longer(batch, alike, self.longest, periods, self.workers)
        self.work += float(batch.lasted.sum()) - before

    # ------------------------------------------------------------------ followed alone
    def _followed(self, i: int) -> None:
        simulator, begun = self.simulator, self.simulator.count
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
            if (looks >= TOLD and any(unending)) or simulator.count - begun > ENOUGH:
                break
        if any(unending):
            return self._assign(i, unending.index(True))
        kind, exponent, error = self._grown()
        state = simulator.state.copy()
        # where neighbours come together it may recur, but late
        if kind == "slow" and self._recurs(i, simulator.look(RARE), RARE):
            return None
        return self._assign(i, Motion(kind, exponent=exponent, error=error, state=state))

    def _recurs(self, i: int, run: Trajectory, longest: int) -> bool:
        """Whether a run ends with a cycle, which is put on the list."""
        orbit = recurring(self.simulator, run, longest, SIMULATING.nearly)
        if orbit is not None:
            self._add(i, orbit, orbit.flow.kind(orbit), orbit.periods, orbit.spelling)
        return orbit is not None

    def _equilibrium(self, run: Trajectory) -> tuple[Problem | None, np.ndarray | None]:
        """The solution near the end of a self-excited motion without events; None where none is known."""
        from orbits.flows.page.simulator import PageTrajectory
        from orbits.flows.page.smooth import rest_near

        if not isinstance(run, PageTrajectory):
            return None, None
        rest = rest_near(run.model, run.modes[-1], run.params, run.last)
        return (None, None) if rest is None else (rest.problem(self.parameter), rest.state)

    def _grown(self) -> tuple[str, float, float]:
        """Kind of a motion that does not recur, its Lyapunov exponent per forcing period and the error of that."""
        exponent, error = self.simulator.growth()
        self.work += 0.0 if self.batch is None else self.batch.growth
        return wandering(exponent, error, self.simulator.roomy), exponent, error

    def _nearest(self) -> tuple[_Marks | None, float, bool]:
        """The known motion that the next point of the section lies nearest to, how far from it, relative to 1 + points, and whether that is its image."""
        best: tuple[_Marks | None, float, bool] = (None, np.inf, False)
        if not self._known:
            return best
        event, point = self.simulator.section()
        size = 1.0 + float(np.abs(point).max())
        for marks in self._known:
            own, image = marks.distances(event, point[None])[:, 0] / size
            if min(own, image) < best[1]:
                best = marks, float(min(own, image)), bool(image < own)
        return best

    # ------------------------------------------------------------------ motions
    def _assign(
        self, members: np.ndarray | int, motion: Motion[Problem] | int, mirrored: np.ndarray | bool = False
    ) -> None:
        """These starts, as far as they are free, reach a motion, or its mirror image."""
        k = motion if isinstance(motion, int) else self._place(motion)
        here = np.zeros(len(self.index), dtype=bool)
        here[members] = True
        here &= self.index < 0
        self.mirrored[here] = np.broadcast_to(mirrored, here.shape)[here]
        self.index[here] = k

    def _place(self, motion: Motion[Problem]) -> int:
        """The number of a motion, which is put on the list if it is a new one."""
        form = None
        if motion.problem is not None and motion.u is not None:
            form = motion.problem.canonical(motion.u, self.p)
        for k, (known, other) in enumerate(zip(self.motions, self._forms)):
            one = alike(form, other) if form is not None and other is not None else form is other
            if one and known.kind == motion.kind and known.periods == motion.periods:
                return k
        self.motions.append(motion)
        self._forms.append(form)
        return len(self.motions) - 1

    def _solution(self, orbit: Orbit | None) -> tuple[Problem | None, np.ndarray | None]:
        """Problem and unknowns of an orbit; None of a motion without a word."""
        if orbit is None:
            return None, None
        problem = orbit.problem(self.parameter)
        return problem, orbit.seed(problem)[0]

    def _found(self, found: Attractor, i: int) -> None:
        """What a motion of a batch settles on."""
        orbit, periods = found.orbit, found.periods
        if found.kind == self.simulator.resting:
            orbit, periods = (orbit if orbit is not None and orbit.real else None), 1
        self._add(i, orbit, found.kind, periods, found.text, free=not found.impacts)

    def _add(
        self, i: int, orbit: Orbit | None, kind: str, periods: int, word: str, free: bool = False
    ) -> None:
        """Put the motion on which the simulator is on the list, unless it is there, and give it all starts whose points lie on it."""
        k = self._place(
            Motion(kind, word, periods, *self._solution(orbit), state=self.simulator.state.copy())
        )
        marks = next((marks for marks in self._known if marks.place == k), None)
        if marks is None:
            marks = self._marks(k, orbit, max(periods, 1), free)
            self._known.append(marks)
        batch = self.batch
        if batch is None:
            nearest, _, mirrored = self._nearest()
            return self._assign(i, k, nearest is marks and mirrored)
        own, image = marks.distances("", batch.points)
        recurs = (batch.outcomes == Outcome.SETTLED) & (batch.periods == max(periods, 1))
        if periods > self.longest:
            recurs = batch.outcomes == Outcome.WANDERING
        here = (np.minimum(own, image) < SIMULATING.nearly) & recurs
        here[i] = True
        return self._assign(here, k, image < own)

    def _marks(self, place: int, orbit: Orbit | None, periods: int, free: bool) -> _Marks:
        """Points of a motion and of its mirror image, where that is another one: of an orbit, or (of a batch) of that on which the simulator is."""
        simulator, model = self.simulator, self.model
        mirrored = model.has_mirror(self.params) and not (orbit is not None and orbit.symmetric)
        counted = np.ones(len(simulator.names))
        if orbit is not None:
            counted[[entry - 1 for entry in orbit.flow.loose(model, orbit.word)]] = 0.0
        if free:
            counted[0] = 0.0  # a motion without impacts may lie anywhere between the walls
        if orbit is not None and not model.forced:
            image = _after_events(orbit.mirror()) if mirrored else {}
            return _Marks(place, _after_events(orbit), image, counted)
        state, begun = simulator.state.copy(), simulator.time
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
        self._begun += simulator.time - begun
        return _Marks(place, {"": np.array(own)}, {"": np.array(image)} if mirrored else {}, counted)


def _after_events(orbit: Orbit) -> dict[str, np.ndarray]:
    """The nodes' states by their events."""
    letters, states = np.array(orbit.word.events), orbit.nodes[:, 1:]
    return {str(letter): states[letters == letter] for letter in np.unique(letters)}
