"""CycleProblem: cycles of a flow by orthogonal collocation, as F(u, p) = 0."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from copy import copy
from typing import TYPE_CHECKING, Any

import numpy as np

from ..problems.functions import NotEvaluable
from ..problems.images import in_order
from ..problems.protocol import Embedding, ProblemDefaults, Seed, Symmetry
from ..problems.scales import Scales
from . import mesh
from .collocation import Rule, rule
from .core import distance_to_rest
from .events import FINER
from .field import Field
from .flow_attractors import FlowAttractors
from .forms import LARGEST, cubic, neimark_sacker, quadratic
from .kernels import KERNELS, SPARSE, CycleWork, linearise, spectrum
from .measures import CycleMeasures
from .returns import ReturnMap
from .section import FlowSection
from .sparse import LEADING, SparseEquations
from .sparse import distance_to_rest as rest_of_sparse

if TYPE_CHECKING:
    from ..problems.protocol import BorderPoint

TINY = np.finfo(float).tiny
ROUNDING = 64 * 2.0**-53  # relative accuracy of a value that is found to roundoff
MOST = 1280  # intervals
ENOUGH = 320  # intervals from which on it is not the mesh that makes Newton's method fail
CAUTION = 10.0  # times the estimated error of values on the mesh


class CycleProblem(FlowAttractors, CycleMeasures, ProblemDefaults):
    """Cycles of x' = f(x, p), or of x' = f(x, p, t) with a given period in t.

    Unknowns are the values at the nodes of each interval of the mesh, shape (N, m, d), the period (autonomous flows), and the widths
    of the intervals in units of the period, which stay as they are while equations are solved. Equations are those at the Gauss
    points, the phase condition (corrections are orthogonal to the direction of motion, in the mean over the cycle), and one for each width.

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
    chunk = 8  # points after which the mesh is adapted

    def __init__(
        self,
        flow: Any,
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
        self.n_multipliers = self.node - self.free_period
        if self.sparse is not None:  # the largest ones alone
            self.kernels, self.n_multipliers = SPARSE, min(LEADING, self.n_multipliers)
        self.n_margins = 2 * self.free_period + len(flow.events)
        self.u0 = np.array(u, dtype=float)
        if len(self.u0) != self.dimension:
            raise ValueError(f"{len(self.u0)} unknowns; {self.dimension} are needed")
        self.node_scale = np.ones(self.node) if scale is None else np.array(scale, dtype=float)
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

    # ------------------------------------------------------------------ parameters
    @property
    def data(self) -> CycleProblem:
        """The problem itself."""
        return self

    @property
    def period_place(self) -> int:
        """Which of the unknowns is the period."""
        return self.states

    def waiting(self, u: np.ndarray, p: float, period: float) -> np.ndarray:
        """A guess of a nearly homoclinic cycle of another period: it stays longer, or less long, where it is slowest."""
        x, now, widths = self.parts(u, p)
        speeds = np.linalg.norm(self.field(x[:, 0], p) / self.node_scale, axis=1)
        slowest, times = int(np.argmin(speeds + np.roll(speeds, -1))), now * widths
        times[slowest] = max(times[slowest] + period - now, 0.1 * times[slowest])
        return self.joined(x, period, times / times.sum())

    def workspace(self) -> CycleWork:
        """Arrays for the kernels."""
        return CycleWork(self)

    @property
    def parameter(self) -> str:
        """Name of the parameter that varies."""
        return self.values.varying

    @property
    def parameters(self) -> dict[str, float]:
        """All parameters by name."""
        return dict(self.values.values)

    @property
    def p0(self) -> float:
        """Value of the varying parameter at the start."""
        return self.values.start

    def against(self, parameter: str, values: Mapping[str, float] | None = None) -> CycleProblem:
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
    ) -> CycleProblem:
        """Cycles with another number of intervals."""
        values = self.values.against(self.parameter, {self.parameter: p})
        rounds = self.rounds if rounds is None else rounds
        return CycleProblem(
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

    def direction(self, u: np.ndarray, p: float, side: float) -> np.ndarray:
        """The direction in which the branch of a cycle leads, the parameter growing or, where `side` is negative, falling."""
        border, step, tangent = np.zeros((3, self.dimension + 1))
        border[-1], work = 1.0, self.workspace()
        self.kernels.linearise(self, u, p, work)
        self.kernels.bordered(self, work, border, 0.0, step, tangent)
        return math.copysign(1.0, side) * tangent

    # ------------------------------------------------------------------ unknowns
    def parts(self, u: np.ndarray, p: float) -> tuple[np.ndarray, float, np.ndarray]:
        """Values at the nodes (N, m, d), period, widths (N,)."""
        x = u[: self.states].reshape(self.intervals, self.rule.degree, self.node)
        period = float(u[self.states]) if self.free_period else self.rounds * self.field.length_of_period(p)
        return x, period, u[self.states + self.free_period :]

    def joined(self, x: np.ndarray, period: float, widths: np.ndarray) -> np.ndarray:
        """Unknowns from their parts."""
        own = [period] if self.free_period else []
        return np.concatenate([np.reshape(x, -1), own, widths])

    # ------------------------------------------------------------------ equations
    def evaluate(self, u: np.ndarray, p: float, work: CycleWork) -> None:
        """Residual and derivatives into a workspace.

        Raises
        ------
        NotEvaluable
            If the right-hand side fails, or the period is not positive.
        """
        r, count = self.rule, self.intervals
        x, period, widths = self.parts(u, p)
        if not period > 0.0:
            raise NotEvaluable(f"the period would be {period:.3g}")
        core = work.core
        points = self._at_gauss_points(r.values, x) if core is None else core.at_gauss_points(x)
        begins = np.append(0.0, np.cumsum(widths)[:-1])
        places = (begins[:, None] + widths[:, None] * r.points).reshape(-1) if self.field.forced else None
        times = None if places is None else period * places
        f = self.field(points, p, times)
        derivative = self.field.jacobian if work.sparse is None else self.field.jacobian_entries
        jacobian = derivative(points, p, times)
        slope = self.field.slope(points, p) if places is None else None
        if not math.isfinite(f.sum() + jacobian.sum() + (0.0 if slope is None else slope.sum())):
            raise NotEvaluable("the right-hand side or its derivative is not finite along the cycle")
        if core is not None:
            size = core.assemble(widths, period, f, jacobian, slope)
        else:
            size = self._assemble(work, x, widths, period, f, jacobian, slope)
        work.along, work.steps = (np.array(x[:, 0]), p, jacobian, f), period * widths
        if places is not None:
            by = self.field.along(lambda q: self._moved(points, q, places, widths), p)
            work.derivative[: self.states] = -by.reshape(-1)
            return
        if not size > 0.0:  # an equilibrium, which moves in no direction
            work.phase[0, 0] = 1.0
        if self.reference is not None:
            phase, origin = self.reference
            work.phase[:] = phase
            gap = (x / self.node_scale).reshape(count, -1) - origin
            work.residual[self.states] = (phase * gap).sum()

    def _at_gauss_points(self, matrix: np.ndarray, x: np.ndarray) -> np.ndarray:
        return np.einsum("cj,ijk->ick", matrix, mesh.closed(x)).reshape(-1, self.node)

    def _assemble(
        self,
        work: CycleWork,
        x: np.ndarray,
        widths: np.ndarray,
        period: float,
        f: np.ndarray,
        jacobian: np.ndarray,
        slope: np.ndarray | None,
    ) -> float:
        """Residual, derivatives and phase condition, in numpy; see :meth:`contvines.flows.core.CoreCycle.assemble`."""
        r, count, d, m = self.rule, self.intervals, self.node, self.rule.degree
        steps = np.repeat(period * widths, m)[:, None]
        if work.sparse is not None:
            work.entries = work.sparse.entries(period * widths, jacobian, self.node_scale)
        else:
            scaled = steps[:, :, None] * jacobian * (self.node_scale / self.node_scale[:, None])
            blocks = -np.einsum("cj,icab->icajb", r.values, scaled.reshape(count, m, d, d))
            diagonal = np.arange(d)
            blocks[:, :, diagonal, :, diagonal] += r.slopes
            work.blocks[:] = blocks.reshape(count, m * d, (m + 1) * d)
        work.residual[:], work.derivative[:] = 0.0, 0.0
        work.residual[: self.states] = (self._at_gauss_points(r.slopes, x) - steps * f).reshape(-1)
        if slope is None:
            return 0.0
        work.derivative[: self.states] = -(steps * slope).reshape(-1)
        direction = (f / self.node_scale).reshape(count, m, d)
        work.by_period[:] = -(widths[:, None, None] * direction * self.clock).reshape(count, m * d)
        row = np.matmul(r.values.T, (widths[:, None] * r.weights)[:, :, None] * direction)
        phase = row[:, :-1].copy()
        phase[1:, 0] += row[:-1, -1]
        phase[0, 0] += row[-1, -1]
        size = float(np.sqrt((phase**2).sum()))
        work.phase[:] = (phase / (size or 1.0)).reshape(count, m * d)
        return size

    reference: tuple[np.ndarray, np.ndarray] | None = None

    def anchor(self, u: np.ndarray | None, p: float = 0.0) -> None:
        """Keep the phase of a cycle for those that follow; None: corrections alone are orthogonal to the motion.

        Where the phase is not kept, predictions from several points of a branch would let it drift.
        """
        self.reference = None
        if u is None or not self.free_period:
            return
        work = self.workspace()
        self.evaluate(u, p, work)
        x = u[: self.states].reshape(self.intervals, -1, self.node) / self.node_scale
        self.reference = work.phase.copy(), x.reshape(self.intervals, -1)

    def _moved(self, points: np.ndarray, p: Any, places: np.ndarray, widths: np.ndarray) -> np.ndarray:
        """Period times width times f, of forced flows, as a function of the parameter alone."""
        period = self.rounds * self.field.length_of_period(p)
        f = self.field(points, p, period * places).reshape(self.intervals, self.rule.degree, self.node)
        return period * widths[:, None, None] * f

    # ------------------------------------------------------------------ margins
    def margins(self, u: np.ndarray, work: CycleWork) -> np.ndarray:
        """How far the cycle stays away from equilibria, relative to its size, and its period from infinity: log10 of the part that is left; then the events."""
        p = work.along[1]
        if not len(self.flow.events):
            return self._from_homoclinic(u, work)
        touching = self._closest(u, p)[0]
        return np.append(self._from_homoclinic(u, work), touching) if self.free_period else touching

    def _closest(self, u: np.ndarray, p: float) -> tuple[np.ndarray, np.ndarray]:
        """The smallest value of each event along the cycle, and where."""
        x, period, widths = self.parts(u, p)
        inside = np.arange(FINER * self.rule.degree) / (FINER * self.rule.degree)
        begins = np.append(0.0, np.cumsum(widths)[:-1])
        edges = (begins[:, None] + widths[:, None] * inside).reshape(-1)
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
        k = int(point.margin_index) - 2 * self.free_period
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

    def _from_homoclinic(self, u: np.ndarray, work: CycleWork) -> np.ndarray:
        x = u[: self.states].reshape(-1, self.node) / self.node_scale
        size, s = float(np.ptp(x, axis=0).max()), self.flow.settings
        short = float(np.log10(s.longest * self.clock / max(float(u[self.states]), TINY)))
        _, _, jacobian, f = work.along
        closeness = distance_to_rest(jacobian, f, self.node_scale) if work.core is not None else None
        if work.sparse is not None:
            closeness = rest_of_sparse(work.sparse.pattern, jacobian, f, self.node_scale)
        elif closeness is None:
            scaled = jacobian * (self.node_scale / self.node_scale[:, None])
            closeness = _distance_to_rest(scaled, f / self.node_scale)
        if not size > 0.0 or not np.isfinite(closeness):
            return np.array([np.inf, short])
        return np.array([float(np.log10(max(closeness / size, TINY) / s.homoclinic)), short])

    def margin_kind(self, j: int) -> str:
        """A cycle that comes near to an equilibrium ends as a homoclinic orbit; else it touches an event."""
        own = 2 * self.free_period
        return "homoclinic" if j < own else self.flow.border_kind(j - own)

    def beyond(self, point: BorderPoint) -> list[Seed]:
        """Nothing goes on from a homoclinic orbit; at an event the flow says what does."""
        k = int(point.margin_index) - 2 * self.free_period
        return [] if k < 0 else self.flow.beyond(self, point, k)

    def dead_end(self, point: BorderPoint) -> str:
        """The equilibrium to which an orbit is homoclinic, and its eigenvalues; or the event that stops the motion."""
        k = int(point.margin_index) - 2 * self.free_period
        if k >= 0:
            return self.flow.dead_end(self, point, k)
        x, period, _ = self.parts(point.u, point.value)
        return self.flow.homoclinic_text(x.reshape(-1, self.node), period, point.value, self.values)

    # ------------------------------------------------------------------ mesh
    def estimated_error(self, u: np.ndarray) -> float:
        """Estimated largest error of the curve between the mesh points, in units of the size of the cycle."""
        x, widths = self._curve(u)
        return mesh.error(self.rule, widths, x, self._sizes(x))

    def _curve(self, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        x = u[: self.states].reshape(self.intervals, self.rule.degree, self.node)
        return x, u[self.states + self.free_period :]

    def _sizes(self, x: np.ndarray) -> np.ndarray:
        ranges, s = np.ptp(x.reshape(-1, self.node), axis=0), self.flow.settings
        return np.maximum(
            ranges, s.same * self.node_scale * (ranges / self.node_scale).max() + s.solved * self.node_scale
        )

    def accuracy(self, u: np.ndarray, p: float) -> float:
        """Relative accuracy of parameter, period and mesh points: of order 2 m where the curve between them is known to order m + 1."""
        m, work = self.rule.degree, self.workspace()
        error, missed = min(self.estimated_error(u), 1.0), 0.0
        if linearise(self, u, p, work) < np.inf:
            try:
                missed = spectrum(self, work)[1]
            except np.linalg.LinAlgError:
                missed = 0.0
        own = max(CAUTION * error ** (2.0 * m / (m + 1.0)), self.uncertainty())
        # the trivial multiplier tells more, unless its system is singular, as of nearly homoclinic orbits
        return max(own, missed) if missed < self.flow.settings.sensible else own

    def remaining(self, u: np.ndarray, tangent: np.ndarray) -> float:
        """How far the parameter may be from that of an infinite period: of a saddle-node p - p* is as 1 / T^2 to first order, taken twice; of a saddle less is left."""
        change = abs(float(tangent[self.states]))
        return float(u[self.states]) * abs(float(tangent[-1])) / change if change > 0.0 else 0.0

    def adapted(self, u: np.ndarray) -> Callable[[np.ndarray], np.ndarray] | None:
        """How unknowns, and directions of unknowns, read on a mesh with equal shares of the error; None where the mesh is good."""
        x, widths = self._curve(u)
        if np.ptp(x.reshape(-1, self.node) / self.node_scale, axis=0).max() < self.flow.settings.same:
            return None
        new = mesh.equidistributed(self.rule, widths, x, self._sizes(x), self.copies)
        if new is None:
            return None

        return lambda v, direction=False: self._onto(v, widths, new, direction)

    def _onto(self, v: np.ndarray, widths: np.ndarray, new: np.ndarray, direction: bool) -> np.ndarray:
        """Unknowns, or a direction of unknowns, on another mesh."""
        y = v[: self.states].reshape(self.intervals, self.rule.degree, self.node)
        moved = mesh.onto(self.rule, widths, y, new)
        rest = v[self.states : self.states + self.free_period]
        return np.concatenate([moved.reshape(-1), rest, np.zeros_like(new) if direction else new])

    def too_coarse(self, u: np.ndarray, stuck: bool = False) -> bool:
        """Whether a cycle asks for more intervals: its error is too large, Newton's method fails beside it, as at canards on a coarse mesh,
        or it becomes one of half the period, which takes a mesh with equal halves to tell."""
        if stuck:
            return self.intervals < ENOUGH * self.copies
        if self.free_period and self.copies % 2 and self._asymmetry(u) < self.flow.settings.halving:
            self.parts_of_refined = 2
            return True
        return self.intervals < MOST and self.estimated_error(u) > self.flow.error

    parts_of_refined = 1  # equal ones, into which `halved` divides the mesh

    def _asymmetry(self, u: np.ndarray) -> float:
        """How far a cycle is from itself half a period later, relative to its size: 0 of one that runs twice through a shorter one."""
        x, widths = self._curve(u)
        later = mesh.evaluate(self.rule, widths, x, mesh.node_places(self.rule, widths) + 0.5)
        x = x.reshape(later.shape) / self.node_scale
        return float(np.abs(x - later / self.node_scale).max() / max(np.ptp(x, axis=0).max(), TINY))

    def refined(self) -> CycleProblem:
        """The same cycles with twice as many intervals."""
        u = self.halved(self.u0)
        return self.with_unknowns(u, self.p0, 2 * self.intervals, self.parts_of_refined * self.copies)

    def halved(self, u: np.ndarray, direction: bool = False) -> np.ndarray:
        """Unknowns, or a direction of unknowns, with twice as many intervals: every one halved, or the whole mesh twice in each period."""
        x, widths = self._curve(u)
        r = self.rule
        if self.parts_of_refined == 2:
            own = self._curve(self.u0)[1] if direction else widths
            return self._onto(u, own, np.tile(0.5 * own, 2), direction)
        ends = mesh.closed(x)
        both = [
            np.einsum("cj,ijk->ick", r.interpolation(s + 0.5 * r.nodes[:-1]), ends)[:, None]
            for s in (0.0, 0.5)
        ]
        finer = np.concatenate(both, axis=1).reshape(-1)
        rest = u[self.states : self.states + self.free_period]
        return np.concatenate([finer, rest, np.repeat(0.0 * widths if direction else 0.5 * widths, 2)])

    # ------------------------------------------------------------------ relatives
    def _symmetries(self) -> list[Symmetry]:
        found = []
        even = self.intervals % 2 == 0
        if even and self.copies % 2 == 0 and (self.free_period or self.rounds % 2 == 0):
            at = self._kind_at if self.free_period else None
            found.append(Symmetry("period-doubling", self._half_later, self._root, at))
        elif even and self.free_period:
            found.append(Symmetry("hopf", self._half_later, self._root))
        mirror = self.flow.mirror
        if mirror is not None:
            if even and (self.free_period or self.flow.mirror_shifted != (self.rounds % 2 == 0)):
                found.append(Symmetry("symmetry-breaking", lambda u: self._mirrored(self._half_later(u))))
            if self.free_period or not self.flow.mirror_shifted:
                found.append(Symmetry("symmetry-breaking", self._mirrored))
        return found

    def _kind_at(self, u: np.ndarray) -> str:
        """Whether a cycle that is equal to itself half a period later is an equilibrium or a cycle of half the period."""
        y = u[: self.states].reshape(-1, self.node) / self.node_scale
        return "hopf" if np.ptp(y, axis=0).max() < self.flow.settings.at_rest else "period-doubling"

    def _half_later(self, u: np.ndarray) -> np.ndarray:
        v = np.array(u, dtype=float)
        x = v[: self.states].reshape(self.intervals, -1)
        v[: self.states] = np.roll(x, self.intervals // 2, axis=0).reshape(-1)
        return v

    def _mirrored(self, u: np.ndarray) -> np.ndarray:
        v = np.array(u, dtype=float)
        x = v[: self.states].reshape(-1, self.node)
        v[: self.states] = np.array([self.flow.mirror(y) for y in x]).reshape(-1)
        return v

    def _root(self, u: np.ndarray) -> tuple[Any, np.ndarray]:
        return self.root(u, self.p0, self.flow.settings.at_rest) or (self, u)

    def root(self, u: np.ndarray, p: float, loose: float | None = None) -> tuple[Any, np.ndarray] | None:
        """The equilibrium, or the cycle of half the period, that a solution only repeats; else None."""
        x, widths = self._curve(u)
        y = x.reshape(-1, self.node)
        near = self.flow.settings.same if loose is None else loose
        if (np.ptp(y, axis=0) <= near * self.node_scale).all() and self.free_period:
            return self.flow.equilibria(self.parameter, {**self.values.values, self.parameter: p}), y.mean(
                axis=0
            )
        half = self.intervals // 2
        if self.copies % 2 or (self.free_period == 0 and self.rounds % 2):
            return None
        apart = np.abs(x[:half] - x[half:]).max(axis=(0, 1)) / self.node_scale
        if not (apart <= near * (1.0 + np.abs(y).max(axis=0) / self.node_scale)).all():
            return None
        period = u[self.states] / 2.0 if self.free_period else 0.0
        shorter = np.concatenate(
            [
                0.5 * (x[:half] + x[half:]).reshape(-1),
                [period] if self.free_period else [],
                2.0 * widths[:half],
            ]
        )
        rounds = self.rounds if self.free_period else self.rounds // 2
        return self.with_unknowns(shorter, p, half, self.copies // 2, rounds), shorter

    def offspring(
        self, kind: str, u: np.ndarray, p: float, tangent: np.ndarray, multiplier: complex
    ) -> list[Embedding]:
        """At a period doubling: the cycle of twice the period."""
        if kind != "period-doubling":
            return []
        x, widths = self._curve(u)
        y = tangent[: self.states].reshape(x.shape)
        both = np.concatenate([x, x]).reshape(-1)
        own = [2.0 * u[self.states]] if self.free_period else []
        doubled = np.concatenate([both, own, np.tile(0.5 * widths, 2)])
        direction = np.concatenate(
            [
                np.concatenate([y, y]).reshape(-1),
                [2.0 * tangent[self.states]] if self.free_period else [],
                np.zeros(2 * self.intervals),
                [tangent[-1]],
            ]
        )
        rounds = self.rounds if self.free_period else 2 * self.rounds
        problem = self.with_unknowns(doubled, p, 2 * self.intervals, 2 * self.copies, rounds)
        return [Embedding(problem, doubled, direction, kind)]

    def normal_form(
        self,
        kind: str,
        u: np.ndarray,
        p: float,
        multiplier: complex = -1.0,
        along: np.ndarray | None = None,
    ) -> tuple[float, float] | None:
        """The coefficient at a fold (of the sign along a direction), a period doubling, a pitchfork or a Neimark-Sacker point, with the sum of the magnitudes of
        its terms; None where there is none. See :mod:`contvines.flows.forms`."""
        if self.states > LARGEST or self.sparse is not None:
            return None
        try:
            with np.errstate(all="ignore"):
                if kind == "neimark-sacker":
                    found = neimark_sacker(self, u, p, multiplier)
                elif along is not None:
                    found = quadratic(self, u, p, along)
                else:
                    found = cubic(self, u, p, -1.0 if kind == "period-doubling" else 1.0)
        except (
            NotEvaluable,
            np.linalg.LinAlgError,
            ValueError,
            RuntimeError,
        ):  # splu: singular to the last bit
            return None
        return found if np.isfinite(found).all() else None

    def population(self, over: str | None = None, **options: Any):
        """Starts round this cycle, and what they settle on."""
        states = self.u0[: self.states].reshape(-1, self.node)
        return self.flow.population(over or self.parameter, around=states, **{**self.parameters, **options})

    def return_map(self, u: np.ndarray, p: float) -> ReturnMap:
        """The map of which a cycle is a fixed point."""
        return ReturnMap(self, u, p)

    def section(self, p: float) -> FlowSection:
        """Motions beside the cycle with which the problem begins, once per period."""
        if self._returns is None:
            self._returns = ReturnMap(self, self.u0, self.p0)
        return FlowSection(self._returns, p)

    _returns: ReturnMap | None = None

    # ------------------------------------------------------------------ identity
    def canonical(self, u: np.ndarray, p: float) -> tuple[Any, np.ndarray]:
        """Means over the shortest period of powers and products of the coordinates, the same for all meshes and phases; of mirror images the smaller."""
        shorter = self.root(u, p)
        if shorter is not None:
            return shorter[0].canonical(shorter[1], p)
        x, period, widths = self.parts(u, p)
        forms = [x]
        if self.flow.mirror is not None:
            forms.append(self._mirrored(u)[: self.states].reshape(x.shape))
        found = [self._means(form, widths, period) for form in forms]
        best = min(found, key=in_order(np.full(len(found[0]), self.flow.settings.same)))
        scale = np.resize(self.column_scale, len(best))
        return ("cycle", self.rounds if not self.free_period else 0, self.node), best * scale

    def _means(self, x: np.ndarray, widths: np.ndarray, period: float) -> np.ndarray:
        r, d = self.rule, self.node
        ends = mesh.closed(x / self.node_scale)
        points = np.einsum("cj,ijk->ick", r.values, ends).reshape(-1, d)
        slopes = np.einsum("cj,ijk->ick", r.slopes, ends).reshape(-1, d)
        share = (widths[:, None] * r.weights).reshape(-1)
        turns = np.repeat(r.weights[None, :], len(widths), axis=0).reshape(-1)
        mean = share @ points
        rest = points - mean
        size = np.sqrt(share @ rest**2)
        moves = size > self.flow.settings.same * size.max()  # what stands still has no shape
        unit = np.where(moves, rest / np.where(moves, size, 1.0), 0.0)
        second = np.einsum("i,ia,ib->ab", share, rest, unit)
        area = np.einsum("i,ia,ib->ab", turns, unit, slopes)
        upper = np.triu_indices(d)
        third = np.einsum("i,ia,ib->ab", share, unit**2, rest)
        clock = period / self.clock if self.free_period else 1.0
        return np.concatenate([[clock], mean, second[upper], area[np.triu_indices(d, 1)], third.reshape(-1)])

    # ------------------------------------------------------------------ files, checks
    def describe(self) -> dict[str, Any]:
        """Name, discretisation, and how to build the problem again."""
        about = self.flow.describe()
        return {
            **about,
            **self.flow.of_cycles,
            **({"periods": self.rounds} if self.field.forced else {}),
            "parameter": self.parameter,
            "p0": self.values.given(),
            "cycle": {
                "u0": self.u0.tolist(),
                "intervals": self.intervals,
                "rounds": self.rounds,
                "copies": self.copies,
                "scale": self.node_scale.tolist(),
                "clock": self.clock,
                "unit": self.parameter_scale,
            },
            "factory": about.get("factory"),
        }

    def uncertainty(self) -> float:
        """Relative accuracy of the equations: of rounding."""
        return ROUNDING * 8

    def explain_end(self, u: np.ndarray, p: float, tangent: np.ndarray, evaluable: bool) -> str:
        """Why a branch ends where Newton's method fails."""
        if not evaluable:
            return self.trouble
        error = self.estimated_error(u)
        return f"with {self.intervals} intervals the error of the cycle is about {error:.1g} of its size"


def _distance_to_rest(matrices: np.ndarray, rates: np.ndarray) -> float:
    """The shortest Newton step to an equilibrium from points with Jacobians (n, d, d) and rates (n, d); infinite if there is none."""
    try:
        steps = np.linalg.solve(matrices, rates[..., None])[..., 0]
    except np.linalg.LinAlgError:  # one of them is singular to the last bit
        steps = np.matmul(np.linalg.pinv(matrices), rates[..., None])[..., 0]
    sizes = np.sqrt((steps**2).sum(axis=-1))
    return float(np.nanmin(sizes)) if np.isfinite(sizes).any() else np.inf
