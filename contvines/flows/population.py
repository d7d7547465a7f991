"""Many starts of a flow, and the equilibria and cycles that they settle on; the contract is that of `contvines.problems.abilities.Population`."""

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

BLOCK, STEPS = (
    200,
    (2, 10, 27),
)  # steps of the integration, and how often so many, for those that have settled on nothing before
BLOCK_PERIODS, PERIODS = 20, (2, 10, 27)  # likewise, periods of a forcing
MOST_STEPS = 20000  # in so many periods
PER_PERIOD = 30  # steps that count as a period in the budget of an atlas
LONGEST = 16  # returns, or periods of the forcing, after which a motion is taken to be irregular
DOUBLINGS = 4  # of the transient of a motion that is looked at by itself
BRIEF = (3, 12)  # values, and starts at each, of a brief look
TRIED = (4, 2, 2)  # motions that recur nowhere, after which no others are looked at by themselves
AGAIN = (
    2,
    4,
    np.inf,
)  # motions solved for though known, after which others are left to come nearer by themselves
GROWTH = 4000  # times the time scale of a motion over which a vector's growth is followed
BLOCKS = 20
FEW = 8  # motions at least, copies of those there are ...


@dataclass(frozen=True, eq=False)
class Settled(Motion["AlgebraicProblem | CycleMesh"]):
    """What some starts settle on."""

    curve: np.ndarray | None = field(default=None, repr=False)  # states on it
    image: np.ndarray | None = field(default=None, repr=False)  # states on its mirror image
    size: np.ndarray | float = field(default=0.0, repr=False)  # range of each state along it


class FlowPopulation(StartsInBox):
    """Starts in a box of the flow's states.

    Parameters
    ----------
    flow : FlowProblem
    parameter : str
    values : mapping of str to float
        Of the other parameters.
    box : sequence of (low, high), optional
        One pair per state; by default the flow's own one, or else round its start, and round ``around``.
    around : ndarray, shape (n, d), optional
        States of a motion that is known.
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
        """Of the states."""
        return self.flow.states

    def starts(self, count: int, seed: int, p: float) -> np.ndarray:
        """Low-discrepancy starts, shape (count, d)."""
        return self._box[:, 0] + low_discrepancy(self.node, count, seed) * self.size

    # ------------------------------------------------------------------ what attracts
    def settle(self, starts: np.ndarray, p: float) -> tuple[list[Settled], np.ndarray, np.ndarray]:
        """Integrate all starts and recognise what they settle on."""
        try:
            period = float(self.field.length_of_period(p)) if self.field.forced else None
        except NotEvaluable:  # there is no forcing with such parameters
            return [Settled("escaped")], np.zeros(len(starts), dtype=int), np.zeros(len(starts), dtype=bool)
        found = Settling(self, np.asarray(starts, dtype=float), p)
        found.go(period)
        self.work += found.march.steps / PER_PERIOD
        return found.motions, found.index, found.mirrored

    def on(self, x: np.ndarray, curve: np.ndarray, size: np.ndarray | float) -> np.ndarray:
        """Which states lie on a curve of a motion of such a size, of one point or of many that follow each other round it (in forced flows: apart)."""
        s = self.field.settings
        size = np.maximum(size, s.smallest * self.size)
        near = np.zeros(len(x), dtype=bool)
        apart = self.field.forced or len(curve) == 1
        unit = ((curve if apart else np.roll(curve, -1, axis=0)) - curve) / size
        length = (unit**2).sum(axis=1)
        for i, state in enumerate(x):
            gap = (state - curve) / size
            share = np.clip((gap * unit).sum(axis=1) / np.where(length > 0.0, length, 1.0), 0.0, 1.0)
            distance = np.sqrt(((gap - share[:, None] * unit) ** 2).sum(axis=1))
            near[i] = distance.min() <= s.near * np.sqrt(self.node)
        return near

    def solved(self, x: np.ndarray, way: Sequence[Place], p: float) -> Settled | None:
        """The equilibrium or cycle on which the motion from a state settles, which came some way; None where it is neither, or not soon."""
        if not self.field.forced:
            rest = self._rest(x, p)
            near = rest is not None and np.abs((rest - x) / self.size).max() <= self.field.settings.near
            if near and (found := self._equilibrium(rest, p)) is not None:
                return found
        values = {**self.values.values, self.parameter: p}
        try:
            orbit = self._recurring(way, values, p)
            if orbit is None:
                orbit = self.flow.attractor_at(values, x, longest=LONGEST, doublings=DOUBLINGS)
        except AtRest as still:
            return self._equilibrium(self._rest(still.state, p), p)
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

    def _recurring(self, way: Sequence[Place], values: Mapping[str, float], p: float) -> CycleOrbit | None:
        """The stable cycle along which a motion has gone round already; None if it has not."""
        last = last_round(self.field, p, way, LONGEST)
        if last is None:
            return None
        try:
            orbit = self.flow.cycle_at(values, *last)
        except (ValueError, NotEvaluable):
            return None
        return orbit if orbit.stable else None

    def _equilibrium(self, x: np.ndarray | None, p: float) -> Settled | None:
        """The equilibrium at a state, if it attracts."""
        if x is None or not (np.linalg.eigvals(self.field.jacobian(x[None], p)[0]).real < 0.0).all():
            return None
        image = None if self.flow.mirror is None else self.flow.mirrored(x[None])
        return Settled(
            "periodic", "equilibrium", 0, self._equilibria(p), x, state=x, curve=x[None], image=image
        )

    def _equilibria(self, p: float) -> AlgebraicProblem:
        return self.flow.equilibria(self.parameter, {**self.values.values, self.parameter: p})

    def _rest(self, x: np.ndarray, p: float) -> np.ndarray | None:
        """The equilibrium next to a state; None if there is none."""
        return self.field.rest(np.asarray(x, dtype=float), p, self.size, self.field.settings.solved)

    def irregular(self, x: np.ndarray, p: float) -> Settled:
        """Motions that do not recur, judged by the growth of vectors along them; motions and blocks of time give the error of the mean."""
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
        found = np.concatenate(logs[1:])  # in the first block vectors turn to where they grow
        mean, error = mean_of_blocks(found, len(found))
        if not np.isfinite(mean):
            return Settled("slow", state=x[0])
        room = (
            d + self.field.forced >= 3
        )  # for two frequencies, or chaos: not in the plane (Poincare and Bendixson)
        return Settled(
            wandering(mean, error, room) if room else "slow", exponent=mean, error=error, state=x[0]
        )

    # ------------------------------------------------------------------ what does not attract
    def embedded(self, state: np.ndarray, p: float) -> list[tuple[Problem, np.ndarray]]:
        """Unstable cycles in chaos are not looked for."""
        return []

    def returning(self, starts: np.ndarray, p: float) -> list[tuple[Problem, np.ndarray]]:
        """Equilibria, stable or not, to which Newton's method leads from starts."""
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
        """The problem of a motion that a journal remembers, as `settle` had it; None where it cannot be rebuilt."""
        return rebuild(description)


class Settling:
    """Starts on their way to what they settle on.

    Attributes
    ----------
    motions : list of Settled
        Those that are known.
    index, mirrored : ndarray, shape (n,)
        Which of them each start settles on, -1 of none yet, and whether on its mirror image.
    """

    def __init__(self, population: FlowPopulation, starts: np.ndarray, p: float) -> None:
        self.population, self.p = population, p
        self.march = March(population.field, p, starts, population.size)
        self.motions: list[Settled] = []
        self.index, self.mirrored = np.full(len(starts), -1), np.zeros(len(starts), dtype=bool)

    @property
    def left(self) -> np.ndarray:
        """Starts that have settled on nothing."""
        return np.flatnonzero(self.index < 0)

    def go(self, period: float | None) -> None:
        """Until all have settled, or long enough; of forced flows from period to period."""
        march, far, rounds = self.march, self.population.field.settings.far, 0
        for steps, periods, most, again in zip(STEPS, PERIODS, TRIED, AGAIN, strict=True):
            ways: dict[int, list[Place]] = {int(i): [] for i in self.left[:most]}
            for _ in range(steps if period is None else periods):
                left = self.left
                if period is None:
                    march.go(left, BLOCK, far=far, ways=ways)
                else:
                    rounds += BLOCK_PERIODS
                    march.go(left, MOST_STEPS, until=rounds * period, far=far)
                gone = left[~np.isfinite(march.x[left]).all(axis=1)]
                self._add(Settled("escaped"), gone[~march.stopped[gone]])
                self._add(Settled("stopped"), gone[march.stopped[gone]])
                for k in range(len(self.motions)):
                    self._assign(k)
                if not self.left.size:
                    return
            self._recognise(ways, most, again)
        left = self.left
        if left.size:
            self._add(self.population.irregular(march.x[left[:BLOCKS]], self.p), left)

    def _add(self, motion: Settled, which: np.ndarray) -> None:
        """Starts have settled on what is no curve."""
        if not which.size:
            return
        same = [k for k, m in enumerate(self.motions) if m.kind == motion.kind and m.curve is None]
        self.index[which] = same[0] if same else len(self.motions)
        if not same:
            self.motions.append(motion)

    def _assign(self, k: int) -> None:
        """Give a motion, or its mirror image, the states that lie on it."""
        motion, x = self.motions[k], self.march.x
        for curve, mirrored in ((motion.curve, False), (motion.image, True)):
            if curve is not None:
                left = np.flatnonzero((self.index < 0) & np.isfinite(x).all(axis=1))
                near = left[self.population.on(x[left], curve, motion.size)]
                self.index[near], self.mirrored[near] = k, mirrored

    def _recognise(self, ways: Mapping[int, Sequence[Place]], most: int, again: float) -> None:
        """Solve for what the states that belong to nothing yet have come near to."""
        tried: list[int] = []
        while len(tried) < most and again > 0:
            i = next((int(i) for i in self.left if i not in tried), None)
            if i is None:
                return
            motion = self.population.solved(self.march.x[i], ways.get(i, ()), self.p)
            if motion is None:
                tried.append(i)
            elif motion.curve is None:
                self._add(motion, np.array([i]))
            else:
                k = next((k for k, known in enumerate(self.motions) if self._same(known, motion)), None)
                if k is None:
                    k = len(self.motions)
                    self.motions.append(motion)
                else:
                    again -= 1
                self.index[i], self.mirrored[i] = (
                    k,
                    not self._along(motion, self.motions[k].curve, self.motions[k].size),
                )
                self._assign(k)

    def _same(self, one: Settled, other: Settled) -> bool:
        alike = one.word == other.word and one.periods == other.periods
        return alike and any(self._along(other, curve, one.size) for curve in (one.curve, one.image))

    def _along(self, motion: Settled, curve: np.ndarray | None, size: np.ndarray | float) -> bool:
        """Whether a motion lies on a curve of another one, of such a size."""
        if curve is None or motion.curve is None:
            return False
        return bool(self.population.on(motion.curve[:: max(1, len(motion.curve) // 8)], curve, size).all())


def curves(flow: Flow, orbit: CycleOrbit, rounds: int) -> tuple[np.ndarray, np.ndarray | None]:
    """States on a cycle and on its mirror image: all along, or where it repeats after so many periods of a forcing once per period."""
    times = np.arange(rounds) * orbit.period / rounds if rounds else np.linspace(0.0, orbit.period, 1001)[:-1]
    if flow.mirror is None:
        return orbit(times), None
    later = 0.5 * orbit.period / rounds if flow.mirror_shifted else 0.0
    return orbit(times), flow.mirrored(orbit((times + later) % orbit.period))
