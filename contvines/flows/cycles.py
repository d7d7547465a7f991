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

CAUTION = 10.0  # safety factor of the estimated error of values at the mesh points


class CycleProblem(CycleRelatives):
    """Cycles of x' = f(x, p), or of x' = f(x, p, t) with a given period in t.

    The unknowns are those of :class:`contvines.flows.cycle_mesh.CycleMesh`. The equations are

    - the collocation equations at the Gauss points,
    - the phase condition (autonomous flows): corrections are orthogonal to the velocity, on average over the cycle, and
    - one for each width of the mesh, which keeps it unchanged during a correction.
    """

    def direction(self, u: np.ndarray, p: float, side: float) -> np.ndarray:
        """Return the tangent of the branch at a cycle, with growing or, if `side` is negative, falling parameter."""
        border, step, tangent = np.zeros((3, self.dimension + 1))
        border[-1], work = 1.0, self.workspace()
        linearise(self, u, p, work)
        work.bordered(border, 0.0, step, tangent)
        return math.copysign(1.0, side) * tangent

    # ------------------------------------------------------------------ equations
    @property
    def kernels(self) -> Kernels:
        """Kernels, with those for loci unless the derivatives are sparse."""
        return KERNELS if self.sparse is None else SPARSE

    def workspace(self) -> CycleWork:
        """Return the arrays for the kernels."""
        return workspace(self)

    def evaluate(self, u: np.ndarray, p: float, work: CycleWork) -> None:
        """Evaluate residual and derivatives into a workspace.

        Raises
        ------
        NotEvaluable
            If the right-hand side fails, or the period or a width is not positive.
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
        if not size > 0.0:  # an equilibrium: the velocity is zero, and so is the row of the phase condition
            work.phase[0, 0] = 1.0
        if self.reference is not None:
            work.phase[:], origin = self.reference
            displacement = (x / self.node_scale - origin).reshape(work.phase.shape)
            work.residual[self.states] = (work.phase * displacement).sum()

    def _evaluated(
        self, x: np.ndarray, widths: np.ndarray, period: float, p: float, work: CycleWork
    ) -> tuple[float, np.ndarray, np.ndarray]:
        """Evaluate residual and derivatives by functions in Python; return the length of the phase condition's row, f and df/dx at the Gauss points."""
        r, field, slope, times, along = self.rule, self.field, None, None, None
        points = work.at_gauss_points(x)
        if field.forced:
            places = mesh.phases(widths, r.points, self.copies, self.rounds)
            times = period / self.rounds * places
            f = field(points, p, times)

            def moved(q: complex) -> np.ndarray:
                """Period times width times f as a function of the parameter at fixed states."""
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
        """Fix the phase condition of the following cycles to the phase of u; with None, each correction is orthogonal to the cycle's own velocity.

        Without a fixed phase, predictions from several points of a branch let the phase drift.
        """
        self.reference = None
        if u is None or not self.free_period:
            return
        x, _, widths = self.parts(u, p)
        rates = self.field(mesh.at_gauss_points(self.rule.values, x), p) / self.node_scale
        self.reference = mesh.phase_row(self.rule, widths, rates.reshape(x.shape))[0], x / self.node_scale

    def in_phase(self, u: np.ndarray) -> bool:
        """Whether a cycle is similar enough to the one whose phase is fixed."""
        if self.reference is None:
            return not self.free_period
        x, widths = self.curve(u)
        similarity = mesh.alike(self.rule, widths, x / self.node_scale, self.reference[1])
        return similarity > self.flow.settings.in_phase

    # ------------------------------------------------------------------ need for more intervals
    def too_coarse(self, u: np.ndarray, p: float, stuck: bool = False) -> bool:
        """Whether a cycle needs more intervals, for one of these reasons:

        - Newton's method fails next to it (`stuck`), as at canards on a coarse mesh;
        - it approaches a cycle of half the period, or its own mirror image: this needs a mesh with equal halves;
        - its error is too large even on an adapted mesh;
        - collocation loses a decay, see `_lost_decay`.
        """
        if stuck:
            return self.intervals < ENOUGH * self.copies
        if self.free_period and self.copies % 2 and self.asymmetry(u) < self.flow.settings.halving:
            self.parts_of_refined = 2
            return True
        if self.intervals >= MOST or self.rests(u):
            return False
        return self._in_error(u) or self._lost_decay(u, p)

    def _in_error(self, u: np.ndarray) -> bool:
        image = self.adapted(u) if self.lags(u) else None
        return self.lags(u) and (image is None or self.lags(image(u)))

    def _lost_decay(self, u: np.ndarray, p: float) -> bool:
        """Whether perturbations that decay (or grow) by more than a factor e in a period decay by less in the collocation equations.

        Along an eigenvector with h lambda = z, collocation replaces exp(z) by R(z), whose magnitude tends to 1 for large |z|: see
        :meth:`Rule.stability`. This is harmless if at least one interval resolves the decay. If none does, as on cycles that become slower and
        slower, a multiplier near zero seems to approach 1, and the equations become singular without a bifurcation.
        """
        if self.sparse is not None:
            return False
        x, period, widths = self.parts(u, p)
        most, shortest = self.rule.resolved, int(np.argmin(widths))
        unit = self.node_scale / self.node_scale[:, None]
        time = None if self.free_period else np.array([period * widths[:shortest].sum()])
        first = self.field.jacobian(x[shortest, :1], p, time)[0] * unit
        if not period * widths[shortest] * np.linalg.norm(first) > most:
            return False
        work = self.workspace()
        self.evaluate(u, p, work)
        jacobian = work.along[2].reshape(self.intervals, self.rule.degree, self.node, self.node)
        z = np.linalg.eigvals(
            work.steps[:, None, None] * np.einsum("c,icab->iab", self.rule.weights, jacobian)
        )
        decay = np.where(np.abs(z) > most, np.abs(np.log(np.abs(self.rule.stability(z)))), np.inf)
        least = decay.argmin(axis=1)[:, None]
        found, true = (np.take_along_axis(a, least, axis=1).sum() for a in (decay, np.abs(z.real)))
        return bool(found < 1.0 < true)

    # ------------------------------------------------------------------ accuracy and normal forms
    def accuracy(self, u: np.ndarray, p: float) -> float:
        """Relative accuracy of parameter, period and mesh points: of order 2 m, while the curve between mesh points has order m + 1."""
        m, work = self.rule.degree, self.workspace()
        error, missed = min(self.estimated_error(u), 1.0), 0.0
        if linearise(self, u, p, work) < np.inf:
            try:
                missed = work.spectrum()[1]
            except np.linalg.LinAlgError:
                missed = 0.0
        bound = max(CAUTION * error ** (2.0 * m / (m + 1.0)), self.uncertainty())
        # the error of the trivial multiplier is a better estimate, unless its system is singular, as for nearly homoclinic orbits
        return max(bound, missed) if missed < self.flow.settings.sensible else bound

    def uncertainty(self) -> float:
        """Relative accuracy of the equations: rounding only."""
        return ROUNDED * 4

    def explain_end(self, u: np.ndarray, p: float, tangent: np.ndarray, evaluable: bool) -> str:
        """Return the reason why Newton's method fails at the end of a branch."""
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
        """Return the normal form coefficient and the sum of the magnitudes of its terms; None if they cannot be computed. See :mod:`contvines.flows.forms`.

        Parameters
        ----------
        kind : str
            Kind of the special point: "neimark-sacker", "period-doubling", or another one for a pitchfork.
        u, p
            The cycle.
        multiplier : complex
            Critical multiplier of a Neimark-Sacker point.
        along : ndarray, optional
            Given for a fold: direction of the unknowns that determines the sign.
        """
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
        """Return the motions beyond an event, as the flow has them; none beyond a homoclinic orbit."""
        k = self.event_at(point)
        return [] if k < 0 else self.flow.beyond(self, point, k)

    def dead_end(self, point: BorderPoint) -> str:
        """Return a sentence on the limit of infinite period, such as a homoclinic orbit, or on the event that stops the motion."""
        k = self.event_at(point)
        if k < 0:
            return str(infinite_period(self, point))
        return self.flow.dead_end(k, *self.touching(point.u, point.value, k))

    # ------------------------------------------------------------------ measures, orbits, attractors
    @property
    def default_measure(self) -> str:
        """Largest value of the first state."""
        return next(iter(self.flow.of_states))

    @property
    def measure_names(self) -> tuple[str, ...]:
        """Names: root mean square of the state ("norm"), period, largest, smallest and mean value of each state, and the flow's own measures."""
        return ("norm", "period", *self.flow.of_states, *self.flow.own_measures)

    def measures(self, names: Sequence[str], u: np.ndarray, p: np.ndarray) -> dict[str, np.ndarray]:
        """Return the named measures, each of shape (m,), of m cycles."""
        u = np.atleast_2d(u)
        p = np.broadcast_to(np.asarray(p, dtype=float).reshape(-1), (len(u),))
        for name in names:
            if name not in self.measure_names:
                raise KeyError(f"there is no measure {name!r}; choose from {', '.join(self.measure_names)}")
        found = [measured(self, names, *pair) for pair in zip(u, p.tolist(), strict=True)]
        return {name: np.array([values[i] for values in found]) for i, name in enumerate(names)}

    def orbit(self, u: np.ndarray, p: float) -> CycleOrbit:
        """Return the cycle; if the unknowns do not solve the equations (they come from a coarser mesh), Newton's method is applied first."""
        u, p = np.array(u, dtype=float), float(p)
        unsolved = linearise(self, u, p, self.workspace()) > self.flow.settings.rounded
        found = solved(self, u, p) if unsolved else None
        return CycleOrbit(self, u if found is None else found, p)

    def replay(self, u: np.ndarray, p: float) -> float | None:
        """Return the largest distance of a simulation from the cycle; see :meth:`CycleOrbit.replay`."""
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
        """Return a population of starts around this cycle."""
        states = self.u0[: self.states].reshape(-1, self.node)
        return self.flow.population_at({**self.parameters, **values}, over or self.parameter, box, states)

    def return_map(self, u: np.ndarray, p: float) -> ReturnMap:
        """Return the return map at a cycle, which is its fixed point."""
        return ReturnMap(self, u, p)

    _returns: ReturnMap | None = None

    def section(self, p: float) -> FlowSection:
        """Return the section of motions near the problem's first cycle: one step is one period."""
        if self._returns is None:
            self._returns = ReturnMap(self, self.u0, self.p0)
        return FlowSection(self._returns, p)

    def describe(self) -> dict[str, Any]:
        """Return name, discretisation, and the data from which the problem is rebuilt."""
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
