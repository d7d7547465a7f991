"""CycleMesh: the mesh of a cycle, adapted and refined."""

from __future__ import annotations

from collections.abc import Callable
from typing import Self

import numpy as np

from contvines.shared.floating_point import TINY

from . import mesh
from .cycle_unknowns import CycleUnknowns

MOST = 1280  # intervals
ENOUGH = 320  # intervals from which on it is not the mesh that makes Newton's method fail


class CycleMesh(CycleUnknowns):
    """The error of a cycle, other meshes for it, and when there are too few intervals."""

    chunk = 8  # points after which the mesh is adapted
    parts_of_refined = 1  # equal ones, into which `halved` divides the mesh

    def estimated_error(self, u: np.ndarray) -> float:
        """Estimated largest error of the curve between the mesh points, in units of the size of the cycle."""
        x, widths = self._curve(u)
        return mesh.error(self.rule, widths, x, self._sizes(x))

    def steer(self, u: np.ndarray, tangent: np.ndarray) -> None:
        """Let the mesh move along with the curve, and keep the phase; see :mod:`contvines.flows.moving_mesh`."""
        self.moving.steer(u, tangent, self._phase_row)

    def stand(self, u: np.ndarray, tangent: np.ndarray) -> None:
        """Let the mesh stand where it is, and keep the phase."""
        self.moving.stand(u, tangent, self._phase_row)

    def carried(self, u: np.ndarray, other: np.ndarray) -> np.ndarray:
        """Unknowns as they read on the mesh of others."""
        return self._onto(self._curve(u)[1], self._curve(other)[1])(u)

    @property
    def _phase_row(self) -> np.ndarray | None:
        return None if self.reference is None else self.reference[0].reshape(-1)

    def _curve(self, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        x = u[: self.states].reshape(self.intervals, self.rule.degree, self.node)
        return x, u[self.states + self.free_period :]

    def _at_gauss_points(self, matrix: np.ndarray, x: np.ndarray) -> np.ndarray:
        """Values, or derivatives, at the Gauss points of all intervals, shape (N m, d), from those at the nodes, (N, m, d)."""
        return np.matmul(matrix, mesh.closed(x)).reshape(-1, self.node)

    def _sizes(self, x: np.ndarray) -> np.ndarray:
        ranges, s = np.ptp(x.reshape(-1, self.node), axis=0), self.flow.settings
        return np.maximum(
            ranges, s.same * self.node_scale * (ranges / self.node_scale).max() + s.solved * self.node_scale
        )

    def adapted(self, u: np.ndarray) -> Callable[..., np.ndarray] | None:
        """How unknowns, and directions of unknowns, read on a mesh with equal shares of the error; None where the mesh is good."""
        x, widths = self._curve(u)
        sizes = self._sizes(x)
        if (sizes / self.node_scale).max() < self.flow.settings.same:
            return None
        new = mesh.equidistributed(self.rule, widths, x, sizes, self.copies)
        return None if new is None else self._onto(widths, new)

    def _onto(self, widths: np.ndarray, new: np.ndarray) -> Callable[..., np.ndarray]:
        """How unknowns, and directions of unknowns, read on another mesh."""
        read = mesh.reading(self.rule, widths, mesh.node_places(self.rule, new))

        def image(v: np.ndarray, direction: bool = False) -> np.ndarray:
            rest = v[self.states : self.states + self.free_period]
            moved = read(self._curve(v)[0]).reshape(-1)
            return np.concatenate([moved, rest, np.zeros_like(new) if direction else new])

        return image

    def lags(self, u: np.ndarray) -> bool:
        """Whether the error of a cycle is too large on its own mesh."""
        return self.estimated_error(u) > self.flow.error

    def too_coarse(self, u: np.ndarray, p: float, stuck: bool = False) -> bool:
        """Whether a cycle asks for more intervals: its error is too large on a mesh that suits it, too, Newton's method fails beside it, as at canards on a
        coarse mesh, it becomes one of half the period, or its own mirror image, which takes a mesh with equal halves to tell, or a decay gets lost."""
        if stuck:
            return self.intervals < ENOUGH * self.copies
        if self.free_period and self.copies % 2 and self._asymmetry(u) < self.flow.settings.halving:
            self.parts_of_refined = 2
            return True
        return self.intervals < MOST and (self._in_error(u) or self._lost_decay(u, p))

    def _in_error(self, u: np.ndarray) -> bool:
        image = self.adapted(u) if self.lags(u) else None
        return self.lags(u) and (image is None or self.lags(image(u)))

    def _lost_decay(self, u: np.ndarray, p: float) -> bool:
        """Whether motions beside the cycle that decay (or grow) by more than a factor e in a period do so by less as collocation has it.

        Along an eigenvector with h lambda = z collocation takes R(z) for exp(z), which tends to 1 in size as z grows: see :meth:`Rule.stability`.
        That is harmless as long as an interval resolves the decay. Where none does, as on cycles that go round slower and slower, a multiplier
        that is nearly zero seems to come near to 1, and the equations are singular where nothing bifurcates.
        """
        if self.sparse is not None:
            return False
        x, period, widths = self.parts(u, p)
        most, shortest = self.rule.resolved, int(np.argmin(widths))
        unit = self.node_scale / self.node_scale[:, None]
        when = None if self.free_period else np.array([period * widths[:shortest].sum()])
        first = self.field.jacobian(x[shortest, :1], p, when)[0] * unit
        if not period * widths[shortest] * np.linalg.norm(first) > most:
            return False
        work = self.workspace()
        self.evaluate(u, p, work)
        jacobian = work.along[2].reshape(self.intervals, self.rule.degree, self.node, self.node)
        z = np.linalg.eigvals(
            work.steps[:, None, None] * np.einsum("c,icab->iab", self.rule.weights, jacobian)
        )
        own = np.where(np.abs(z) > most, np.abs(np.log(np.abs(self.rule.stability(z)))), np.inf)
        least = own.argmin(axis=1)[:, None]
        found, true = (np.take_along_axis(a, least, axis=1).sum() for a in (own, np.abs(z.real)))
        return bool(found < 1.0 < true)

    def _asymmetry(self, u: np.ndarray) -> float:
        """How far a cycle is from itself half a period later, or, on a mesh with other halves, from its mirror image then, relative to its size.

        0 of one that runs twice through a shorter one, or is its own mirror image.
        """
        x, widths = self._curve(u)
        later = mesh.evaluate(self.rule, widths, x, mesh.node_places(self.rule, widths) + 0.5)
        images, apart = [later], np.abs(widths - np.roll(widths, self.intervals // 2)).max()
        if self.flow.mirror is not None and apart > self.flow.settings.same * widths.max():
            images.append(np.array([self.flow.mirror(y) for y in later]))
        x = x.reshape(later.shape) / self.node_scale
        gaps = [np.abs(x - image / self.node_scale).max() for image in images]
        return float(min(gaps) / max(np.ptp(x, axis=0).max(), TINY))

    def refined(self) -> Self:
        """The same cycles with twice as many intervals."""
        u = self.halved(self.u0)
        return self.with_unknowns(u, self.p0, 2 * self.intervals, self.parts_of_refined * self.copies)

    def halved(self, u: np.ndarray, direction: bool = False) -> np.ndarray:
        """Unknowns, or a direction of unknowns, with twice as many intervals: every one halved, or the whole mesh twice in each period.

        Where every interval is halved, rows of an array are unknowns, too.
        """
        if self.parts_of_refined == 2:
            own = self._curve(self.u0 if direction else u)[1]
            return self._onto(own, mesh.with_equal_halves(own))(u, direction)
        end = self.states + self.free_period
        x = u[..., : self.states].reshape(*u.shape[:-1], self.intervals, self.rule.degree, self.node)
        finer = mesh.halved(self.rule, x).reshape(*u.shape[:-1], 2 * self.states)
        return np.concatenate(
            [finer, u[..., self.states : end], np.repeat(0.5 * u[..., end:], 2, axis=-1)], axis=-1
        )
