"""CycleProblem: cycles of a flow by orthogonal collocation, as F(u, p) = 0."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from contvines.shared.numbers import ROUNDED

from ..problems.functions import NotEvaluable
from ..problems.protocol import Kernels
from . import mesh
from .cycle_mesh import ENOUGH, MOST
from .cycle_relatives import CycleRelatives
from .forms import LARGEST, cubic, neimark_sacker, quadratic
from .infinite_period import infinite_period
from .kernels import KERNELS, SPARSE, linearise, solved
from .measures import measured
from .orbit import CycleOrbit
from .returns import FlowSection, ReturnMap
from .work import CoreWork, CycleWork, workspace

if TYPE_CHECKING:
    from ..problems.abilities import Population
    from ..problems.protocol import BorderPoint, Seed

CAUTION = 10.0  # times the estimated error of values on the mesh


class CycleProblem(CycleRelatives):
    """Cycles of x' = f(x, p), or of x' = f(x, p, t) with a given period in t.

    Unknowns are those of :class:`contvines.flows.cycle_mesh.CycleMesh`; widths of intervals stay as they are while equations are solved. Equations are those at the Gauss
    points, the phase condition (corrections are orthogonal to the direction of motion, in the mean over the cycle), and one for each width.
    """

    def direction(self, u: np.ndarray, p: float, side: float) -> np.ndarray:
        """The direction in which the branch of a cycle leads, the parameter growing or, where `side` is negative, falling."""
        border, step, tangent = np.zeros((3, self.dimension + 1))
        border[-1], work = 1.0, self.workspace()
        linearise(self, u, p, work)
        work.bordered(border, 0.0, step, tangent)
        return math.copysign(1.0, side) * tangent

    # ------------------------------------------------------------------ equations
    @property
    def kernels(self) -> Kernels:
        """Those of loci, too, unless derivatives are sparse."""
        return KERNELS if self.sparse is None else SPARSE

    def workspace(self) -> CycleWork:
        """Arrays for the kernels."""
        return workspace(self)

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
        compiled = work.rates
        if compiled is not None and isinstance(work, CoreWork):
            compiled.assign(self.field.values, p)
            size, f, jacobian = work.evaluate(x, widths, period, compiled), compiled.f, compiled.jacobian
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
            off = (x / self.node_scale - origin).reshape(work.phase.shape)
            work.residual[self.states] = (work.phase * off).sum()

    def _evaluated(
        self, x: np.ndarray, widths: np.ndarray, period: float, p: float, work: CycleWork
    ) -> tuple[float, np.ndarray, np.ndarray]:
        """Residual and derivatives by functions in Python: the length of the row of the phase condition, f and df/dx at the Gauss points."""
        r, field, slope, times, along = self.rule, self.field, None, None, None
        points = work.at_gauss_points(x)
        if field.forced:
            places = mesh.phases(widths, r.points, self.copies, self.rounds)
            times = period / self.rounds * places
            f = field(points, p, times)

            def moved(q: complex) -> np.ndarray:
                """Period times width times f as a function of the parameter alone."""
                forcing = field.length_of_period(q)
                rates = field(points, q, forcing * places).reshape(self.intervals, r.degree, self.node)
                return self.rounds * forcing * widths[:, None, None] * rates

            along = moved
        else:
            f, slope = field.with_slope(points, p)
        f = np.ascontiguousarray(f, dtype=float)
        derivative = field.jacobian if self.sparse is None else field.jacobian_entries
        jacobian = np.ascontiguousarray(derivative(points, p, times), dtype=float)
        size = work.assemble(x, widths, period, f, jacobian, slope)
        if along is not None:
            work.derivative[: self.states] = -field.along(along, p).reshape(-1)
        return size, f, jacobian

    def anchor(self, u: np.ndarray | None, p: float = 0.0) -> None:
        """Keep the phase of a cycle for those that follow; None: corrections alone are orthogonal to the motion.

        Where the phase is not kept, predictions from several points of a branch would let it drift.
        """
        self.reference = None
        if u is None or not self.free_period:
            return
        x, _, widths = self.parts(u, p)
        rates = self.field(mesh.at_gauss_points(self.rule.values, x), p) / self.node_scale
        self.reference = mesh.phase_row(self.rule, widths, rates.reshape(x.shape))[0], x / self.node_scale

    def in_phase(self, u: np.ndarray) -> bool:
        """Whether a cycle is enough like the one whose phase is kept."""
        if self.reference is None:
            return not self.free_period
        x, widths = self.curve(u)
        alike = mesh.alike(self.rule, widths, x / self.node_scale, self.reference[1])
        return alike > self.flow.settings.in_phase

    # ------------------------------------------------------------------ when there are too few intervals
    def too_coarse(self, u: np.ndarray, p: float, stuck: bool = False) -> bool:
        """Whether a cycle asks for more intervals: its error is too large on a mesh that suits it, too, Newton's method fails beside it, as at canards on a
        coarse mesh, it becomes one of half the period, or its own mirror image, which takes a mesh with equal halves to tell, or a decay gets lost."""
        if stuck:
            return self.intervals < ENOUGH * self.copies
        if self.free_period and self.copies % 2 and self.asymmetry(u) < self.flow.settings.halving:
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

    # ------------------------------------------------------------------ what is known of a cycle
    def accuracy(self, u: np.ndarray, p: float) -> float:
        """Relative accuracy of parameter, period and mesh points: of order 2 m where the curve between them is known to order m + 1."""
        m, work = self.rule.degree, self.workspace()
        error, missed = min(self.estimated_error(u), 1.0), 0.0
        if linearise(self, u, p, work) < np.inf:
            try:
                missed = work.spectrum()[1]
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
        k = self.event_at(point)
        return [] if k < 0 else self.flow.beyond(self, point, k)

    def dead_end(self, point: BorderPoint) -> str:
        """What the cycle becomes as its period grows without bound, such as a homoclinic orbit; or the event that stops the motion."""
        k = self.event_at(point)
        if k < 0:
            return str(infinite_period(self, point))
        return self.flow.dead_end(k, *self.touching(point.u, point.value, k))

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
        return {
            **self.flow.describe(),
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
        }
