"""Integration of declared machines by DOP853 of `scipy.integrate.solve_ivp`: a reference for tests, and a slow replacement for heyoka.

Crossings inside a step are searched on samples of its dense output, and more closely if samples come near to zero and turn back.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np
from scipy.integrate import DOP853
from scipy.optimize import minimize_scalar, root_scalar

from orbits.arguments import ROUNDOFF
from orbits.integrators.expressions import Layout, Values, constant, derivatives, variable, written
from orbits.integrators.protocol import Crossing
from orbits.settings import INTEGRATING
from orbits.symbols import Symbol

BETWEEN = np.linspace(0.0, 1.0, 13)[1:]  # fractions of a step at which functions are sampled
MOST_STEPS = 100_000
LANES = 1  # flights are integrated one by one


class _Path:
    """A flow followed step by step."""

    def __init__(self, layout: Layout, rates: Sequence[Symbol], functions: Sequence[Symbol] = ()) -> None:
        self._rates = written(layout, rates, math)
        self._functions = Values(layout, functions)
        self.final = self.nowhere = np.full(len(rates), np.nan)

    def steps(self, state: np.ndarray, begin: float, end: float, numbers: np.ndarray) -> Iterator[DOP853]:
        """Yield the solver after each of its steps; stop short of `end` if the flow diverges."""
        p, nowhere = numbers.tolist(), self.nowhere

        def rates(clock: float, x: np.ndarray) -> list[float] | np.ndarray:
            try:
                return self._rates(x.tolist(), clock, p)
            except (ArithmeticError, ValueError):
                return nowhere

        self.final = np.array(state, dtype=float)
        with np.errstate(all="ignore"):
            solver = DOP853(
                rates, begin, self.final, end, rtol=INTEGRATING.relative, atol=INTEGRATING.absolute
            )
            for _ in range(MOST_STEPS if end != begin else 0):
                solver.step()
                if solver.status == "failed" or not np.isfinite(solver.y).all():
                    break
                yield solver
                if solver.status == "finished":
                    self.final = np.array(solver.y)
                    return
        if end != begin:
            self.final = nowhere

    def crossings(
        self, state: np.ndarray, begin: float, end: float, numbers: np.ndarray, rising: bool
    ) -> Iterator[Crossing]:
        """Yield (clock, index of the function, state) of every rise (or fall) through zero, step by step."""
        sign = 1.0 if rising else -1.0

        def at(clock: float | np.ndarray, states: np.ndarray) -> np.ndarray:
            rows = np.repeat(numbers[None], len(states), axis=0)
            return sign * self._functions(states, np.atleast_1d(clock), rows)

        last = at(begin, np.asarray(state, dtype=float)[None])
        for solver in self.steps(state, begin, end, numbers):
            assert solver.t_old is not None
            path, before = solver.dense_output(), float(solver.t_old)
            clocks = np.append(before, before + BETWEEN * (solver.t - before))
            table = np.concatenate([last, at(clocks[1:], path(clocks[1:]).T)])
            found = []
            for i, row in enumerate(table.T):
                rises = _rises(lambda c, k=i, x=path: float(at(c, x(np.array([c])).T)[0, k]), clocks, row)
                found += [(clock, i) for clock in rises]
            for clock, i in sorted(found):
                yield clock, i, path(clock)
            last = table[-1:]


def _rises(value: Callable[[float], float], clocks: np.ndarray, row: np.ndarray) -> list[float]:
    """Return the clocks at which a sampled function rises through zero.

    A rise between two negative samples is possible only near a local maximum of the samples; there the function is maximised.
    """
    marks, heights, last = [*clocks], [*row], len(row) - 1
    for k in range(last, -1, -1):
        low, high = max(k - 1, 0), min(k + 1, last)
        drop = max(row[k] - row[low], row[k] - row[high])  # largest possible rise above the sample
        if min(row[k] - row[low], row[k] - row[high]) >= 0.0 > row[k] > -drop:
            top: Any = minimize_scalar(
                lambda c: -value(c), bounds=(clocks[low], clocks[high]), method="bounded"
            )
            if top.fun < 0.0:
                place = k if top.x < clocks[k] else k + 1
                marks.insert(place, top.x)
                heights.insert(place, -top.fun)
    places = [k for k in range(len(marks) - 1) if heights[k] <= 0.0 < heights[k + 1]]
    near = {"method": "brentq", "xtol": 2.0 * ROUNDOFF, "rtol": 4.0 * ROUNDOFF}
    return [float(root_scalar(value, bracket=(marks[k], marks[k + 1]), **near).root) for k in places]


class Flight:
    """A flow with its derivatives by the initial state and by some of the numbers."""

    def __init__(self, layout: Layout, rates: Sequence[Symbol], active: tuple[int, ...]) -> None:
        n, m = len(rates), len(rates) + len(active)
        arguments = (*layout.states, *(layout.numbers[i] for i in active))
        slopes = derivatives(rates, [variable(name) for name in arguments])
        deriv = [[variable(f"d_{i}_{j}") for j in range(m)] for i in range(n)]
        deriv_rates = [
            sum((slopes[i][k] * deriv[k][j] for k in range(n)), slopes[i][j] if j >= n else constant(0.0))
            for i, j in np.ndindex(n, m)
        ]
        names = (str(d) for row in deriv for d in row)
        self._path = _Path(
            Layout((*layout.states, *names), layout.clock, layout.numbers), [*rates, *deriv_rates]
        )
        self._begin = np.eye(n, m).ravel()

    def __call__(
        self, state: np.ndarray, begin: float, end: float, numbers: np.ndarray, out: np.ndarray
    ) -> bool:
        """Write the final state and its derivatives, row by row; return False if the flow diverges."""
        for _ in self._path.steps(np.concatenate([state, self._begin]), begin, end, numbers):
            pass
        out[:] = self._path.final
        return bool(np.isfinite(out).all())


class Watch(_Path):
    """A flow that reports every rise of given functions through zero."""

    def __call__(self, state: np.ndarray, begin: float, end: float, numbers: np.ndarray) -> list[Crossing]:
        """Return (clock, index of the function, state) of every rise through zero between `begin` and `end`."""
        return list(self.crossings(state, begin, end, numbers, rising=True))

    def move(self, state: np.ndarray, begin: float, end: float, numbers: np.ndarray) -> None:
        """Move `state` on, in place, without regard to the functions."""
        for _ in self.steps(state, begin, end, numbers):
            pass
        state[:] = self.final

    def path(self, state: np.ndarray, clocks: np.ndarray, numbers: np.ndarray) -> np.ndarray:
        """Return states, shape (m, n), at the increasing `clocks` (equal ones allowed); `state` is that at the first clock."""
        rows = np.tile(self.nowhere, (len(clocks), 1))
        rows[np.asarray(clocks) <= clocks[0]] = state
        for solver in self.steps(state, float(clocks[0]), float(np.max(clocks)), numbers):
            inside = (clocks > solver.t_old) & (clocks <= solver.t)
            if inside.any():
                rows[inside] = solver.dense_output()(clocks[inside]).T
        return rows


class Run(_Path):
    """A flow that ends at the first fall of one of its functions through zero."""

    def __call__(
        self, state: np.ndarray, begin: float, end: float, numbers: np.ndarray
    ) -> tuple[float, int | None]:
        """Move `state` on, in place; return the clock and the index of the function that ended the flight (None: end reached; -1: divergence)."""
        for clock, place, crossing in self.crossings(state, begin, end, numbers, rising=False):
            state[:] = crossing
            return clock, place
        state[:] = self.final
        return (end, None) if np.isfinite(state).all() else (begin, -1)
