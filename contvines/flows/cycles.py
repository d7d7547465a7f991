"""CycleProblem: cycles of a flow by orthogonal collocation, as F(u, p) = 0."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from contvines.shared.floating_point import ROUNDED

from ..problems.functions import NotEvaluable
from ..problems.protocol import margin_of
from . import mesh
from .cycle_relatives import CycleRelatives
from .forms import LARGEST, cubic, neimark_sacker, quadratic
from .infinite_period import infinite_period
from .kernels import CycleWork, linearise, spectrum
from .measures import measured
from .newton import solved
from .orbit import CycleOrbit
from .returns import ReturnMap
from .section import FlowSection

if TYPE_CHECKING:
    from ..problems.populations import Population
    from ..problems.protocol import BorderPoint, Seed

CAUTION = 10.0  # times the estimated error of values on the mesh


class CycleProblem(CycleRelatives):
    """Cycles of x' = f(x, p), or of x' = f(x, p, t) with a given period in t.

    Unknowns are those of :class:`CycleUnknowns`; widths of intervals stay as they are while equations are solved. Equations are those at the Gauss
    points, the phase condition (corrections are orthogonal to the direction of motion, in the mean over the cycle), and one for each width.
    """

    def direction(self, u: np.ndarray, p: float, side: float) -> np.ndarray:
        """The direction in which the branch of a cycle leads, the parameter growing or, where `side` is negative, falling."""
        border, step, tangent = np.zeros((3, self.dimension + 1))
        border[-1], work = 1.0, self.workspace()
        self.kernels.linearise(self, u, p, work)
        self.kernels.bordered(self, work, border, 0.0, step, tangent)
        return math.copysign(1.0, side) * tangent

    # ------------------------------------------------------------------ equations
    def evaluate(self, u: np.ndarray, p: float, work: CycleWork) -> None:
        """Residual and derivatives into a workspace.

        Raises
        ------
        NotEvaluable
            If the right-hand side fails, or the period is not positive.
        """
        x, period, widths = self.parts(u, p)
        if not period > 0.0:
            raise NotEvaluable(f"the period would be {period:.3g}")
        if not widths.min() > 0.0:
            raise NotEvaluable("mesh points would overtake one another")
        if work.core is not None and work.rates is not None:
            f, jacobian = work.rates.f, work.rates.jacobian
            size = work.core.evaluate(work.rates, self.field.values, x, widths, period, p)
        else:
            size, f, jacobian = self._evaluated(x, widths, period, p, work)
        if math.isnan(size):
            raise NotEvaluable("the right-hand side or its derivative is not finite along the cycle")
        work.along, work.steps = (np.array(x[:, 0]), p, jacobian, f), period * widths
        if self.field.forced:
            return
        if not size > 0.0:  # an equilibrium, which moves in no direction
            work.phase[0, 0] = 1.0
        if self.reference is not None:
            work.phase[:], origin = self.reference
            work.residual[self.states] = (
                work.phase * (x / self.node_scale - origin).reshape(work.phase.shape)
            ).sum()

    def _evaluated(
        self, x: np.ndarray, widths: np.ndarray, period: float, p: float, work: CycleWork
    ) -> tuple[float, np.ndarray, np.ndarray]:
        """Residual and derivatives by functions in Python: the length of the row of the phase condition, f and df/dx at the Gauss points."""
        r, core, field = self.rule, work.core, self.field
        points = self._at_gauss_points(r.values, x) if core is None else core.at_gauss_points(x)
        places = mesh.phases(widths, r.points, self.copies, self.rounds) if field.forced else None
        times = None if places is None else period / self.rounds * places
        f, slope = field.with_slope(points, p) if times is None else (field(points, p, times), None)
        f = np.ascontiguousarray(f, dtype=float)
        derivative = field.jacobian if work.sparse is None else field.jacobian_entries
        jacobian = np.ascontiguousarray(derivative(points, p, times), dtype=float)
        if core is not None:
            size = core.assemble(widths, period, f, jacobian, slope)
        else:
            size = self._assemble(work, x, widths, period, f, jacobian, slope)
        if places is not None:
            by = field.along(lambda q: self._moved(points, q, places, widths), p)
            work.derivative[: self.states] = -by.reshape(-1)
        return size, f, jacobian

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
        if not math.isfinite(f.sum() + jacobian.sum() + (0.0 if slope is None else slope.sum())):
            return math.nan
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
        work.phase[:], size = self._phase(widths, direction)
        return size

    def _phase(self, widths: np.ndarray, direction: np.ndarray) -> tuple[np.ndarray, float]:
        """Row of the phase condition, shape (N, m d), from rates at the Gauss points in units of the scale, and the length that it had."""
        r = self.rule
        row = np.matmul(r.values.T, (widths[:, None] * r.weights)[:, :, None] * direction)
        row[1:, 0] += row[:-1, -1]
        row[0, 0] += row[-1, -1]
        phase = row[:, :-1].reshape(self.intervals, -1)
        size = math.sqrt(np.vdot(phase, phase))
        return phase / (size or 1.0), size

    def anchor(self, u: np.ndarray | None, p: float = 0.0) -> None:
        """Keep the phase of a cycle for those that follow; None: corrections alone are orthogonal to the motion.

        Where the phase is not kept, predictions from several points of a branch would let it drift.
        """
        self.reference = None
        if u is None or not self.free_period:
            return
        x, _, widths = self.parts(u, p)
        rates = self.field(self._at_gauss_points(self.rule.values, x), p) / self.node_scale
        self.reference = self._phase(widths, rates.reshape(x.shape))[0], x / self.node_scale

    def in_phase(self, u: np.ndarray) -> bool:
        """Whether a cycle is enough like the one whose phase is kept."""
        if self.reference is None:
            return not self.free_period
        x, widths = self._curve(u)
        return (
            mesh.alike(self.rule, widths, x / self.node_scale, self.reference[1])
            > self.flow.settings.in_phase
        )

    def _moved(self, points: np.ndarray, p: complex, places: np.ndarray, widths: np.ndarray) -> np.ndarray:
        """Period times width times f, of forced flows, as a function of the parameter alone."""
        forcing = self.field.length_of_period(p)
        f = self.field(points, p, forcing * places).reshape(self.intervals, self.rule.degree, self.node)
        return self.rounds * forcing * widths[:, None, None] * f

    # ------------------------------------------------------------------ what is known of a cycle
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

    def uncertainty(self) -> float:
        """Relative accuracy of the equations: of rounding."""
        return ROUNDED * 4

    def explain_end(self, u: np.ndarray, p: float, tangent: np.ndarray, evaluable: bool) -> str:
        """Why a branch ends where Newton's method fails."""
        if not evaluable:
            return self.trouble
        error = self.estimated_error(u)
        return f"with {self.intervals} intervals the error of the cycle is about {error:.1g} of its size"

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

    # ------------------------------------------------------------------ borders
    def beyond(self, point: BorderPoint) -> list[Seed]:
        """Nothing goes on from a homoclinic orbit; at an event the flow says what does."""
        k = margin_of(point) - 2 * self.free_period
        return [] if k < 0 else self.flow.beyond(self, point, k)

    def dead_end(self, point: BorderPoint) -> str:
        """What the cycle becomes as its period grows without bound, such as a homoclinic orbit; or the event that stops the motion."""
        k = margin_of(point) - 2 * self.free_period
        if k >= 0:
            return self.flow.dead_end(self, point, k)
        return str(infinite_period(self, point))

    # ------------------------------------------------------------------ what people see of a cycle, and what attracts
    @property
    def default_measure(self) -> str:
        """The largest value of the first state."""
        return next(iter(self.flow.of_states))

    @property
    def measure_names(self) -> tuple[str, ...]:
        """Largest, smallest and mean value of each coordinate, the root mean square of the state, the period."""
        return ("norm", "period", *self.flow.of_states, *self.flow.own_measures)

    def measures(self, names: Sequence[str], u: np.ndarray, p: np.ndarray) -> dict[str, np.ndarray]:
        """Measures for an array of solutions."""
        u = np.atleast_2d(u)
        p = np.broadcast_to(np.asarray(p, dtype=float).reshape(-1), (len(u),))
        for name in names:
            if name not in self.measure_names:
                raise KeyError(f"there is no measure {name!r}; choose from {', '.join(self.measure_names)}")
        found = [measured(self, names, *pair) for pair in zip(u, p.tolist(), strict=True)]
        return {name: np.array([values[i] for values in found]) for i, name in enumerate(names)}

    def orbit(self, u: np.ndarray, p: float) -> CycleOrbit:
        """The cycle; solved for where the unknowns are those of a coarser mesh."""
        u, p = np.array(u, dtype=float), float(p)
        unsolved = linearise(self, u, p, self.workspace()) > self.flow.settings.rounded
        found = solved(self, u, p) if unsolved else None
        return CycleOrbit(self, u if found is None else found, p)

    def replay(self, u: np.ndarray, p: float) -> float | None:
        """Largest distance of a simulation from the cycle; see :meth:`CycleOrbit.replay`."""
        return self.orbit(u, p).replay()

    def simulated_attractors(self, p: float, starts: int = 16) -> list[dict[str, Any]]:
        """See :meth:`FlowProblem.simulated_attractors`."""
        return self.flow.simulated_attractors(self, p, starts)

    def attractor(self, u: np.ndarray, p: float) -> dict[str, Any]:
        """See :meth:`FlowProblem.known`."""
        return self.flow.known(self, u, p)

    def population(
        self, over: str | None = None, *, box: Sequence[tuple[float, float]] | None = None, **values: float
    ) -> Population:
        """Starts round this cycle, and what they settle on."""
        states = self.u0[: self.states].reshape(-1, self.node)
        return self.flow.population_at({**self.parameters, **values}, over or self.parameter, box, states)

    def return_map(self, u: np.ndarray, p: float) -> ReturnMap:
        """The map of which a cycle is a fixed point."""
        return ReturnMap(self, u, p)

    _returns: ReturnMap | None = None

    def section(self, p: float) -> FlowSection:
        """Motions beside the cycle with which the problem begins, once per period."""
        if self._returns is None:
            self._returns = ReturnMap(self, self.u0, self.p0)
        return FlowSection(self._returns, p)

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
