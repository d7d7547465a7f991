"""CycleRelatives: symmetries of cycles, cycles of twice and of half the period, identity of cycles, and margins at which branches end."""

from __future__ import annotations

import math
from collections.abc import Hashable
from typing import TYPE_CHECKING, Self

import numpy as np

from contvines.shared.numbers import TINY

from ..problems.functions import NotEvaluable
from ..problems.protocol import Embedding, Symmetry, margin_of
from ..problems.symmetries import in_order
from . import mesh
from .cycle_mesh import CycleMesh
from .field import FINER
from .infinite_period import nearby_equilibrium
from .work import CycleWork, distance_to_rest, workspace

if TYPE_CHECKING:
    from ..problems.algebraic import AlgebraicProblem
    from ..problems.protocol import BorderPoint

MEANS = 20  # most means per state in `canonical`: as many as values on a mesh of ten intervals of degree two
NEARLY = 10.0  # multiple of the homoclinic distance at which the distance in each coordinate is computed, too


class CycleRelatives(CycleMesh):
    """Symmetries and identity of cycles, cycles of half and of twice the period, and the distances from homoclinic orbits and events."""

    def _symmetries(self) -> list[Symmetry]:
        found, mirror = [], self.flow.mirror
        even, free = self.intervals % 2 == 0, bool(self.free_period)
        if even and self.copies % 2 == 0 and (free or self.rounds % 2 == 0):
            found.append(
                Symmetry("period-doubling", self._half_later, self._root, self._kind_at if free else None)
            )
        elif even and free:
            found.append(Symmetry("hopf", self._half_later, self._root))
        shifted = self.flow.mirror_shifted
        if mirror is not None and even and (free or shifted != (self.rounds % 2 == 0)):
            found.append(Symmetry("symmetry-breaking", lambda u: self._mirrored(self._half_later(u))))
        if mirror is not None and (free or not shifted):
            found.append(Symmetry("symmetry-breaking", self._mirrored))
        return found

    def _kind_at(self, u: np.ndarray) -> str:
        """Kind of a cycle that is equal to itself half a period later: "hopf" (an equilibrium) or "period-doubling" (a cycle of half the period)."""
        y = u[: self.states].reshape(-1, self.node) / self.node_scale
        return "hopf" if np.ptp(y, axis=0).max() < self.flow.settings.at_rest else "period-doubling"

    def _half_later(self, u: np.ndarray) -> np.ndarray:
        x = u[: self.states].reshape(self.intervals, -1)
        return np.append(np.roll(x, self.intervals // 2, axis=0), u[self.states :])

    def _mirrored(self, u: np.ndarray) -> np.ndarray:
        return np.append(self.flow.mirrored(u[: self.states].reshape(-1, self.node)), u[self.states :])

    def _root(self, u: np.ndarray) -> tuple[AlgebraicProblem | Self, np.ndarray]:
        return self.root(u, self.p0, self.flow.settings.at_rest) or (self, u)

    def root(
        self, u: np.ndarray, p: float, loose: float | None = None
    ) -> tuple[AlgebraicProblem | Self, np.ndarray] | None:
        """Return the equilibrium, or the cycle of half the period, that a solution repeats, with its problem; else None."""
        x, widths = self.curve(u)
        y = x.reshape(-1, self.node)
        near = self.flow.settings.same if loose is None else loose
        if (np.ptp(y, axis=0) <= near * self.node_scale).all() and self.free_period:
            values = {**self.values.values, self.parameter: p}
            return self.flow.equilibria(self.parameter, values), y.mean(axis=0)
        half = self.intervals // 2
        if self.copies % 2 or not (self.free_period or self.rounds % 2 == 0):
            return None
        gaps = np.abs(x[:half] - x[half:]).max(axis=(0, 1)) / self.node_scale
        if not (gaps <= near * (1.0 + np.abs(y).max(axis=0) / self.node_scale)).all():
            return None
        shorter = self.joined(0.5 * (x[:half] + x[half:]), 0.5 * u[self.states], 2.0 * widths[:half])
        rounds = self.rounds if self.free_period else self.rounds // 2
        return self.with_unknowns(shorter, p, half, self.copies // 2, rounds), shorter

    def center(self, u: np.ndarray) -> tuple[np.ndarray, float]:
        """Return the mean state, and the mean square distance from it in units of the scale."""
        x = u[: self.states].reshape(-1, self.node)
        mean = x.mean(axis=0)
        return mean, float((((x - mean) / self.node_scale) ** 2).mean())

    def resting(self, u: np.ndarray, x: np.ndarray) -> np.ndarray:
        """Return an equilibrium as unknowns of a cycle, with the period and mesh of u."""
        return np.concatenate([np.tile(x, self.states // self.node), u[self.states :]])

    def offspring(
        self, kind: str, u: np.ndarray, p: float, tangent: np.ndarray, multiplier: complex
    ) -> list[Embedding]:
        """Return, at a period doubling, the cycle as one of twice the period."""
        if kind != "period-doubling":
            return []

        def twice(v: np.ndarray, widths: np.ndarray) -> np.ndarray:
            return self.joined(np.tile(v[: self.states], 2), 2.0 * v[self.states], np.tile(widths, 2))

        doubled = twice(u, 0.5 * u[self.held])
        direction = np.append(twice(tangent, np.zeros(self.intervals)), tangent[-1])
        rounds = self.rounds if self.free_period else 2 * self.rounds
        problem = self.with_unknowns(doubled, p, 2 * self.intervals, 2 * self.copies, rounds)
        return [Embedding(problem, doubled, direction, kind)]

    def canonical(self, u: np.ndarray, p: float) -> tuple[Hashable, np.ndarray]:
        """Return a key, and means over the shortest period of powers and products of the coordinates; of two mirror images those that come first.

        The means do not depend on mesh and phase. For flows with many states only the first means are used, no more than there are values at
        the nodes of any mesh, since they have the scales of these values.
        """
        shorter = self.root(u, p)
        if shorter is not None:
            return shorter[0].canonical(shorter[1], p)
        x, period, widths = self.parts(u, p)
        forms = [x]
        if self.flow.mirror is not None:
            forms.append(self.curve(self._mirrored(u))[0])
        found = [self._means(form, widths, period)[: MEANS * self.node] for form in forms]
        best = min(found, key=in_order(np.full(len(found[0]), self.flow.settings.same)))
        kind = ("cycle", self.rounds if not self.free_period else 0, self.node)
        return kind, best * self.column_scale[: len(best)]

    def _means(self, x: np.ndarray, widths: np.ndarray, period: float) -> np.ndarray:
        r, d = self.rule, self.node
        points, slopes = (mesh.at_gauss_points(part, x / self.node_scale) for part in (r.values, r.slopes))
        share, turns = (widths[:, None] * r.weights).reshape(-1), np.tile(r.weights, len(widths))
        mean = share @ points
        gaps = points - mean
        size = np.sqrt(share @ gaps**2)
        moves = size > self.flow.settings.same * size.max()  # a constant coordinate has no shape
        unit = np.where(moves, gaps / np.where(moves, size, 1.0), 0.0)
        second, area, third = (
            np.einsum("i,ia,ib->ab", weights, one, other)
            for weights, one, other in ((share, gaps, unit), (turns, unit, slopes), (share, unit**2, gaps))
        )
        upper = np.triu_indices(d)
        clock = period / self.clock if self.free_period else 1.0
        return np.concatenate([[clock], mean, second[upper], area[np.triu_indices(d, 1)], third.reshape(-1)])

    # ------------------------------------------------------------------ homoclinic orbits
    def margins(self, u: np.ndarray, work: CycleWork) -> np.ndarray:
        """Return the margins.

        For autonomous flows the first two are log10(distance from an equilibrium, relative to the cycle's size / `homoclinic`) and
        log10(`longest` / period, relative to the first one), with limits of :class:`contvines.flows.FlowSettings`. Then follow the smallest values of
        the events along the cycle.
        """
        own = self._from_homoclinic(u, work) if self.free_period else np.zeros(0)
        return np.append(own, self._smallest_events(u, work.along[1])[0]) if len(self.flow.events) else own

    def margin_kind(self, j: int) -> str:
        """Return the kind of border of margin j: "homoclinic", or that of an event."""
        count = 2 * self.free_period
        return "homoclinic" if j < count else self.flow.border_kind(j - count)

    def event_at(self, point: BorderPoint) -> int:
        """Return the index of the event that is touched at a border; negative if the period grows without bound there."""
        return margin_of(point) - 2 * self.free_period

    def _from_homoclinic(self, u: np.ndarray, work: CycleWork) -> np.ndarray:
        x, s = u[: self.states].reshape(-1, self.node), self.flow.settings
        each = np.ascontiguousarray(x.T)  # reductions along rows are ten times as fast
        size = float(((each.max(axis=1) - each.min(axis=1)) / self.node_scale).max())
        short = math.log10(s.longest * self.clock / max(float(u[self.states]), TINY))
        closeness = work.distance_to_rest()
        if self.sparse is None and closeness < NEARLY * s.homoclinic * size:
            closeness = max(closeness, size * self._from_equilibrium(x, work) / NEARLY)
        if not size > 0.0 or not closeness < math.inf:
            return np.array([math.inf, short])
        return np.array([math.log10(max(closeness / size, TINY) / s.homoclinic), short])

    def _from_equilibrium(self, x: np.ndarray, work: CycleWork) -> float:
        """Distance from the equilibrium to which the shortest Newton step leads, relative to the size of the cycle in each coordinate; infinite if there is none.

        The Newton step alone is not enough: coordinates of fast and slow motions differ in size, and near the fold of a slow manifold the step is short
        although there is no equilibrium nearby.
        """
        _, p, jacobian, f = work.along
        try:
            steps = np.linalg.solve(jacobian, f[..., None])[..., 0] / self.node_scale
            points = mesh.at_gauss_points(self.rule.values, x.reshape(self.intervals, -1, self.node))
            start, sizes = points[int(np.nanargmin((steps**2).sum(axis=1)))], self.sizes(x)
            place = nearby_equilibrium(self, start, p, sizes)
        except (np.linalg.LinAlgError, NotEvaluable, ValueError):
            return math.inf
        return math.inf if place is None else float(np.linalg.norm((place - start) / sizes))

    def from_rest(self, u: np.ndarray, p: float) -> float:
        """Return the distance of the cycle from an equilibrium, relative to its size along each principal axis.

        It does not depend on the coordinates, unlike the margin; cycles near Bogdanov-Takens points are flat.
        """
        s, work = self.flow.settings, workspace(self)
        self.evaluate(u, p, work)
        if self.sparse is not None:
            return s.homoclinic * 10.0 ** float(self._from_homoclinic(u, work)[0])
        x = u[: self.states].reshape(-1, self.node) / self.node_scale
        axes = np.linalg.svd(x - x.mean(axis=0), full_matrices=False)[2]
        sizes = np.ptp(x @ axes.T, axis=0)
        back = self.node_scale[:, None] * axes.T * np.maximum(sizes, s.smallest * sizes.max())
        return max(distance_to_rest(work.along[2] @ back, work.along[3]), TINY)

    def remaining(self, u: np.ndarray, tangent: np.ndarray) -> float:
        """Estimate the distance of the parameter from its limit p* at infinite period by T |dp/dT|.

        This is twice the distance if p - p* is proportional to 1 / T^2 (saddle-node). At a saddle the distance decreases exponentially with T and is smaller
        than the estimate.
        """
        change = abs(float(tangent[self.states]))
        return float(u[self.states]) * abs(float(tangent[-1])) / change if change > 0.0 else 0.0

    # ------------------------------------------------------------------ events
    def _smallest_events(self, u: np.ndarray, p: float) -> tuple[np.ndarray, np.ndarray]:
        """The smallest value of each event along the cycle, and its place in units of the period; NaN if an event fails."""
        x, period, widths = self.parts(u, p)
        count = FINER * self.rule.degree
        edges = mesh.places(widths, np.arange(count) / count)
        try:
            return self.flow.events.closest(
                lambda places: mesh.evaluate(self.rule, widths, x, places), edges, period, self.values.at(p)
            )
        except NotEvaluable:
            nothing = np.full(len(self.flow.events), np.nan)
            return nothing, nothing

    def crossed(self, u: np.ndarray, p: float) -> str | None:
        """Return the name of an event that the cycle crosses by more than the error of the curve; None if there is none."""
        for k, name in enumerate(self.flow.events.names):
            if self._smallest_events(u, p)[0][k] < -self._event_error(u, p, k):
                return name
        return None

    def _event_error(self, u: np.ndarray, p: float, k: int) -> float:
        """Error of the smallest value of an event, from the error of the curve between the mesh points."""
        (x, time), sizes = self.touching(u, p, k), self.sizes(self.curve(u)[0])
        touch = self.flow.settings.touch
        nearby = x + touch * np.concatenate([np.diag(sizes), -np.diag(sizes)])
        values = self.flow.events(nearby, self.values.at(p), np.full(len(nearby), time))[:, k].reshape(2, -1)
        return float(self.estimated_error(u) * np.abs(values[0] - values[1]).sum() / (2.0 * touch))

    def touching(self, u: np.ndarray, p: float, k: int) -> tuple[np.ndarray, float]:
        """Return the state in which the cycle comes closest to event k, and its time."""
        x, period, widths = self.parts(u, p)
        place = self._smallest_events(u, p)[1][k : k + 1]
        return mesh.evaluate(self.rule, widths, x, place)[0], float(place[0] * period)

    def touch_error(self, point: BorderPoint) -> float:
        """Estimate the error of the parameter at which a cycle touches an event."""
        k, along = self.event_at(point), point.tangent
        missed = self._event_error(point.u, float(point.value), k)
        step = self.flow.settings.touch / max(float(np.abs(along[:-1] / self.column_scale).max()), TINY)
        one, other = (
            self._smallest_events(point.u + s * along[:-1], point.value + s * along[-1])[0][k]
            for s in (step, -step)
        )
        slope = abs(one - other) / (2.0 * step)
        return float(missed * abs(along[-1]) / slope) if slope > 0.0 else float("inf")
