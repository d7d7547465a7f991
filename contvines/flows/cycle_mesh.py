"""CycleMesh: how a cycle is described by numbers, on a mesh that is adapted and refined."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from copy import copy
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from contvines.shared.numbers import TINY

from ..problems.functions import Parametrised
from ..problems.protocol import ProblemDefaults
from ..problems.scales import Scales
from . import mesh
from .field import Field
from .moving_mesh import MovingMesh
from .sparse import LEADING, SparseEquations

if TYPE_CHECKING:
    from ..problems.protocol import Kernels, Symmetry
    from .flow import Flow

MOST = 1280  # intervals
ENOUGH = 320  # intervals from which on it is not the mesh that makes Newton's method fail


class CycleMesh(Parametrised, ProblemDefaults, ABC):
    """Values at the nodes of each interval of the mesh, shape (N, m, d), the period (autonomous flows), and the widths of the intervals in units of the period.

    Parameters
    ----------
    flow : Flow
    field : Field
    u : ndarray
        Unknowns to begin with.
    counts : (int, int, int)
        Intervals; of forced flows, periods of the forcing after which the motion repeats; equal parts of which the mesh consists.
    sizes : (ndarray of shape (d,), float, float)
        What counts as large in each coordinate, in the period, and in the parameter.
    """

    spectrum = "map"
    flip_kind = "period-doubling"
    trouble = ""
    scales_learned = True
    chunk = 8  # points after which the mesh is adapted
    parts_of_refined = 1  # equal ones, into which `halved` divides the mesh
    reference: tuple[np.ndarray, np.ndarray] | None = None
    """Row of the phase condition that is kept, and the nodes that fulfil it, in units of the scale."""

    def __init__(
        self,
        flow: Flow,
        field: Field,
        u: np.ndarray,
        counts: tuple[int, int, int],
        sizes: tuple[np.ndarray, float, float],
    ) -> None:
        self.flow, self.field, self.values = flow, field, field.values
        self.rule, self.node = mesh.rule(flow.degree), field.node
        self.intervals, self.rounds, self.copies = counts
        self.node_scale = np.array(sizes[0], dtype=float)
        self.clock, self.parameter_scale = float(sizes[1]), float(sizes[2])
        self.free_period = 0 if field.forced else 1
        self.states = self.intervals * self.rule.degree * self.node
        self.dimension = self.states + self.free_period + self.intervals
        self.held = slice(self.states + self.free_period, self.dimension)  # widths
        self.n_multipliers = self.node - self.free_period
        self.n_margins = 2 * self.free_period + len(flow.events)
        self.sparse: SparseEquations | None = None
        if field.sparsity is not None:  # the largest multipliers alone
            self.sparse = SparseEquations(field.sparsity, self.rule, self.intervals)
            self.n_multipliers = min(LEADING, self.n_multipliers)
        self.u0 = np.array(u, dtype=float)
        if len(self.u0) != self.dimension:
            raise ValueError(f"{len(self.u0)} unknowns; {self.dimension} are needed")
        about = self.free_period, self.copies, self.node_scale, flow.settings.same
        self.moving = MovingMesh(self.rule, self.intervals, *about)
        self._size()

    def _size(self) -> None:
        tiled = np.tile(self.node_scale, self.intervals * self.rule.degree)
        ones = np.ones(self.intervals)
        self.column_scale = np.concatenate([tiled, np.full(self.free_period, self.clock), ones])
        self.row_scale = np.concatenate([tiled, np.ones(self.free_period), ones])
        self.scales = Scales(self.column_scale, self.parameter_scale, self.row_scale)
        self.symmetries = tuple(self._symmetries())

    @property
    @abstractmethod
    def kernels(self) -> Kernels:
        """Those of :mod:`contvines.flows.kernels`."""

    @abstractmethod
    def workspace(self) -> Any:
        """Arrays for the kernels, a :class:`contvines.flows.work.CycleWork`."""

    @abstractmethod
    def _symmetries(self) -> list[Symmetry]: ...

    @abstractmethod
    def evaluate(self, u: np.ndarray, p: float, work: Any) -> None:
        """Residual and derivatives into a workspace."""

    @abstractmethod
    def margins(self, u: np.ndarray, work: Any) -> np.ndarray:
        """How far a cycle is from where branches end."""

    @abstractmethod
    def too_coarse(self, u: np.ndarray, p: float, stuck: bool = False) -> bool:
        """Whether a cycle asks for more intervals."""

    # ------------------------------------------------------------------ problems alike
    @property
    def data(self) -> Self:
        """The problem itself."""
        return self

    def against(self, parameter: str, values: Mapping[str, float] | None = None) -> Self:
        """The same cycles with another parameter varying, and with other values of some parameters."""
        other = copy(self)
        other.values = self.values.against(parameter, values)
        other.field = self.field.against(other.values)
        if parameter != self.parameter:
            other.parameter_scale = 1.0
        other._size()
        return other

    def with_unknowns(
        self, u: np.ndarray, p: float, intervals: int, copies: int, rounds: int | None = None
    ) -> Self:
        """Cycles with another number of intervals."""
        values = self.values.against(self.parameter, {self.parameter: p})
        counts = intervals, self.rounds if rounds is None else rounds, copies
        sizes = self.node_scale, self.clock, self.parameter_scale
        return type(self)(self.flow, self.field.against(values), u, counts, sizes)

    def refined(self) -> Self:
        """The same cycles with twice as many intervals."""
        u = self.halved(self.u0)
        return self.with_unknowns(u, self.p0, 2 * self.intervals, self.parts_of_refined * self.copies)

    # ------------------------------------------------------------------ unknowns
    @property
    def period_place(self) -> int:
        """Which of the unknowns is the period."""
        return self.states

    def curve(self, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Values at the nodes (N, m, d), widths (N,)."""
        return u[: self.states].reshape(self.intervals, self.rule.degree, self.node), u[self.held]

    def parts(self, u: np.ndarray, p: float) -> tuple[np.ndarray, float, np.ndarray]:
        """Values at the nodes (N, m, d), period, widths (N,)."""
        x, widths = self.curve(u)
        period = float(u[self.states]) if self.free_period else self.rounds * self.field.length_of_period(p)
        return x, period, widths

    def joined(self, x: np.ndarray, period: float, widths: np.ndarray) -> np.ndarray:
        """Unknowns from their parts."""
        own = [period] if self.free_period else []
        return np.concatenate([np.reshape(x, -1), own, widths])

    def waiting(self, u: np.ndarray, p: float, period: float) -> np.ndarray:
        """A guess of a nearly homoclinic cycle of another period: it stays longer, or less long, where it is slowest."""
        x, now, widths = self.parts(u, p)
        speeds = np.linalg.norm(self.field(x[:, 0], p) / self.node_scale, axis=1)
        slowest, times = int(np.argmin(speeds + np.roll(speeds, -1))), now * widths
        times[slowest] = max(times[slowest] + period - now, 0.1 * times[slowest])
        return self.joined(x, period, times / times.sum())

    def scale_within(self, within: tuple[float, float]) -> np.ndarray:
        """Typical sizes of unknowns and parameter."""
        return np.append(self.column_scale, self.parameter_scale)

    def amplitude(self, direction: np.ndarray) -> float:
        """Root mean square of a direction over the nodes."""
        x = direction[: self.states].reshape(-1, self.node)
        return float(np.sqrt((x**2).sum(axis=1).mean()))

    def sizes(self, x: np.ndarray) -> np.ndarray:
        """Of a cycle in each coordinate, what stands still a little more than nothing."""
        ranges, s = np.ptp(x.reshape(-1, self.node), axis=0), self.flow.settings
        least = s.same * (ranges / self.node_scale).max() + s.solved
        return np.maximum(ranges, least * self.node_scale)

    def terms(self, u: np.ndarray) -> np.ndarray:
        """Sizes of the terms of the equations: states far from the origin cancel in their slopes, and in the phase, and round as they do."""
        states = u[: self.states].reshape(-1, self.node)
        sizes = np.maximum(self.node_scale, np.abs(states).max(axis=0))
        found = self.row_scale.copy()
        found[: self.states] = np.tile(sizes, len(states))
        found[self.states : self.states + self.free_period] *= (sizes / self.node_scale).max()
        return found

    # ------------------------------------------------------------------ a mesh that moves along
    @property
    def _phase_row(self) -> np.ndarray | None:
        return None if self.reference is None else self.reference[0].reshape(-1)

    def steer(self, u: np.ndarray, tangent: np.ndarray) -> None:
        """Let the mesh move along with the curve, and keep the phase; see :mod:`contvines.flows.moving_mesh`."""
        self.moving.steer(u, tangent, self._phase_row)

    def stand(self, u: np.ndarray, tangent: np.ndarray) -> None:
        """Let the mesh stand where it is, and keep the phase."""
        self.moving.stand(u, tangent, self._phase_row)

    # ------------------------------------------------------------------ other meshes
    def estimated_error(self, u: np.ndarray) -> float:
        """Estimated largest error of the curve between the mesh points, in units of the size of the cycle."""
        x, widths = self.curve(u)
        return mesh.error(self.rule, widths, x, self.sizes(x))

    def lags(self, u: np.ndarray) -> bool:
        """Whether the error of a cycle is too large on its own mesh."""
        return self.estimated_error(u) > self.flow.error

    def adapted(self, u: np.ndarray) -> Callable[..., np.ndarray] | None:
        """How unknowns, and directions of unknowns, read on a mesh with equal shares of the error; None where the mesh is good."""
        x, widths = self.curve(u)
        sizes = self.sizes(x)
        if (sizes / self.node_scale).max() < self.flow.settings.same:
            return None
        new = mesh.equidistributed(self.rule, widths, x, sizes, self.copies)
        return None if new is None else self._onto(widths, new)

    def carried(self, u: np.ndarray, other: np.ndarray) -> np.ndarray:
        """Unknowns as they read on the mesh of others."""
        return self._onto(u[self.held], other[self.held])(u)

    def _onto(self, widths: np.ndarray, new: np.ndarray) -> Callable[..., np.ndarray]:
        """How unknowns, and directions of unknowns, read on another mesh."""
        read = mesh.reading(self.rule, widths, mesh.node_places(self.rule, new))

        def image(v: np.ndarray, direction: bool = False) -> np.ndarray:
            rest = v[self.states : self.states + self.free_period]
            moved = read(self.curve(v)[0]).reshape(-1)
            return np.concatenate([moved, rest, np.zeros_like(new) if direction else new])

        return image

    def halved(self, u: np.ndarray, direction: bool = False) -> np.ndarray:
        """Unknowns, or a direction of unknowns, with twice as many intervals: every one halved, or the whole mesh twice in each period.

        Where every interval is halved, rows of an array are unknowns, too.
        """
        if self.parts_of_refined == 2:
            own = (self.u0 if direction else u)[self.held]
            return self._onto(own, mesh.with_equal_halves(own))(u, direction)
        end = self.held.start
        x = u[..., : self.states].reshape(*u.shape[:-1], self.intervals, self.rule.degree, self.node)
        finer = mesh.halved(self.rule, x).reshape(*u.shape[:-1], 2 * self.states)
        widths = np.repeat(0.5 * u[..., end:], 2, axis=-1)
        return np.concatenate([finer, u[..., self.states : end], widths], axis=-1)

    def asymmetry(self, u: np.ndarray) -> float:
        """How far a cycle is from itself half a period later, or, on a mesh with other halves, from its mirror image then, relative to its size.

        0 of one that runs twice through a shorter one, or is its own mirror image.
        """
        x, widths = self.curve(u)
        later = mesh.evaluate(self.rule, widths, x, mesh.node_places(self.rule, widths) + 0.5)
        images, apart = [later], np.abs(widths - np.roll(widths, self.intervals // 2)).max()
        if self.flow.mirror is not None and apart > self.flow.settings.same * widths.max():
            images.append(self.flow.mirrored(later))
        x = x.reshape(later.shape) / self.node_scale
        gaps = [np.abs(x - image / self.node_scale).max() for image in images]
        return float(min(gaps) / max(np.ptp(x, axis=0).max(), TINY))
