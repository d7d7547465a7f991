"""Populations of maps: starts in a box, and the cycles on which they settle."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ..flows.settings import FlowSettings
from ..problems.populations import StartsInBox
from ..shared.motions import Motion, mean_of_blocks, wandering
from ..shared.numbers import TINY
from .settings import MAPS

if TYPE_CHECKING:
    from ..problems.maps import MapProblem
    from ..problems.protocol import Problem

TRANSIENTS = (200, 800, 3200)  # iterations before each test whether a motion recurs
# relative to the box: components below it are zero; they would decay geometrically for ever
ZERO = np.finfo(float).eps ** 2
LONGEST = 64  # longest period of the cycles that starts settle on
GROWTH, BLOCKS = 4000, 20  # iterations for a Lyapunov exponent, and number of blocks of them for its error
BRIEF = (5, 48)  # number of values, and of starts at each, of the brief search after a diagram
# longest period of the unstable cycles in a chaotic motion, and iterations of the motion that are searched for them
EMBEDDED, EMBEDDED_IN = (
    6,
    4000,
)
NEAREST = 400  # largest number of close returns that are tried for each period
NEWTON, FROM_GUESS = 12, 0.05  # Newton steps, and largest distance from the guess relative to the box
ANYWHERE = 2.0  # the same distance for a start, which is no close guess


class MapPopulation(StartsInBox):
    """Starts in a box of the map's states.

    Parameters
    ----------
    problem : MapProblem
    box : sequence of (low, high), optional
        One pair per state; by default the range of the problem's cycle, widened by its size on each side.
    """

    across = 200  # default number of starts across and up in a picture of basins
    brief = BRIEF

    def __init__(self, problem: MapProblem, box: Sequence[tuple[float, float]] | None = None) -> None:
        self.problem = problem
        super().__init__(problem.name, problem.parameter, box, problem.u0.reshape(-1, problem.node), 1.0)
        self.size = float(np.ptp(self._box, axis=1).max())

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the states: x0, x1, ..."""
        return tuple(f"x{j}" for j in range(self.node))

    def starts(self, count: int, seed: int, p: float) -> np.ndarray:
        """Return low-discrepancy starts (Sobol, scrambled by the seed), shape (count, d); the box does not depend on `p`."""
        from scipy.stats import qmc

        draw = qmc.Sobol(self.node, scramble=True, seed=np.random.default_rng(seed))  # pyright: ignore[reportCallIssue]
        points = draw.random_base2(int(np.ceil(np.log2(max(count, 2)))))[:count]
        return self._box[:, 0] + points * np.ptp(self._box, axis=1)

    def settle(self, starts: np.ndarray, p: float) -> tuple[list[Motion[Problem]], np.ndarray, np.ndarray]:
        """Iterate all starts and classify the motions on which they settle; see `contvines.problems.abilities.Population`."""
        step = _Iteration(self.problem, p, np.asarray(starts, dtype=float))
        x = np.array(starts, dtype=float)
        n = len(x)
        periods = np.zeros(n, dtype=int)  # 0: not settled yet, -1: escaped
        for transient in TRANSIENTS:
            left = np.flatnonzero(periods == 0)
            if not left.size:
                break
            points = self._advance(step, x[left], transient)
            first, period = points.copy(), np.zeros(len(left), dtype=int)
            for k in range(1, LONGEST + 1):
                points = self._advance(step, points, 1)
                back = (np.abs(points - first).max(axis=1) < MAPS.returned * self.size) & (period == 0)
                period[back] = k
            period[~np.all(np.isfinite(points), axis=1)] = -1
            x[left], periods[left] = points, period
        return self._sorted(step, x, periods, p)

    def _advance(self, step: _Iteration, x: np.ndarray, count: int) -> np.ndarray:
        middle = self._box.mean(axis=1)
        self.work += count * len(x)
        for _ in range(count):
            with np.errstate(all="ignore"):
                x = step(x)
                x[np.abs(x - middle).max(axis=1) > MAPS.far * self.size] = np.nan
        return x

    def _sorted(
        self, step: _Iteration, x: np.ndarray, periods: np.ndarray, p: float
    ) -> tuple[list[Motion[Problem]], np.ndarray, np.ndarray]:
        index = np.full(len(x), -1)
        motions: list[Motion[Problem]] = []
        cycles: dict[int, np.ndarray] = {}  # index of the motion -> points
        for i in range(len(x)):
            if index[i] >= 0:
                continue
            if periods[i] < 0:
                members = periods < 0
                motions.append(Motion("escaped"))
            elif periods[i] == 0:
                members = periods == 0
                motions.append(self._wandering(x[i], p))
            else:
                period = int(periods[i])
                cycle = [x[i]]
                for _ in range(period - 1):
                    cycle.append(step(cycle[-1][None])[0])
                guess = np.array(cycle)
                solved = self._solved(guess, p)
                near = solved is not None and np.abs(solved - guess).max() < MAPS.spacing * self.size
                points = solved if solved is not None and near else guess
                points[np.abs(points) < ZERO * self.size] = 0.0
                gaps = np.abs(x[:, None, :] - points[None]).max(axis=2).min(axis=1)
                members = (gaps < MAPS.near * self.size) & (periods == period)
                same = [
                    k
                    for k, earlier in cycles.items()
                    if len(earlier) == period and self._same_cycle(points, earlier)
                ]
                if same:  # approached so slowly that the starts stand apart
                    index[i] = same[0]
                    continue
                cycles[len(motions)] = points
                problem = self.problem.cycle_through(points, p)
                motions.append(Motion("periodic", f"{period}-cycle", period, problem, points.ravel()))
            members[i] = True
            index[members & (index < 0)] = len(motions) - 1
        return motions, index, np.zeros(len(x), dtype=bool)

    def embedded(self, state: np.ndarray, p: float) -> list[tuple[Problem, np.ndarray]]:
        """Find unstable cycles near a chaotic motion, from its close returns; see `contvines.problems.abilities.Population`."""
        step = _Iteration(self.problem, p, state[None])
        self.work += EMBEDDED_IN
        run = np.empty((EMBEDDED_IN, self.node))
        run[0] = state
        for k in range(1, EMBEDDED_IN):
            run[k] = step.one(run[k - 1])
        cycles: list[np.ndarray] = []
        for period in range(1, EMBEDDED + 1):
            gaps = np.abs(run[period:] - run[:-period]).max(axis=1)
            free = np.ones(len(gaps), dtype=bool)
            for i in np.argsort(gaps, kind="stable")[:NEAREST]:
                if not free[i]:
                    continue
                free &= np.abs(run[: len(gaps)] - run[i]).max(axis=1) > MAPS.spacing * self.size
                points = self._solved(run[i : i + period], p)
                if points is not None and not any(self._same_cycle(points, cycle) for cycle in cycles):
                    cycles.append(points)
        return [(self.problem.cycle_through(points, p), points.ravel()) for points in cycles]

    def returning(self, starts: np.ndarray, p: float) -> list[tuple[Problem, np.ndarray]]:
        """Find cycles, stable or not, by Newton's method from starts; see `contvines.problems.abilities.Population`.

        Only cycles with at least one point in the box of starts are returned.
        """
        cycles: list[np.ndarray] = []
        low, high = self._box.T
        for start in np.asarray(starts, dtype=float):
            for period in range(1, EMBEDDED + 1):
                with np.errstate(all="ignore"):  # far away a map may overflow
                    points = self._solved(np.repeat(start[None], period, axis=0), p, ANYWHERE)
                if points is None or any(self._same_cycle(points, cycle) for cycle in cycles):
                    continue
                if np.any(np.all((points >= low) & (points <= high), axis=1)):
                    cycles.append(points)
        return [(self.problem.cycle_through(points, p), points.ravel()) for points in cycles]

    def restored(self, description: Mapping[str, Any], u: np.ndarray, p: float) -> Problem | None:
        """Rebuild the problem of a motion from a journal's record; see `contvines.problems.abilities.Population`."""
        return self.problem.cycle_through(np.reshape(u, (-1, self.node)), p)

    def _solved(self, guess: np.ndarray, p: float, reach: float = FROM_GUESS) -> np.ndarray | None:
        """Return the points, shape (n, d), of a cycle near a guess, by Newton's method on the n-th iterate; None if it fails."""
        x, n, functions = guess[0].copy(), len(guess), self.problem.functions
        for _ in range(NEWTON):
            self.work += n
            image, matrix = x, np.eye(len(x))
            for _ in range(n):
                matrix = functions.jacobian(image, p) @ matrix
                image = functions.value(image, p)
            if not np.all(np.isfinite(image)):
                return None
            step = np.linalg.lstsq(matrix - np.eye(len(x)), x - image, rcond=None)[0]
            if np.abs(step).max() <= MAPS.returned * self.size:
                cycle = [x + step]
                for _ in range(n - 1):
                    cycle.append(functions.value(cycle[-1], p))
                return np.array(cycle)
            x = x + step
            if np.abs(x - guess[0]).max() > reach * self.size:
                return None
        return None

    def _same_cycle(self, points: np.ndarray, cycle: np.ndarray) -> bool:
        """Whether a cycle equals a known one, or is a known one traversed several times."""
        gaps = np.abs(cycle - points[0]).max(axis=1)
        return len(points) % len(cycle) == 0 and bool(gaps.min() < MAPS.near * self.size)

    def _wandering(self, x: np.ndarray, p: float) -> Motion[Problem]:
        """Classify a motion that does not recur by its Lyapunov exponent, the mean growth of a tangent vector; its error is that of block means."""
        state = x.copy()
        functions = self.problem.functions
        vector = np.ones(self.node) / np.sqrt(self.node)
        logs = np.empty(GROWTH)
        self.work += GROWTH
        for k in range(GROWTH):
            vector = functions.jacobian(x, p) @ vector
            size = float(np.linalg.norm(vector))
            logs[k] = np.log(max(size, TINY))
            vector = vector / max(size, TINY)
            x = functions.value(x, p)
        mean, error = mean_of_blocks(logs, BLOCKS)
        return Motion(wandering(mean, error, self.node > 1), exponent=mean, error=error, state=state)


class _Iteration:
    """The map at a value of the parameter, for many points: one call if the function accepts arrays of columns, otherwise point by point."""

    def __init__(self, problem: MapProblem, p: float, sample: np.ndarray) -> None:
        self.functions, self.p = problem.functions, p
        self.value = problem.values.at(p)
        self.vectorised = self._takes_columns(sample[:7])

    def __call__(self, x: np.ndarray) -> np.ndarray:
        if self.vectorised:
            return np.array(self.functions.f(np.ascontiguousarray(x.T), self.value), dtype=float).T.copy()
        return np.array([self.one(point) for point in x])

    def one(self, x: np.ndarray) -> np.ndarray:
        """Return the image of one point as a flat array."""
        return np.asarray(self.functions.f(x, self.value), dtype=float).reshape(-1)

    def _takes_columns(self, x: np.ndarray) -> bool:
        try:
            columns = np.array(self.functions.f(np.ascontiguousarray(x.T), self.value), dtype=float)
            single = np.array([self.one(point) for point in x])
        except Exception:  # a function written for one point may raise any error for columns
            return False
        # powers of numbers and of arrays may differ in the last digit
        agree = FlowSettings.agree
        return columns.shape == x.T.shape and np.allclose(
            columns.T, single, rtol=agree, atol=agree, equal_nan=True
        )
