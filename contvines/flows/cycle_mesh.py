"""CycleMesh: base class of problems of cycles, with their unknowns on a mesh that is adapted and refined."""

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

MOST = 1280  # most mesh intervals
ENOUGH = 320  # with so many intervals, the mesh is not the reason if Newton's method fails


class CycleMesh(Parametrised, ProblemDefaults, ABC):
    """Unknowns and mesh of cycles.

    The unknowns are the values at the nodes of each mesh interval (without its last node), shape (N, m, d), the period (autonomous flows
    only), and the widths of the intervals in units of the period, shape (N,).

    Parameters
    ----------
    flow : Flow
    field : Field
    u : ndarray
        Unknowns of the start.
    counts : (int, int, int)
        Numbers of intervals, of periods of the forcing in one period of the cycle (forced flows), and of equal parts of the mesh.
    sizes : (ndarray of shape (d,), float, float)
        Typical sizes of the states, of the period, and of the parameter.
    """

    spectrum = "map"
    flip_kind = "period-doubling"
    trouble = ""
    scales_learned = True
    chunk = 8  # points of a branch after which the mesh is adapted
    parts_of_refined = 1  # number of equal parts of the mesh that `halved` makes: 2 after a cycle has come near its own half period
    reference: tuple[np.ndarray, np.ndarray] | None = None
    """Row of a fixed phase condition, and nodes that fulfil it, in units of the scale; see `anchor`."""

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
        self.held = slice(self.states + self.free_period, self.dimension)  # the widths
        self.n_multipliers = self.node - self.free_period
        self.n_margins = 2 * self.free_period + len(flow.events)
        self.sparse: SparseEquations | None = None
        if field.sparsity is not None:  # large flow: only the largest multipliers are computed
            self.sparse = SparseEquations(field.sparsity, self.rule, self.intervals)
            self.n_multipliers = min(LEADING, self.n_multipliers)
        self.u0 = np.array(u, dtype=float)
        if len(self.u0) != self.dimension:
            raise ValueError(f"{len(self.u0)} unknowns; {self.dimension} are needed")
        options = self.free_period, self.copies, self.node_scale, flow.settings.same
        self.moving = MovingMesh(self.rule, self.intervals, *options)
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
        """Kernels of :mod:`contvines.flows.kernels`."""

    @abstractmethod
    def workspace(self) -> Any:
        """Return the arrays for the kernels, a :class:`contvines.flows.work.CycleWork`."""

    @abstractmethod
    def _symmetries(self) -> list[Symmetry]: ...

    @abstractmethod
    def evaluate(self, u: np.ndarray, p: float, work: Any) -> None:
        """Evaluate residual and derivatives into a workspace."""

    @abstractmethod
    def margins(self, u: np.ndarray, work: Any) -> np.ndarray:
        """Return the margins: distances from a homoclinic orbit (autonomous flows), then from each event."""

    @abstractmethod
    def too_coarse(self, u: np.ndarray, p: float, stuck: bool = False) -> bool:
        """Whether a cycle needs more intervals."""

    # ------------------------------------------------------------------ similar problems
    @property
    def data(self) -> Self:
        """The problem itself."""
        return self

    def against(self, parameter: str, values: Mapping[str, float] | None = None) -> Self:
        """Return the same cycles with another parameter varying, and with other values of some parameters."""
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
        """Return the problem of cycles with another number of intervals, and with the start u at p."""
        values = self.values.against(self.parameter, {self.parameter: p})
        counts = intervals, self.rounds if rounds is None else rounds, copies
        sizes = self.node_scale, self.clock, self.parameter_scale
        return type(self)(self.flow, self.field.against(values), u, counts, sizes)

    def refined(self) -> Self:
        """Return the same cycles with twice as many intervals."""
        u = self.halved(self.u0)
        return self.with_unknowns(u, self.p0, 2 * self.intervals, self.parts_of_refined * self.copies)

    # ------------------------------------------------------------------ unknowns
    @property
    def period_place(self) -> int:
        """Index of the period among the unknowns."""
        return self.states

    def curve(self, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Split unknowns into values at the nodes (N, m, d) and widths (N,)."""
        return u[: self.states].reshape(self.intervals, self.rule.degree, self.node), u[self.held]

    def parts(self, u: np.ndarray, p: float) -> tuple[np.ndarray, float, np.ndarray]:
        """Split unknowns into values at the nodes (N, m, d), period and widths (N,)."""
        x, widths = self.curve(u)
        period = float(u[self.states]) if self.free_period else self.rounds * self.field.length_of_period(p)
        return x, period, widths

    def joined(self, x: np.ndarray, period: float, widths: np.ndarray) -> np.ndarray:
        """Join values at the nodes, period and widths to unknowns."""
        period_entry = [period] if self.free_period else []
        return np.concatenate([np.reshape(x, -1), period_entry, widths])

    def waiting(self, u: np.ndarray, p: float, period: float) -> np.ndarray:
        """Return a guess for a nearly homoclinic cycle of another period: the time in the slowest interval is changed."""
        x, old, widths = self.parts(u, p)
        speeds = np.linalg.norm(self.field(x[:, 0], p) / self.node_scale, axis=1)
        slowest, times = int(np.argmin(speeds + np.roll(speeds, -1))), old * widths
        times[slowest] = max(times[slowest] + period - old, 0.1 * times[slowest])
        return self.joined(x, period, times / times.sum())

    def scale_within(self, within: tuple[float, float]) -> np.ndarray:
        """Typical sizes of unknowns and parameter, shape (dimension + 1,)."""
        return np.append(self.column_scale, self.parameter_scale)

    def amplitude(self, direction: np.ndarray) -> float:
        """Length of a direction for normal forms: root mean square over the nodes."""
        x = direction[: self.states].reshape(-1, self.node)
        return float(np.sqrt((x**2).sum(axis=1).mean()))

    def sizes(self, x: np.ndarray) -> np.ndarray:
        """Range of a cycle in each coordinate, with a small positive minimum for coordinates that are constant."""
        ranges, s = np.ptp(x.reshape(-1, self.node), axis=0), self.flow.settings
        least = s.same * (ranges / self.node_scale).max() + s.solved
        return np.maximum(ranges, least * self.node_scale)

    def terms(self, u: np.ndarray) -> np.ndarray:
        """Sizes of the terms of the equations; if states are far from the origin, their large terms cancel in the derivatives and in the phase condition."""
        states = u[: self.states].reshape(-1, self.node)
        sizes = np.maximum(self.node_scale, np.abs(states).max(axis=0))
        found = self.row_scale.copy()
        found[: self.states] = np.tile(sizes, len(states))
        found[self.states : self.states + self.free_period] *= (sizes / self.node_scale).max()
        return found

    # ------------------------------------------------------------------ moving mesh
    @property
    def _phase_row(self) -> np.ndarray | None:
        return None if self.reference is None else self.reference[0].reshape(-1)

    def steer(self, u: np.ndarray, tangent: np.ndarray) -> None:
        """Change a tangent in place so that the mesh moves with the curve, and the phase is kept; see :mod:`contvines.flows.moving_mesh`."""
        self.moving.steer(u, tangent, self._phase_row)

    def stand(self, u: np.ndarray, tangent: np.ndarray) -> None:
        """Change a tangent in place so that the mesh is fixed, and the phase is kept."""
        self.moving.stand(u, tangent, self._phase_row)

    # ------------------------------------------------------------------ other meshes
    def estimated_error(self, u: np.ndarray) -> float:
        """Estimate the largest error of the curve between the mesh points, relative to the size of the cycle."""
        x, widths = self.curve(u)
        return mesh.error(self.rule, widths, x, self.sizes(x))

    def rests(self, u: np.ndarray) -> bool:
        """Whether a cycle is so small that it counts as an equilibrium."""
        return bool((self.sizes(self.curve(u)[0]) / self.node_scale).max() < self.flow.settings.same)

    def lags(self, u: np.ndarray) -> bool:
        """Whether the error of a cycle on its own mesh is too large; at rest it is rounding."""
        return not self.rests(u) and self.estimated_error(u) > self.flow.error

    def adapted(self, u: np.ndarray) -> Callable[..., np.ndarray] | None:
        """Return the interpolation of unknowns, or directions, to a mesh with equal shares of the error; None if the mesh is good."""
        x, widths = self.curve(u)
        sizes = self.sizes(x)
        if self.rests(u):
            return None
        new = mesh.equidistributed(self.rule, widths, x, sizes, self.copies)
        return None if new is None else self._remeshed(widths, new)

    def carried(self, u: np.ndarray, other: np.ndarray) -> np.ndarray:
        """Return unknowns interpolated to the mesh of others."""
        return self._remeshed(u[self.held], other[self.held])(u)

    def _remeshed(self, widths: np.ndarray, new: np.ndarray) -> Callable[..., np.ndarray]:
        """Interpolation of unknowns, or directions, to a mesh with other widths."""
        read = mesh.reading(self.rule, widths, mesh.node_places(self.rule, new))

        def image(v: np.ndarray, direction: bool = False) -> np.ndarray:
            rest = v[self.states : self.states + self.free_period]
            moved = read(self.curve(v)[0]).reshape(-1)
            return np.concatenate([moved, rest, np.zeros_like(new) if direction else new])

        return image

    def halved(self, u: np.ndarray, direction: bool = False) -> np.ndarray:
        """Return unknowns, or a direction, on a mesh with twice as many intervals: every interval halved, or two equal halves (`parts_of_refined`).

        If every interval is halved, u may be an array with unknowns as rows.
        """
        if self.parts_of_refined == 2:
            own = (self.u0 if direction else u)[self.held]
            return self._remeshed(own, mesh.with_equal_halves(own))(u, direction)
        end = self.held.start
        x = u[..., : self.states].reshape(*u.shape[:-1], self.intervals, self.rule.degree, self.node)
        finer = mesh.halved(self.rule, x).reshape(*u.shape[:-1], 2 * self.states)
        widths = np.repeat(0.5 * u[..., end:], 2, axis=-1)
        return np.concatenate([finer, u[..., self.states : end], widths], axis=-1)

    def asymmetry(self, u: np.ndarray) -> float:
        """Distance of a cycle from itself half a period later, relative to its size; with unequal halves of the mesh also from its mirror image then.

        It is 0 for a cycle that runs twice through a shorter one, or that is its own mirror image.
        """
        x, widths = self.curve(u)
        half_later = mesh.evaluate(self.rule, widths, x, mesh.node_places(self.rule, widths) + 0.5)
        images, inequality = [half_later], np.abs(widths - np.roll(widths, self.intervals // 2)).max()
        if self.flow.mirror is not None and inequality > self.flow.settings.same * widths.max():
            images.append(self.flow.mirrored(half_later))
        x = x.reshape(half_later.shape) / self.node_scale
        gaps = [np.abs(x - image / self.node_scale).max() for image in images]
        return float(min(gaps) / max(np.ptp(x, axis=0).max(), TINY))
