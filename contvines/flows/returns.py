"""ReturnMap: motions beside a cycle, from one return to the next, many at once, with derivatives.

The section is the plane across the cycle at its first mesh point (of forced flows: all states); its coordinates y are orthonormal in the
scale of the cycle's states. Motions are solved by the collocation equations of the cycle's own mesh, interval by interval, with Newton's method: the cycle
is a fixed point exactly, and the derivative of the map there has its multipliers. Autonomous motions go on for the period of the cycle, then by one more step to
the plane.
"""

from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from contvines.shared.floating_point import CENTRAL, ROUNDED

from ..problems.functions import NotEvaluable
from . import mesh

if TYPE_CHECKING:
    from collections.abc import Callable

    from .cycle_mesh import CycleMesh


SWEEPS = 20  # of Newton's method in an interval
QUICK = 0.1  # part of the last correction above which slopes are renewed


class Step(NamedTuple):
    """Where motions are after an interval, shape (n, d), with derivatives by where they were, (n, d, d), and by the parameter, (n, d)."""

    end: np.ndarray
    by_state: np.ndarray
    by_value: np.ndarray


class ReturnMap:
    """The map from one return to the next beside a cycle.

    Parameters
    ----------
    problem : CycleMesh
    u, p
        A cycle.

    Attributes
    ----------
    start : ndarray, shape (d,)
        The cycle on the section, where y = 0.
    basis : ndarray, shape (d, k)
        A state on the section is ``start + basis @ y``.
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
            across = np.linalg.qr(plane / self.scale[:, None])[0]
            self.normal = speed / np.linalg.norm(speed)
        else:
            across, self.normal = np.eye(self.node), np.zeros(self.node)
        self.basis, self.inverse = self.scale[:, None] * across, across.T / self.scale

    def states(self, y: np.ndarray) -> np.ndarray:
        """States at points of the section, shape (n, d)."""
        return self.start + y @ self.basis.T

    def coordinates(self, states: np.ndarray) -> np.ndarray:
        """Points of the section, shape (n, k)."""
        return (states - self.start) @ self.inverse.T

    def __call__(self, y: np.ndarray, p: float | None = None) -> np.ndarray:
        """The next points, shape (n, k); NaN where a motion does not come back."""
        return self.coordinates(self._returned(self.states(np.atleast_2d(y)), p, False).end)

    def varied(self, y: np.ndarray, p: float | None = None) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """The next points, their derivatives by the points, (n, k, k), and by the parameter, (n, k)."""
        found = self._returned(self.states(np.atleast_2d(y)), p, True)
        by_state = np.einsum("ka,nab,bl->nkl", self.inverse, found.by_state, self.basis)
        return self.coordinates(found.end), by_state, found.by_value @ self.inverse.T

    # ------------------------------------------------------------------ motions
    def _returned(self, x: np.ndarray, p: float | None, derivatives: bool) -> Step:
        p = self.p if p is None else float(p)
        x = np.array(x, dtype=float)
        ahead = np.broadcast_to(np.eye(self.node), (len(x), self.node, self.node)).copy()
        slope, moved = np.zeros_like(x), x - self.nodes[0, 0]
        with np.errstate(all="ignore"):
            for i in range(len(self.widths)):
                guess = self.nodes[i][None, 1:] + moved[:, None, :]
                step = self._through(x, guess, i, p, derivatives)
                if derivatives:
                    slope = np.einsum("nab,nb->na", step.by_state, slope) + step.by_value
                    ahead = np.matmul(step.by_state, ahead)
                x = step.end
                moved = x - self.nodes[i, -1]
            if self.problem.free_period:
                step = self._onto_plane(x, p, derivatives)
                if derivatives:
                    slope = np.einsum("nab,nb->na", step.by_state, slope) + step.by_value
                    ahead = np.matmul(step.by_state, ahead)
                x = step.end
        return Step(x, ahead, slope)

    def _length(self, p: complex) -> complex:
        return self.period if self.problem.free_period else self.rounds * self.field.length_of_period(p)

    def _through(self, x: np.ndarray, guess: np.ndarray, i: int, p: float, derivatives: bool) -> Step:
        """Through an interval of the mesh."""
        r, count = self.rule, len(x)
        places = self.begins[i] + self.widths[i] * r.points

        def rate(points: np.ndarray, q: complex) -> np.ndarray:
            length = self._length(q)
            times = np.tile(length * places, count) if self.field.forced else None
            return length * self.widths[i] * self.field(points, q, times)

        step = float(np.real(self._length(p))) * self.widths[i]
        times = np.tile(float(np.real(self._length(p))) * places, count) if self.field.forced else None
        steps = np.full(count, step)
        nodes = self._solved(x, guess, steps, p, times, self.nodes[i][None])
        end = nodes[:, -1]
        if not derivatives:
            return Step(end, np.empty(0), np.empty(0))

        def by(points: np.ndarray) -> np.ndarray:
            return self.field.along(lambda q: rate(points, q), p)

        found = self._varied(x, nodes, steps, p, times, by)
        return Step(end, found[:, :, :-1], found[:, :, -1])

    def _onto_plane(self, x: np.ndarray, p: float, derivatives: bool) -> Step:
        """By one step of each motion's own length."""
        speed = self._rates(x, p)
        time = -((x - self.start) @ self.normal) / (speed @ self.normal)
        nodes = np.repeat(x[:, None, :], self.rule.degree, axis=1)
        for _ in range(SWEEPS):
            nodes = self._solved(x, nodes, time, p, None)
            end = nodes[:, -1]
            speed = self._rates(end, p)
            change = -((end - self.start) @ self.normal) / (speed @ self.normal)
            time = time + change
            if not (np.abs(change) > ROUNDED * self.period).any():
                break
        far = ~(np.abs(time) < 0.5 * self.period)
        nodes = self._solved(x, nodes, time, p, None)
        end = nodes[:, -1].copy()
        end[far] = np.nan
        if not derivatives:
            return Step(end, np.empty(0), np.empty(0))

        def by(points: np.ndarray) -> np.ndarray:
            return np.repeat(time, self.rule.degree)[:, None] * self.field.slope(points, p)

        found = self._varied(x, nodes, time, p, None, by)
        speed = self._rates(end, p)
        off = np.einsum("a,nab->nb", self.normal, found) / (speed @ self.normal)[:, None]
        found = found - speed[:, :, None] * off[:, None, :]
        return Step(end, found[:, :, :-1], found[:, :, -1])

    def _varied(
        self,
        x: np.ndarray,
        nodes: np.ndarray,
        steps: np.ndarray,
        p: float,
        times: np.ndarray | None,
        by: Callable[[np.ndarray], np.ndarray],
    ) -> np.ndarray:
        """Derivatives of the ends by where motions were and, in the last column, by the parameter, (n, d, d + 1)."""
        d, m, count = self.node, self.rule.degree, len(x)
        whole = np.concatenate([x[:, None, :], nodes], axis=1)
        slopes = self._slopes(whole, steps, p, times)
        points = self._points(whole)
        last = by(points) if np.isfinite(points).all() else np.zeros((count * m, d))
        sides = np.concatenate([-slopes[..., :d], last.reshape(count, m * d, 1)], axis=2)
        return self._linear(slopes[..., d:], sides)[:, -d:]

    def _points(self, whole: np.ndarray) -> np.ndarray:
        """The Gauss points, shape (n m, d)."""
        return np.matmul(self.rule.values, whole).reshape(-1, self.node)

    def _slopes(self, whole: np.ndarray, steps: np.ndarray, p: float, times: np.ndarray | None) -> np.ndarray:
        """Derivatives of the equations by the values at the nodes, the first one among them, shape (n, m d, (m + 1) d)."""
        jacobian = self._jacobian(self._points(whole), p, times)
        return self.rule.blocks(np.repeat(steps, self.rule.degree)[:, None, None] * jacobian)

    def _solved(
        self,
        x: np.ndarray,
        guess: np.ndarray,
        steps: np.ndarray,
        p: float,
        times: np.ndarray | None,
        beside: np.ndarray | None = None,
    ) -> np.ndarray:
        """Values at the nodes but the first, (n, m, d); NaN where there are none.

        Slopes are those at a known motion, `beside`, as long as corrections shrink quickly, then those of each motion itself.
        """
        d, m, count = self.node, self.rule.degree, len(x)
        nodes, last, inverse = np.array(guess), np.full(count, np.inf), np.empty(0)
        slow, rounded = beside is None, self.field.settings.rounded
        for sweep in range(SWEEPS):
            whole = np.concatenate([x[:, None, :], nodes], axis=1)
            if slow or sweep == 0:
                known, own = (
                    (whole, times)
                    if beside is None or slow
                    else (beside, times if times is None else times[:m])
                )
                inverse = self._inverse(self._slopes(known, steps[: len(known)], p, own)[..., d:])
            rates = self._rates(self._points(whole), p, times).reshape(count, m, d)
            residual = np.matmul(self.rule.slopes, whole) - steps[:, None, None] * rates
            change = -np.matmul(inverse, residual.reshape(count, m * d, 1)).reshape(count, m, d)
            nodes = nodes + change
            size = np.abs(change / (self.scale + np.abs(nodes))).max(axis=(1, 2))
            done = (size < ROUNDED) | ((size < rounded) & (size > 0.3 * last)) | ~np.isfinite(size)
            slow, last = bool((size > QUICK * last)[~done].any()), size
            if done.all():
                break
        nodes[~(last < rounded)] = np.nan
        return nodes

    @staticmethod
    def _inverse(matrix: np.ndarray) -> np.ndarray:
        found = np.full(matrix.shape, np.nan)
        good = np.isfinite(matrix).all(axis=(1, 2))
        with contextlib.suppress(np.linalg.LinAlgError):
            found[good] = np.linalg.inv(matrix[good])
        return found

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
        """A function of states at those that are finite; NaN elsewhere."""
        good = np.isfinite(x).all(axis=1)
        found = np.full((len(x), *shape), np.nan)
        if good.any():
            with contextlib.suppress(NotEvaluable):
                found[good] = f(x[good], None if times is None else times[good])
        return found


SOLVED = 8.0 * ROUNDED  # change of the place at which a cycle passes the plane, in units of the period
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
        rate, lost = field.rate_at(self.p), np.full(len(self.kept), np.nan)
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
