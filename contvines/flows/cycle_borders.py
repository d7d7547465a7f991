"""CycleBorders: where branches of cycles end, at homoclinic orbits and at events."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from contvines.shared.floating_point import TINY

from ..problems.functions import NotEvaluable
from ..problems.protocol import margin_of
from . import mesh
from .cycle_mesh import CycleMesh
from .events import FINER
from .kernels import CycleWork
from .nearby_equilibrium import nearby_equilibrium
from .sparse import distance_to_rest as rest_of_sparse

if TYPE_CHECKING:
    from ..problems.protocol import BorderPoint

NEARLY = 10.0  # times the distance at which a cycle is homoclinic: so near it must be in each coordinate


class CycleBorders(CycleMesh):
    """How far a cycle is from being homoclinic, and from the events that stop it."""

    def margins(self, u: np.ndarray, work: CycleWork) -> np.ndarray:
        """How far the cycle stays away from equilibria, relative to its size, and its period from infinity: log10 of the part that is left; then the events."""
        p = work.along[1]
        if not len(self.flow.events):
            return self._from_homoclinic(u, work)
        touching = self._closest(u, p)[0]
        return np.append(self._from_homoclinic(u, work), touching) if self.free_period else touching

    def margin_kind(self, j: int) -> str:
        """A cycle that comes near to an equilibrium ends as a homoclinic orbit; else it touches an event."""
        own = 2 * self.free_period
        return "homoclinic" if j < own else self.flow.border_kind(j - own)

    # ------------------------------------------------------------------ homoclinic orbits
    def _from_homoclinic(self, u: np.ndarray, work: CycleWork) -> np.ndarray:
        x, s = u[: self.states].reshape(-1, self.node), self.flow.settings
        each = np.ascontiguousarray(x.T)  # sums over rows are ten times as fast
        size = float(((each.max(axis=1) - each.min(axis=1)) / self.node_scale).max())
        short = math.log10(s.longest * self.clock / max(float(u[self.states]), TINY))
        _, _, jacobian, f = work.along
        closeness = None if work.core is None else work.core.distance_to_rest(jacobian, f)
        if work.sparse is not None:
            closeness = rest_of_sparse(work.sparse.pattern, jacobian, f, self.node_scale)
        elif closeness is None:
            scaled = jacobian * (self.node_scale / self.node_scale[:, None])
            closeness = _distance_to_rest(scaled, f / self.node_scale)
        if work.sparse is None and closeness < NEARLY * s.homoclinic * size:
            closeness = max(closeness, size * self._from_equilibrium(x, work) / NEARLY)
        if not size > 0.0 or not closeness < math.inf:
            return np.array([math.inf, short])
        return np.array([math.log10(max(closeness / size, TINY) / s.homoclinic), short])

    def _from_equilibrium(self, x: np.ndarray, work: CycleWork) -> float:
        """The distance from the equilibrium to which the shortest Newton step leads, relative to the size of the cycle in each coordinate; infinite where it leads to none.

        Coordinates of fast and slow motions differ in size, and where a slow manifold folds, a step of Newton's method is short and no equilibrium near.
        """
        _, p, jacobian, f = work.along
        try:
            steps = np.linalg.solve(jacobian, f[..., None])[..., 0] / self.node_scale
            points = self._at_gauss_points(self.rule.values, x.reshape(self.intervals, -1, self.node))
            start = points[int(np.nanargmin((steps**2).sum(axis=1)))]
            sizes = self._sizes(x)
            place = nearby_equilibrium(self, start, p, sizes)
        except (np.linalg.LinAlgError, NotEvaluable, ValueError):
            return math.inf
        return math.inf if place is None else float(np.linalg.norm((place - start) / sizes))

    def from_rest(self, u: np.ndarray, p: float) -> float:
        """How near the cycle comes to an equilibrium, relative to its size in each direction: the same in all coordinates of the states, as beside Bogdanov-Takens
        points, where cycles are flat."""
        s, work = self.flow.settings, self.workspace()
        self.evaluate(u, p, work)
        _, _, jacobian, f = work.along
        if work.sparse is not None:
            return s.homoclinic * 10.0 ** float(self._from_homoclinic(u, work)[0])
        x = u[: self.states].reshape(-1, self.node) / self.node_scale
        axes = np.linalg.svd(x - x.mean(axis=0), full_matrices=False)[2]
        sizes = np.ptp(x @ axes.T, axis=0)
        back = self.node_scale[:, None] * axes.T * np.maximum(sizes, s.smallest * sizes.max())
        return max(_distance_to_rest(jacobian @ back, f), TINY)

    def remaining(self, u: np.ndarray, tangent: np.ndarray) -> float:
        """How far the parameter may be from that of an infinite period: of a saddle-node p - p* is as 1 / T^2 to first order, taken twice; of a saddle less is left."""
        change = abs(float(tangent[self.states]))
        return float(u[self.states]) * abs(float(tangent[-1])) / change if change > 0.0 else 0.0

    # ------------------------------------------------------------------ events
    def _closest(self, u: np.ndarray, p: float) -> tuple[np.ndarray, np.ndarray]:
        """The smallest value of each event along the cycle, and where."""
        x, period, widths = self.parts(u, p)
        inside = np.arange(FINER * self.rule.degree) / (FINER * self.rule.degree)
        edges = mesh.places(widths, inside)
        try:
            return self.flow.events.closest(
                lambda places: mesh.evaluate(self.rule, widths, x, places), edges, period, self.values.at(p)
            )
        except NotEvaluable:
            nothing = np.full(len(self.flow.events), np.nan)
            return nothing, nothing

    def crossed(self, u: np.ndarray, p: float) -> str | None:
        """The name of an event that the cycle crosses, by more than the curve may be off; None if there is none."""
        for k, name in enumerate(self.flow.events.names):
            if self._closest(u, p)[0][k] < -self._missed(u, p, k):
                return name
        return None

    def _missed(self, u: np.ndarray, p: float, k: int) -> float:
        """By how much the smallest value of an event may be off: the curve is known less well between the mesh points than there."""
        (x, when), sizes = self.touching(u, p, k), self._sizes(self._curve(u)[0])
        touch = self.flow.settings.touch
        moved = x + touch * np.concatenate([np.diag(sizes), -np.diag(sizes)])
        values = self.flow.events(moved, self.values.at(p), np.full(len(moved), when))[:, k].reshape(2, -1)
        return float(self.estimated_error(u) * np.abs(values[0] - values[1]).sum() / (2.0 * touch))

    def touching(self, u: np.ndarray, p: float, k: int) -> tuple[np.ndarray, float]:
        """The state in which the cycle comes closest to event k, and when."""
        x, period, widths = self.parts(u, p)
        place = self._closest(u, p)[1][k : k + 1]
        return mesh.evaluate(self.rule, widths, x, place)[0], float(place[0] * period)

    def touch_error(self, point: BorderPoint) -> float:
        """By how much the parameter at which a cycle touches an event may be off."""
        k = margin_of(point) - 2 * self.free_period
        missed = self._missed(point.u, float(point.value), k)
        step = self.flow.settings.touch / max(
            float(np.abs(point.tangent[:-1] / self.column_scale).max()), TINY
        )
        ends = [
            self._closest(
                point.u + s * step * point.tangent[:-1], point.value + s * step * point.tangent[-1]
            )[0][k]
            for s in (1.0, -1.0)
        ]
        slope = abs(ends[0] - ends[1]) / (2.0 * step)
        return float(missed * abs(point.tangent[-1]) / slope) if slope > 0.0 else float("inf")


def _distance_to_rest(matrices: np.ndarray, rates: np.ndarray) -> float:
    """The shortest Newton step to an equilibrium from points with Jacobians (n, d, d) and rates (n, d); infinite if there is none."""
    try:
        steps = np.linalg.solve(matrices, rates[..., None])[..., 0]
    except np.linalg.LinAlgError:  # one of them is singular to the last bit
        steps = np.matmul(np.linalg.pinv(matrices), rates[..., None])[..., 0]
    sizes = np.sqrt((steps**2).sum(axis=-1))
    return float(np.nanmin(sizes)) if np.isfinite(sizes).any() else np.inf
