"""Return map near a cycle, with derivatives and for many points at once; and the section of a flow for invariant circles.

The section is the plane across the cycle at its first mesh point (for forced flows: all states); its coordinates y are orthonormal in units of
the scales of the states. Motions are computed by the collocation equations on the cycle's mesh, interval by interval, with Newton's method, so that
the cycle is exactly a fixed point, and the derivative of the map there has exactly its multipliers. Motions of an autonomous flow are computed for the
period of the cycle, and then by one more step onto the plane.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from contvines.shared.numbers import CENTRAL, ROUNDED

from ..problems.functions import NotEvaluable
from . import mesh

if TYPE_CHECKING:
    from .cycle_mesh import CycleMesh


SWEEPS = 20  # most steps of Newton's method
QUICK = 0.1  # if a correction shrinks by less than this factor, the Jacobian is evaluated again
SOLVED = 8.0 * ROUNDED  # accuracy of the time at which a cycle crosses the plane, in units of the period
EARLIEST, LATEST = 0.5, 1.6  # earliest and latest time of the next crossing, in periods

#: motions through one interval: ends, values at the nodes, durations, times at the Gauss points, and a function for the derivative of duration times rate by the parameter
Flight = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray | None, Callable[[np.ndarray], np.ndarray]]


class ReturnMap:
    """Map from one return to the next near a cycle.

    Parameters
    ----------
    problem : CycleMesh
    u, p
        A cycle.

    Attributes
    ----------
    start : ndarray, shape (d,)
        Point of the cycle on the section; its coordinates are y = 0.
    basis : ndarray, shape (d, k)
        States on the section are ``start + basis @ y``.
    """

    def __init__(self, problem: CycleMesh, u: np.ndarray, p: float) -> None:
        self.problem, self.rule, self.field, self.p = problem, problem.rule, problem.field, float(p)
        x, period, self.widths = problem.parts(u, p)
        self.period, self.rounds = float(period), problem.rounds
        self.nodes, self.node, self.scale = mesh.closed(x), problem.node, problem.node_scale
        self.start = x[0, 0].copy()
        self.begins = np.append(0.0, np.cumsum(self.widths)[:-1])
        if problem.free_period:
            speed = self.field(self.start[None, :], self.p)[0]
            plane = np.linalg.qr(speed[:, None], mode="complete")[0][:, 1:]
            plane_basis = np.linalg.qr(plane / self.scale[:, None])[0]
            self.normal = speed / np.linalg.norm(speed)
        else:
            plane_basis, self.normal = np.eye(self.node), np.zeros(self.node)
        self.basis, self.inverse = self.scale[:, None] * plane_basis, plane_basis.T / self.scale

    def states(self, y: np.ndarray) -> np.ndarray:
        """Return the states at points of the section, shape (n, d)."""
        return self.start + y @ self.basis.T

    def coordinates(self, states: np.ndarray) -> np.ndarray:
        """Return the section coordinates of states, shape (n, k)."""
        return (states - self.start) @ self.inverse.T

    def __call__(self, y: np.ndarray) -> np.ndarray:
        """Return the next points, shape (n, k); NaN where a motion does not return."""
        return self.coordinates(self._returned(self.states(np.atleast_2d(y)), self.p, False)[0])

    def varied(self, y: np.ndarray, p: float | None = None) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return the next points, their derivatives by the points, shape (n, k, k), and by the parameter, shape (n, k)."""
        end, found = self._returned(self.states(np.atleast_2d(y)), self.p if p is None else p, True)
        by_state = np.einsum("ka,nab,bl->nkl", self.inverse, found[:, :, :-1], self.basis)
        return self.coordinates(end), by_state, found[:, :, -1] @ self.inverse.T

    # ------------------------------------------------------------------ motions
    def _returned(self, x: np.ndarray, p: float, derivatives: bool) -> tuple[np.ndarray, np.ndarray]:
        """States at the next return, and their derivatives by the initial states and, in the last column, by the parameter, shape (n, d, d + 1)."""
        d, x = self.node, np.array(x, dtype=float)
        total = np.tile(np.eye(d, d + 1), (len(x), 1, 1))
        with np.errstate(all="ignore"):
            for i in range(len(self.widths) + self.problem.free_period):
                through = self._through_interval(i, x, p) if i < len(self.widths) else self._onto_plane(x, p)
                x, nodes, steps, times, by_parameter = through
                if derivatives:
                    varied = self._varied(nodes, steps, p, times, by_parameter)
                    if i == len(self.widths):
                        speed = self._rates(x, p)
                        delays = np.einsum("a,nab->nb", self.normal, varied) / (speed @ self.normal)[:, None]
                        varied = varied - speed[:, :, None] * delays[:, None, :]
                    total = np.matmul(varied[:, :, :d], total)
                    total[:, :, d] += varied[:, :, d]
        return x, total

    def _through_interval(self, i: int, x: np.ndarray, p: float) -> Flight:
        """Compute motions through interval i of the mesh."""
        field, count, width = self.field, len(x), self.widths[i]
        places = self.begins[i] + width * self.rule.points

        def length(q: complex) -> complex:
            return self.period if self.problem.free_period else self.rounds * field.length_of_period(q)

        def times(q: complex) -> np.ndarray | None:
            return np.tile(length(q) * places, count) if field.forced else None

        def by_parameter(points: np.ndarray) -> np.ndarray:
            return field.along(lambda q: length(q) * width * field(points, q, times(q)), p)

        steps, time = np.full(count, float(np.real(length(p))) * width), times(p)
        guess = self.nodes[i][None, 1:] + (x - self.nodes[i, 0])[:, None, :]
        nodes = self._solved(x, guess, steps, p, time, self.nodes[i][None])
        return nodes[:, -1], nodes, steps, time, by_parameter

    def _onto_plane(self, x: np.ndarray, p: float) -> Flight:
        """Compute motions onto the plane, by one step of a duration of its own for each."""

        def until(x: np.ndarray) -> np.ndarray:
            return -((x - self.start) @ self.normal) / (self._rates(x, p) @ self.normal)

        def by_parameter(points: np.ndarray) -> np.ndarray:
            return np.repeat(time, self.rule.degree)[:, None] * self.field.slope(points, p)

        time, nodes = until(x), np.repeat(x[:, None, :], self.rule.degree + 1, axis=1)
        for _ in range(SWEEPS):
            nodes = self._solved(x, nodes[:, 1:], time, p, None)
            change = until(nodes[:, -1])
            time = time + change
            if not (np.abs(change) > ROUNDED * self.period).any():
                break
        nodes = self._solved(x, nodes[:, 1:], time, p, None)
        end = nodes[:, -1].copy()
        end[~(np.abs(time) < 0.5 * self.period)] = np.nan
        return end, nodes, time, None, by_parameter

    def _varied(
        self,
        nodes: np.ndarray,
        steps: np.ndarray,
        p: float,
        times: np.ndarray | None,
        by_parameter: Callable[[np.ndarray], np.ndarray],
    ) -> np.ndarray:
        """Derivatives of the ends by the initial states and, in the last column, by the parameter, shape (n, d, d + 1)."""
        d, inner = self.node, self.rule.degree * self.node
        slopes, points = self._slopes(nodes, steps, p, times), self._points(nodes)
        last = by_parameter(points) if np.isfinite(points).all() else np.zeros_like(points)
        sides = np.concatenate([-slopes[..., :d], last.reshape(-1, inner, 1)], axis=2)
        return self._linear(slopes[..., d:], sides)[:, -d:]

    def _points(self, whole: np.ndarray) -> np.ndarray:
        """States at the Gauss points, shape (n m, d)."""
        return np.matmul(self.rule.values, whole).reshape(-1, self.node)

    def _slopes(self, whole: np.ndarray, steps: np.ndarray, p: float, times: np.ndarray | None) -> np.ndarray:
        """Derivatives of the equations by the values at all nodes, shape (n, m d, (m + 1) d)."""
        jacobian = self._jacobian(self._points(whole), p, times)
        return self.rule.blocks(np.repeat(steps, self.rule.degree)[:, None, None] * jacobian)

    def _solved(
        self,
        x: np.ndarray,
        guess: np.ndarray,
        steps: np.ndarray,
        p: float,
        times: np.ndarray | None,
        base: np.ndarray | None = None,
    ) -> np.ndarray:
        """Solve for the values at the nodes, shape (n, m + 1, d), from a guess of all but the first; NaN where Newton's method fails.

        The Jacobian at a known motion, `base`, is used for all motions while corrections shrink quickly, then the Jacobian of each motion.
        """
        d, inner, count = self.node, self.rule.degree * self.node, len(x)
        nodes, last, inverse = (
            np.concatenate([x[:, None, :], guess], axis=1),
            np.full(count, np.inf),
            np.empty(0),
        )
        slow, rounded = base is None, self.field.settings.rounded
        for sweep in range(SWEEPS):
            if slow or sweep == 0:
                if base is None or slow:
                    slopes = self._slopes(nodes, steps, p, times)
                else:
                    first_times = None if times is None else times[: self.rule.degree]
                    slopes = self._slopes(base, steps[:1], p, first_times)
                inverse = self._linear(
                    slopes[..., d:], np.broadcast_to(np.eye(inner), (len(slopes), inner, inner))
                )
            rates = self._rates(self._points(nodes), p, times).reshape(count, -1, d)
            residual = np.matmul(self.rule.slopes, nodes) - steps[:, None, None] * rates
            change = -np.matmul(inverse, residual.reshape(count, inner, 1)).reshape(residual.shape)
            nodes[:, 1:] += change
            size = np.abs(change / (self.scale + np.abs(nodes[:, 1:]))).max(axis=(1, 2))
            done = (size < ROUNDED) | ((size < rounded) & (size > 0.3 * last)) | ~np.isfinite(size)
            slow, last = bool((size > QUICK * last)[~done].any()), size
            if done.all():
                break
        nodes[~(last < rounded), 1:] = np.nan
        return nodes

    @staticmethod
    def _linear(matrix: np.ndarray, sides: np.ndarray) -> np.ndarray:
        good = np.isfinite(matrix).all(axis=(1, 2)) & np.isfinite(sides).all(axis=(1, 2))
        found = np.full(sides.shape, np.nan)
        with contextlib.suppress(np.linalg.LinAlgError):
            found[good] = np.linalg.solve(matrix[good], sides[good])
        return found

    def _rates(self, x: np.ndarray, p: float, times: np.ndarray | None = None) -> np.ndarray:
        return self._evaluated(lambda y, t: self.field(y, p, t), x, times, (self.node,))

    def _jacobian(self, x: np.ndarray, p: float, times: np.ndarray | None) -> np.ndarray:
        return self._evaluated(lambda y, t: self.field.jacobian(y, p, t), x, times, (self.node, self.node))

    def _evaluated(
        self, f: Callable, x: np.ndarray, times: np.ndarray | None, shape: tuple[int, ...]
    ) -> np.ndarray:
        """Evaluate a function at the states that are finite; NaN for the others."""
        good = np.isfinite(x).all(axis=1)
        found = np.full((len(x), *shape), np.nan)
        if good.any():
            with contextlib.suppress(NotEvaluable):
                found[good] = f(x[good], None if times is None else times[good])
        return found


class FlowSection:
    """Section of a flow; the contract is in :mod:`contvines.circles.section`.

    The coordinates of a point are all states except the one with the largest component of the plane's normal; for forced flows all states.
    `step` is a simulation by scipy; `images` uses the return map, for many points at once and with derivatives.

    Parameters
    ----------
    returns : ReturnMap
        Return map of the cycle at which circles are born.
    p : float
    """

    # most returns of a simulation: each costs about as much as a Newton step of a cycle
    returns_watched = 600

    def __init__(self, returns: ReturnMap, p: float) -> None:
        self.returns, self.p = returns, float(p)
        problem, d = returns.problem, returns.node
        self.free = bool(problem.free_period)
        # states that are coordinates; matrix from these to all states
        self.columns, self.chart = np.arange(d), np.eye(d)
        if self.free:
            steep = int(np.argmax(np.abs(returns.normal * returns.scale)))
            self.columns = np.delete(self.columns, steep)
            self.chart = np.zeros((d, d - 1))
            self.chart[self.columns, np.arange(d - 1)] = 1.0
            self.chart[steep] = -returns.normal[self.columns] / returns.normal[steep]
        self.names = tuple(problem.flow.states[j] for j in self.columns)

    def _states(self, x: np.ndarray) -> np.ndarray:
        start = self.returns.start
        return start + (x - start[self.columns]) @ self.chart.T

    def length(self, direction: np.ndarray) -> float:
        """Return the length of a direction for normal forms of cycles: the norm over all states."""
        return float(np.linalg.norm(self.chart @ direction))

    def through(self, u: np.ndarray) -> np.ndarray:
        """Return the point in which the cycle with these unknowns crosses the plane, near its first mesh point."""
        return self.rounds(u)[0]

    def rounds(self, u: np.ndarray) -> np.ndarray:
        """Return this point as an array of one row; for forced flows a point for each period of the forcing."""
        problem, r = self.returns.problem, self.returns
        x, _, widths = problem.parts(u, self.p)
        if not self.free:
            return mesh.evaluate(problem.rule, widths, x, np.arange(problem.rounds) / problem.rounds)
        place, h = 0.0, CENTRAL
        for _ in range(SWEEPS):
            point, ahead, back = mesh.evaluate(
                problem.rule, widths, x, np.array([place, place + h, place - h])
            )
            change = -2.0 * h * float((point - r.start) @ r.normal) / float((ahead - back) @ r.normal)
            place += change
            if abs(change) < SOLVED:
                break
        return mesh.evaluate(problem.rule, widths, x, np.array([place]))[:, self.columns]

    def step(self, x: np.ndarray) -> np.ndarray:
        """Return the next point by simulation; NaN if the motion does not return."""
        from scipy.integrate import solve_ivp

        r, field, start = self.returns, self.returns.field, self._states(np.asarray(x, dtype=float))
        s = field.settings
        options: dict[str, Any] = {"method": "DOP853", "rtol": s.relative, "atol": s.absolute * r.scale}
        rate, lost = field.rate_at(self.p), np.full(len(self.columns), np.nan)
        if not np.isfinite(start).all():
            return lost
        if not self.free:
            length = r.rounds * float(field.length_of_period(self.p))
            found = solve_ivp(rate, (0.0, length), start, **options)
            return found.y[:, -1] if found.success else lost

        def height(t: float, y: np.ndarray) -> float:
            return float((y - r.start) @ r.normal)

        height.terminal, height.direction = True, 1.0  # pyright: ignore[reportFunctionMemberAccess]
        half = solve_ivp(rate, (0.0, EARLIEST * r.period), start, **options)
        if not half.success:
            return lost
        found = solve_ivp(rate, (half.t[-1], LATEST * r.period), half.y[:, -1], events=height, **options)
        return found.y_events[0][0][self.columns] if found.status == 1 else lost

    def images(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return the next points (n, k), their derivatives by the points, (n, k, k), and by the parameter, (n, k)."""
        r = self.returns
        found, by_state, by_value = r.varied(r.coordinates(self._states(points)), self.p)
        chart, lift = r.basis[self.columns], r.inverse @ self.chart
        slopes = np.einsum("ka,nab,bl->nkl", chart, by_state, lift)
        return r.states(found)[:, self.columns], slopes, by_value @ chart.T
