"""FlowPopulation: many starts of a flow, and the equilibria and cycles that they settle on; the contract is that of `contvines.problems.abilities.Population`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from contvines.shared.motions import Motion, low_discrepancy, mean_of_blocks, wandering
from contvines.shared.numbers import TINY

from ..problems.functions import NotEvaluable
from ..problems.populations import StartsInBox
from ..problems.registry import rebuild
from .flow import Flow
from .simulation import AtRest, Escaped, March, Place, Stopped, last_round

if TYPE_CHECKING:
    from ..problems.algebraic import AlgebraicProblem
    from ..problems.protocol import Problem
    from .cycle_mesh import CycleMesh
    from .orbit import CycleOrbit

# starts are integrated in three rounds; between them Newton's method tries to recognise what they settle on
BLOCK, STEPS = 200, (2, 10, 27)  # integrator steps of a block, and blocks of each round
# the same for forced flows: forcing periods of a block, and blocks of each round
BLOCK_PERIODS, PERIODS = 20, (2, 10, 27)
MOST_STEPS = 20000  # most integrator steps of a block of forcing periods
PER_PERIOD = 30  # integrator steps that count as one period in the budget of an atlas
LONGEST = 16  # most returns, or forcing periods, of a cycle; a longer motion counts as irregular
DOUBLINGS = 4  # doublings of the transient when a single motion is simulated until it recurs
BRIEF = (3, 12)  # parameter values, and starts at each, of a brief search
FAILURES = (4, 2, 2)  # most failures to recognise a motion in each round
# most solutions that turn out to be known in each round; later rounds see the starts nearer to them
REPEATS = (2, 4, np.inf)
GROWTH = 4000  # time over which the growth of perturbations is averaged, in time scales of the motion
BLOCKS = 20  # parts of that time, whose scatter gives the error of the mean
FEW = 8  # fewest motions in that average; if there are fewer, copies of them are added


@dataclass(frozen=True, eq=False)
class Settled(Motion["AlgebraicProblem | CycleMesh"]):
    """A motion on which starts settle."""

    curve: np.ndarray | None = field(default=None, repr=False)  # states on the motion
    image: np.ndarray | None = field(default=None, repr=False)  # states on its mirror image
    size: np.ndarray | float = field(default=0.0, repr=False)  # range of each state along the motion


class FlowPopulation(StartsInBox):
    """Starts in a box of the flow's states.

    Parameters
    ----------
    flow : FlowProblem
    parameter : str
    values : mapping of str to float
        Values of the other parameters.
    box : sequence of (low, high), optional
        One pair per state; by default the flow's box or, if it has none, a box around its start and ``around``.
    around : ndarray, shape (n, d), optional
        States of a known motion.
    """

    across = 60
    brief = BRIEF

    def __init__(
        self,
        flow: Flow,
        parameter: str,
        values: Mapping[str, float],
        box: Sequence[tuple[float, float]] | None = None,
        around: np.ndarray | None = None,
    ) -> None:
        self.flow = flow
        self.values = flow.values.against(parameter, values)
        self.field = flow.field.against(self.values)
        points = np.array(flow.x0)[None]
        if around is not None:
            if np.shape(around)[1:] != points.shape[1:]:
                raise ValueError(
                    f"around has shape {np.shape(around)}; (n, {len(flow.x0)}) is needed, a row per state of the flow"
                )
            points = np.vstack([points, around])
        super().__init__(flow.name, parameter, flow.box if box is None else box, points, self.field.lengths)
        self.size = np.ptp(self._box, axis=1)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the states."""
        return self.flow.states

    def starts(self, count: int, seed: int, p: float) -> np.ndarray:
        """Return low-discrepancy starts in the box, shape (count, d)."""
        return self._box[:, 0] + low_discrepancy(self.node, count, seed) * self.size

    # ------------------------------------------------------------------ attractors
    def settle(self, starts: np.ndarray, p: float) -> tuple[list[Settled], np.ndarray, np.ndarray]:
        """Integrate all starts and recognise the motions they settle on; return (motions, index, mirrored)."""
        try:
            period = float(self.field.length_of_period(p)) if self.field.forced else None
        except NotEvaluable:  # the period is not positive for these parameters
            return [Settled("escaped")], np.zeros(len(starts), dtype=int), np.zeros(len(starts), dtype=bool)
        found = Settling(self, np.asarray(starts, dtype=float), p)
        found.go(period)
        self.work += found.march.steps / PER_PERIOD
        return found.motions, found.index, found.mirrored

    def on(self, x: np.ndarray, curve: np.ndarray, size: np.ndarray | float) -> np.ndarray:
        """Return which states lie on a motion of a given size.

        `curve` has one state, or many in order along a closed curve; of forced flows it has separate points.
        """
        s = self.field.settings
        size = np.maximum(size, s.smallest * self.size)
        near = np.zeros(len(x), dtype=bool)
        separate = self.field.forced or len(curve) == 1
        unit = ((curve if separate else np.roll(curve, -1, axis=0)) - curve) / size
        length = (unit**2).sum(axis=1)
        for i, state in enumerate(x):
            gap = (state - curve) / size
            share = np.clip((gap * unit).sum(axis=1) / np.where(length > 0.0, length, 1.0), 0.0, 1.0)
            distance = np.sqrt(((gap - share[:, None] * unit) ** 2).sum(axis=1))
            near[i] = distance.min() <= s.near * np.sqrt(self.node)
        return near

    def solved(self, x: np.ndarray, path: Sequence[Place], p: float) -> Settled | None:
        """Solve for the equilibrium or cycle on which the motion from a state settles; None if there is none.

        Parameters
        ----------
        x : ndarray, shape (d,)
            Last state of the motion.
        path : sequence of Place
            Earlier states, which may already contain a period of a cycle.
        p : float
        """
        if not self.field.forced:
            rest = self._rest(x, p)
            near = rest is not None and np.abs((rest - x) / self.size).max() <= self.field.settings.near
            if near and (found := self._equilibrium(rest, p)) is not None:
                return found
        values = {**self.values.values, self.parameter: p}
        try:
            orbit = self._recurring(path, values, p)
            if orbit is None:
                orbit = self.flow.attractor_at(values, x, longest=LONGEST, doublings=DOUBLINGS)
        except AtRest as at_rest:
            return self._equilibrium(self._rest(at_rest.state, p), p)
        except Escaped:
            return Settled("escaped")
        except Stopped:
            return Settled("stopped")
        except ValueError:
            return None
        if not orbit.stable:
            return None
        problem: CycleMesh = orbit.problem(self.parameter)
        rounds = problem.rounds if self.field.forced else 0
        curve, image = curves(self.flow, orbit, rounds)
        size = np.ptp(orbit.states, axis=0)
        return Settled(
            "periodic",
            "cycle",
            rounds,
            problem,
            orbit.u.copy(),
            state=curve[0],
            curve=curve,
            image=image,
            size=size,
        )

    def _recurring(self, path: Sequence[Place], values: Mapping[str, float], p: float) -> CycleOrbit | None:
        """The stable cycle that a motion has already followed for a period; None if there is none."""
        last = last_round(self.field, p, path, LONGEST)
        if last is None:
            return None
        try:
            orbit = self.flow.cycle_at(values, *last)
        except (ValueError, NotEvaluable):
            return None
        return orbit if orbit.stable else None

    def _equilibrium(self, x: np.ndarray | None, p: float) -> Settled | None:
        """The equilibrium at a state as a motion, if it is stable; else None."""
        if x is None or not (np.linalg.eigvals(self.field.jacobian(x[None], p)[0]).real < 0.0).all():
            return None
        image = None if self.flow.mirror is None else self.flow.mirrored(x[None])
        return Settled(
            "periodic", "equilibrium", 0, self._equilibria(p), x, state=x, curve=x[None], image=image
        )

    def _equilibria(self, p: float) -> AlgebraicProblem:
        return self.flow.equilibria(self.parameter, {**self.values.values, self.parameter: p})

    def _rest(self, x: np.ndarray, p: float) -> np.ndarray | None:
        """The equilibrium to which Newton's method leads from a state; None if it fails."""
        return self.field.rest(np.asarray(x, dtype=float), p, self.size, self.field.settings.solved)

    def irregular(self, x: np.ndarray, p: float) -> Settled:
        """Classify motions that do not recur by their largest Lyapunov exponent, from the growth of perturbations; the scatter over motions and blocks of time gives its error."""
        d, count = self.node, max(len(x), FEW)
        states = x[np.arange(count) % len(x)]
        rng = np.random.default_rng(2)
        states[len(x) :] += self.field.settings.beside * self.size * rng.standard_normal((count - len(x), d))
        try:
            first = np.zeros(1) if self.field.forced else None
            speed = float(np.abs(np.linalg.eigvals(self.field.jacobian(x[:1], p, first)[0])).max())
            span = (
                float(self.field.length_of_period(p)) * 10.0
                if self.field.forced
                else GROWTH / BLOCKS / max(speed, TINY)
            )
            vectors = self.size * rng.standard_normal((count, d))
            march = March(self.field, p, np.hstack([states, vectors]), np.tile(self.size, 2))
            logs = []
            for k in range(1 + -(-BLOCKS // count)):
                before = march.t.copy()
                march.go(np.arange(count), MOST_STEPS, until=(k + 1) * span)
                sizes = np.linalg.norm(march.x[:, d:] / self.size, axis=1)
                logs.append(np.log(sizes) / (march.t - before))
                march.x[:, d:] /= sizes[:, None]
                march.slope[:, d:] /= sizes[:, None]
        except (ValueError, NotEvaluable):
            return Settled("slow", state=x[0])
        # during the first block the perturbations turn into the direction of growth
        found = np.concatenate(logs[1:])
        mean, error = mean_of_blocks(found, len(found))
        if not np.isfinite(mean):
            return Settled("slow", state=x[0])
        # quasi-periodic and chaotic motions need three dimensions (Poincare and Bendixson)
        possible = d + self.field.forced >= 3
        kind = wandering(mean, error, possible) if possible else "slow"
        return Settled(kind, exponent=mean, error=error, state=x[0])

    # ------------------------------------------------------------------ unstable motions
    def embedded(self, state: np.ndarray, p: float) -> list[tuple[Problem, np.ndarray]]:
        """Return unstable cycles in chaos: none, they are not searched for."""
        return []

    def returning(self, starts: np.ndarray, p: float) -> list[tuple[Problem, np.ndarray]]:
        """Return the equilibria, stable or unstable, to which Newton's method leads from starts."""
        if self.field.forced:
            return []
        found: list[np.ndarray] = []
        for start in np.asarray(starts, dtype=float):
            x = self._rest(start, p)
            if x is None or not ((x >= self._box[:, 0]) & (x <= self._box[:, 1])).all():
                continue
            if not any((np.abs(x - y) <= self.field.settings.same * self.size).all() for y in found):
                found.append(x)
        return [(self._equilibria(p), x) for x in found]

    def restored(self, description: Mapping[str, Any], u: np.ndarray, p: float) -> Problem | None:
        """Rebuild the problem of a motion that a journal has recorded; None if it cannot be rebuilt."""
        return rebuild(description)


class Settling:
    """Integration of many starts until they are recognised.

    Attributes
    ----------
    motions : list of Settled
        Motions found so far.
    index, mirrored : ndarray, shape (n,)
        Index of the motion on which each start settles (-1: not yet known), and whether it settles on the mirror image.
    """

    def __init__(self, population: FlowPopulation, starts: np.ndarray, p: float) -> None:
        self.population, self.p = population, p
        self.march = March(population.field, p, starts, population.size)
        self.motions: list[Settled] = []
        self.index, self.mirrored = np.full(len(starts), -1), np.zeros(len(starts), dtype=bool)

    @property
    def left(self) -> np.ndarray:
        """Indices of starts that are not yet recognised."""
        return np.flatnonzero(self.index < 0)

    def go(self, period: float | None) -> None:
        """Integrate until all starts are recognised or all rounds are over; forced flows in whole periods."""
        march, far, rounds = self.march, self.population.field.settings.far, 0
        for steps, periods, most, repeats in zip(STEPS, PERIODS, FAILURES, REPEATS, strict=True):
            paths: dict[int, list[Place]] = {int(i): [] for i in self.left[:most]}
            for _ in range(steps if period is None else periods):
                left = self.left
                if period is None:
                    march.go(left, BLOCK, far=far, paths=paths)
                else:
                    rounds += BLOCK_PERIODS
                    march.go(left, MOST_STEPS, until=rounds * period, far=far)
                ended = left[~np.isfinite(march.x[left]).all(axis=1)]
                self._add(Settled("escaped"), ended[~march.stopped[ended]])
                self._add(Settled("stopped"), ended[march.stopped[ended]])
                for k in range(len(self.motions)):
                    self._assign(k)
                if not self.left.size:
                    return
            self._recognise(paths, most, repeats)
        left = self.left
        if left.size:
            self._add(self.population.irregular(march.x[left[:BLOCKS]], self.p), left)

    def _add(self, motion: Settled, starts: np.ndarray) -> None:
        """Assign starts to a motion without a curve: escaped, stopped, or irregular."""
        if not starts.size:
            return
        same = [k for k, m in enumerate(self.motions) if m.kind == motion.kind and m.curve is None]
        self.index[starts] = same[0] if same else len(self.motions)
        if not same:
            self.motions.append(motion)

    def _assign(self, k: int) -> None:
        """Assign the starts whose states lie on motion k or on its mirror image."""
        motion, x = self.motions[k], self.march.x
        for curve, mirrored in ((motion.curve, False), (motion.image, True)):
            if curve is not None:
                left = np.flatnonzero((self.index < 0) & np.isfinite(x).all(axis=1))
                near = left[self.population.on(x[left], curve, motion.size)]
                self.index[near], self.mirrored[near] = k, mirrored

    def _recognise(self, paths: Mapping[int, Sequence[Place]], most: int, repeats: float) -> None:
        """Solve for the motions near states that are not yet recognised, up to `most` failures and `repeats` known motions."""
        tried: list[int] = []
        while len(tried) < most and repeats > 0:
            i = next((int(i) for i in self.left if i not in tried), None)
            if i is None:
                return
            motion = self.population.solved(self.march.x[i], paths.get(i, ()), self.p)
            if motion is None:
                tried.append(i)
            elif motion.curve is None:
                self._add(motion, np.array([i]))
            else:
                k = next((k for k, other in enumerate(self.motions) if self._same(other, motion)), None)
                if k is None:
                    k = len(self.motions)
                    self.motions.append(motion)
                else:
                    repeats -= 1
                self.index[i], self.mirrored[i] = (
                    k,
                    not self._on_curve(motion, self.motions[k].curve, self.motions[k].size),
                )
                self._assign(k)

    def _same(self, one: Settled, other: Settled) -> bool:
        same_type = one.word == other.word and one.periods == other.periods
        return same_type and any(self._on_curve(other, curve, one.size) for curve in (one.curve, one.image))

    def _on_curve(self, motion: Settled, curve: np.ndarray | None, size: np.ndarray | float) -> bool:
        """Whether a motion lies on the curve of another one of a given size."""
        if curve is None or motion.curve is None:
            return False
        return bool(self.population.on(motion.curve[:: max(1, len(motion.curve) // 8)], curve, size).all())


def curves(flow: Flow, orbit: CycleOrbit, rounds: int) -> tuple[np.ndarray, np.ndarray | None]:
    """Return states on a cycle and on its mirror image: along the whole curve, or (rounds > 0) once per period of the forcing."""
    times = np.arange(rounds) * orbit.period / rounds if rounds else np.linspace(0.0, orbit.period, 1001)[:-1]
    if flow.mirror is None:
        return orbit(times), None
    later = 0.5 * orbit.period / rounds if flow.mirror_shifted else 0.0
    return orbit(times), flow.mirrored(orbit((times + later) % orbit.period))
