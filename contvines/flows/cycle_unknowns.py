"""CycleUnknowns: how a cycle is described by numbers, what counts as large in these, and the parameters."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from copy import copy
from typing import TYPE_CHECKING, Self

import numpy as np

from ..problems.functions import Parametrised
from ..problems.protocol import ProblemDefaults, Symmetry
from ..problems.scales import Scales
from .collocation import Rule, rule
from .field import Field
from .kernels import KERNELS, SPARSE, CycleWork
from .moving_mesh import MovingMesh
from .sparse import LEADING, SparseEquations

if TYPE_CHECKING:
    from .flow import Flow


class CycleUnknowns(Parametrised, ProblemDefaults, ABC):
    """Values at the nodes of each interval of the mesh, shape (N, m, d), the period (autonomous flows), and the widths of the intervals in units of the period.

    Parameters
    ----------
    flow : FlowProblem
    field : Field
    u : ndarray
        Unknowns to begin with.
    intervals : int
    rounds : int
        Of forced flows: periods of the forcing after which the motion repeats.
    copies : int
        The mesh consists of so many equal parts.
    scale : ndarray, shape (d,)
        What counts as large in each coordinate.
    clock : float
        What counts as large in the period.
    unit : float
        What counts as large in the parameter.
    """

    spectrum = "map"
    flip_kind = "period-doubling"
    kernels = KERNELS
    trouble = ""
    scales_learned = True
    reference: tuple[np.ndarray, np.ndarray] | None = None
    """Row of the phase condition that is kept, and the nodes that fulfil it, in units of the scale."""

    def __init__(
        self,
        flow: Flow,
        field: Field,
        u: np.ndarray,
        intervals: int,
        rounds: int = 1,
        copies: int = 1,
        scale: np.ndarray | None = None,
        clock: float = 1.0,
        unit: float = 1.0,
    ) -> None:
        self.flow, self.field, self.values = flow, field, field.values
        self.rule: Rule = rule(flow.degree)
        self.node, self.intervals, self.rounds, self.copies = field.node, int(intervals), rounds, copies
        self.free_period = 0 if field.forced else 1
        self.states = self.intervals * self.rule.degree * self.node
        self.dimension = self.states + self.free_period + self.intervals
        pattern = field.sparsity
        self.sparse = None if pattern is None else SparseEquations(pattern, self.rule, self.intervals)
        self.held = slice(self.states + self.free_period, self.dimension)  # widths
        self.n_multipliers = self.node - self.free_period
        if self.sparse is not None:  # the largest ones alone
            self.kernels, self.n_multipliers = SPARSE, min(LEADING, self.n_multipliers)
        self.n_margins = 2 * self.free_period + len(flow.events)
        self.u0 = np.array(u, dtype=float)
        if len(self.u0) != self.dimension:
            raise ValueError(f"{len(self.u0)} unknowns; {self.dimension} are needed")
        self.node_scale = np.ones(self.node) if scale is None else np.array(scale, dtype=float)
        self.moving = MovingMesh(
            self.rule, self.intervals, self.free_period, self.copies, self.node_scale, flow.settings.same
        )
        self.clock, self.parameter_scale = float(clock), float(unit)
        self.missed = 0.0  # by which the trivial multiplier, as computed last, misses 1
        self._size()

    def _size(self) -> None:
        tiled = np.tile(self.node_scale, self.intervals * self.rule.degree)
        period = np.full(self.free_period, self.clock)
        ones = np.ones(self.intervals)
        self.column_scale = np.concatenate([tiled, period, ones])
        self.row_scale = np.concatenate([tiled, np.ones(self.free_period), ones])
        self.scales = Scales(self.column_scale, self.parameter_scale, self.row_scale)
        self.symmetries = tuple(self._symmetries())

    def terms(self, u: np.ndarray) -> np.ndarray:
        """Sizes of the terms of the equations: states far from the origin cancel in their slopes, and in the phase, and round as they do."""
        states = u[: self.states].reshape(-1, self.node)
        sizes = np.maximum(self.node_scale, np.abs(states).max(axis=0))
        found = self.row_scale.copy()
        found[: self.states] = np.tile(sizes, len(states))
        found[self.states : self.states + self.free_period] *= (sizes / self.node_scale).max()
        return found

    @abstractmethod
    def _symmetries(self) -> list[Symmetry]: ...

    @abstractmethod
    def evaluate(self, u: np.ndarray, p: float, work: CycleWork) -> None:
        """Residual and derivatives into a workspace."""

    @abstractmethod
    def margins(self, u: np.ndarray, work: CycleWork) -> np.ndarray:
        """How far a cycle is from where branches end."""

    # ------------------------------------------------------------------ parameters
    @property
    def data(self) -> Self:
        """The problem itself."""
        return self

    def workspace(self) -> CycleWork:
        """Arrays for the kernels."""
        return CycleWork(self)

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
        rounds = self.rounds if rounds is None else rounds
        return type(self)(
            self.flow,
            self.field.against(values),
            u,
            intervals,
            rounds,
            copies,
            self.node_scale,
            self.clock,
            self.parameter_scale,
        )

    def scale_within(self, within: tuple[float, float]) -> np.ndarray:
        """Typical sizes of unknowns and parameter."""
        return np.append(self.column_scale, self.parameter_scale)

    def amplitude(self, direction: np.ndarray) -> float:
        """Root mean square of a direction over the nodes."""
        x = direction[: self.states].reshape(-1, self.node)
        return float(np.sqrt((x**2).sum(axis=1).mean()))

    # ------------------------------------------------------------------ unknowns
    @property
    def period_place(self) -> int:
        """Which of the unknowns is the period."""
        return self.states

    def parts(self, u: np.ndarray, p: float) -> tuple[np.ndarray, float, np.ndarray]:
        """Values at the nodes (N, m, d), period, widths (N,)."""
        x = u[: self.states].reshape(self.intervals, self.rule.degree, self.node)
        period = float(u[self.states]) if self.free_period else self.rounds * self.field.length_of_period(p)
        return x, period, u[self.states + self.free_period :]

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
