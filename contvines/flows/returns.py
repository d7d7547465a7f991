"""ReturnMap: motions beside a cycle, from one return to the next, many at once, with derivatives.

The section is the plane across the cycle at its first mesh point (of forced flows: all states); its coordinates y are orthonormal in the
scale of the cycle's states. Motions are solved by the collocation equations of the cycle's own mesh, interval by interval, with Newton's method: the cycle
is a fixed point exactly, and the derivative of the map there has its multipliers. Autonomous motions go on for the period of the cycle, then by one more step to
the plane.
"""

from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from contvines.shared.floating_point import ROUNDED

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
        r, d, m = self.rule, self.node, self.rule.degree
        jacobian = self._jacobian(self._points(whole), p, times).reshape(-1, m, d, d)
        blocks = np.einsum("cj,ncab->ncajb", r.values, -steps[:, None, None, None] * jacobian)
        diagonal = np.arange(d)
        blocks[:, :, diagonal, :, diagonal] += r.slopes
        return blocks.reshape(-1, m * d, (m + 1) * d)

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
