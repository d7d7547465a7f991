"""Motions of a flow seen once per period, beside a cycle; the contract is that of :mod:`contvines.circles.section`.

Of autonomous flows the section is the plane across the cycle at its first mesh point. A point has the states but the one along which the plane
is steepest; of forced flows it has all states. `step` is a simulation by scipy. `images`, many at once and with derivatives, are those of the
return map on the cycle's own mesh.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from contvines.shared.floating_point import CENTRAL, ROUNDED

from . import mesh
from .returns import ReturnMap
from .simulation import rates

SOLVED = 8.0 * ROUNDED  # change of the place at which a cycle passes the plane, in units of the period
SWEEPS = 30
AWAY, LATEST = 0.5, 1.6  # periods after which, and until when, the next passage is looked for


class FlowSection:
    """The section at a parameter value.

    Parameters
    ----------
    returns : ReturnMap
        Of the cycle at which circles are born.
    p : float
    """

    returns_watched = 600  # of a simulation: each takes about as long as a cycle's Newton step

    def __init__(self, returns: ReturnMap, p: float) -> None:
        self.returns, self.p = returns, float(p)
        problem, d = returns.problem, returns.node
        self.free = bool(problem.free_period)
        self.kept, self.chart = np.arange(d), np.eye(d)  # which states a point has; all states from them
        if self.free:
            steep = int(np.argmax(np.abs(returns.normal * returns.scale)))
            self.kept = np.delete(self.kept, steep)
            self.chart = np.zeros((d, d - 1))
            self.chart[self.kept, np.arange(d - 1)] = 1.0
            self.chart[steep] = -returns.normal[self.kept] / returns.normal[steep]
        self.names = tuple(problem.flow.states[j] for j in self.kept)

    def _states(self, x: np.ndarray) -> np.ndarray:
        start = self.returns.start
        return start + (x - start[self.kept]) @ self.chart.T

    def length(self, direction: np.ndarray) -> float:
        """Of a direction of points, as normal forms of cycles measure it: over all states."""
        return float(np.linalg.norm(self.chart @ direction))

    def through(self, u: np.ndarray) -> np.ndarray:
        """The point in which the cycle with these unknowns passes the plane, next to its first mesh point."""
        return self.rounds(u)[0]

    def rounds(self, u: np.ndarray) -> np.ndarray:
        """The same; of forced flows once per period of the forcing."""
        problem, r = self.returns.problem, self.returns
        x, _, widths = problem.parts(u, self.p)
        if not self.free:
            return mesh.evaluate(problem.rule, widths, x, np.arange(problem.rounds) / problem.rounds)
        place, h = 0.0, CENTRAL
        for _ in range(SWEEPS):
            here, ahead, back = mesh.evaluate(
                problem.rule, widths, x, np.array([place, place + h, place - h])
            )
            change = -2.0 * h * float((here - r.start) @ r.normal) / float((ahead - back) @ r.normal)
            place += change
            if abs(change) < SOLVED:
                break
        return mesh.evaluate(problem.rule, widths, x, np.array([place]))[:, self.kept]

    def step(self, x: np.ndarray) -> np.ndarray:
        """The next point, by simulation; NaN where the motion does not come back."""
        from scipy.integrate import solve_ivp

        r, field, start = self.returns, self.returns.field, self._states(np.asarray(x, dtype=float))
        s = field.settings
        options: dict[str, Any] = {"method": "DOP853", "rtol": s.relative, "atol": s.absolute * r.scale}
        rate, lost = rates(field, self.p), np.full(len(self.kept), np.nan)
        if not np.isfinite(start).all():
            return lost
        if not self.free:
            length = r.rounds * float(field.length_of_period(self.p))
            found = solve_ivp(rate, (0.0, length), start, **options)
            return found.y[:, -1] if found.success else lost

        def height(t: float, y: np.ndarray) -> float:
            return float((y - r.start) @ r.normal)

        height.terminal, height.direction = True, 1.0  # pyright: ignore[reportFunctionMemberAccess]
        half = solve_ivp(rate, (0.0, AWAY * r.period), start, **options)
        if not half.success:
            return lost
        found = solve_ivp(rate, (half.t[-1], LATEST * r.period), half.y[:, -1], events=height, **options)
        return found.y_events[0][0][self.kept] if found.status == 1 else lost

    def images(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """The next points (n, k), their derivatives by the points, (n, k, k), and by the parameter, (n, k)."""
        r = self.returns
        found, by_state, by_value = r.varied(r.coordinates(self._states(points)), self.p)
        out, into = r.basis[self.kept], r.inverse @ self.chart
        slopes = np.einsum("ka,nab,bl->nkl", out, by_state, into)
        return r.states(found)[:, self.kept], slopes, by_value @ out.T
