"""CycleOrbit: one cycle of a flow, for users."""

from __future__ import annotations

from copy import copy
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING, Any, TypedDict, Unpack, cast

import numpy as np

from ..problems.functions import NotEvaluable
from ..shared.motions import attracts, onto_circle
from ..shared.numbers import pairs
from . import mesh
from .elimination import multipliers_of
from .kernels import linearise, solved
from .work import CycleWork, workspace

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from matplotlib.animation import FuncAnimation
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import ArrayLike

    from ..problems.protocol import Problem
    from .cycle_mesh import CycleMesh
    from .field import Field

# parts of the cycle that are simulated separately, to limit the growth of unstable perturbations
SEGMENTS = 8


class PictureOptions(TypedDict, total=False):
    """Options of a picture of a cycle; see :func:`contvines.plots.cycles.plot_cycle`."""

    axes: Axes | None
    figsize: tuple[float, float] | None
    style: str | Mapping[str, Any] | None
    coordinates: tuple[int, int]


class MotionOptions(TypedDict, total=False):
    """Options of an animation of a cycle; see :func:`contvines.plots.cycles.animate_cycle`."""

    seconds: float
    rate: int
    figsize: tuple[float, float]
    style: str | Mapping[str, Any] | None
    coordinates: tuple[int, int]


class CycleOrbit:
    """A cycle of a flow.

    Attributes
    ----------
    times : ndarray, shape (n,)
        Times of the mesh points and nodes, from 0 to the period.
    states : ndarray, shape (n, d)
    period : float
    parameters : dict of float
    multipliers : ndarray of complex
        For autonomous flows without the trivial one.
    stable : bool or None
    marginal : bool
        Whether it belongs to a special point, at which a multiplier lies on the unit circle by definition.
    """

    marginal = False

    def __init__(self, problem: CycleMesh, u: np.ndarray, p: float) -> None:
        self._problem, self.u, self.value = problem, u, p
        x, self.period, widths = problem.parts(u, p)
        self.period = float(np.real(self.period))
        places = mesh.node_places(problem.rule, widths)
        self.times = np.append(places, 1.0) * self.period
        flat = x.reshape(-1, problem.node)
        self.states = np.concatenate([flat, flat[:1]])
        self.parameters = {**problem.parameters, problem.parameter: p}

    def __repr__(self) -> str:
        values = ", ".join(f"{name} = {value:.10g}" for name, value in self.parameters.items())
        stable = {True: "stable", False: "unstable", None: "marginal"}[self.stable]
        return (
            f"CycleOrbit({values}: {stable}, period {self.period:.10g}, {self._problem.intervals} intervals)"
        )

    def __call__(self, t: ArrayLike) -> np.ndarray:
        """Return the states at times, shape (..., d)."""
        t = np.asarray(t, dtype=float)
        x, _, widths = self._problem.parts(self.u, self.value)
        found = mesh.evaluate(self._problem.rule, widths, x, t.reshape(-1) / self.period)
        return found.reshape(*t.shape, self._problem.node)

    def to_dict(self) -> dict[str, Any]:
        """Return the cycle as a JSON-able dict."""
        return {
            "period": self.period,
            "stable": self.stable,
            "parameters": dict(self.parameters),
            "multipliers": pairs(self.multipliers),
            "times": self.times.tolist(),
            "states": self.states.tolist(),
        }

    # ------------------------------------------------------------------ stability
    @cached_property
    def _spectrum(self) -> tuple[np.ndarray, float]:
        return self._linearised().spectrum()

    def _linearised(self) -> CycleWork:
        work = workspace(self._problem)
        linearise(self._problem, self.u, self.value, work)
        return work

    @property
    def multipliers(self) -> np.ndarray:
        """Multipliers over one period, for autonomous flows without the trivial one."""
        return self._spectrum[0]

    @cached_property
    def _finer(self) -> tuple[float, np.ndarray]:
        """Period and multipliers on a mesh with halved intervals; NaN if Newton's method fails there."""
        problem, nothing = self._problem, np.full(len(self.multipliers), np.nan + 0j)
        u = problem.halved(self.u)
        finer = problem.with_unknowns(u, self.value, 2 * problem.intervals, problem.copies)
        found = solved(finer, u, self.value)
        if found is None:
            return np.nan, nothing
        other = CycleOrbit(finer, found, self.value)
        return other.period, other.multipliers

    @property
    def period_error(self) -> float:
        """Estimated error of the period: twice the difference from a mesh with halved intervals, where the error is smaller by the factor 4^-degree."""
        return 2.0 * abs(self._finer[0] - self.period)

    @property
    def multiplier_errors(self) -> np.ndarray:
        """Estimated error of each multiplier, as `period_error`."""
        gaps = np.abs(self.multipliers[:, None] - self._finer[1])
        return 2.0 * gaps.min(axis=1, initial=np.inf)

    @property
    def trivial_error(self) -> float:
        """Distance of the computed trivial multiplier from 1, a measure of the error of the others."""
        return self._spectrum[1]

    @property
    def volume_error(self) -> float:
        """Distance of the logarithm of the product of all multipliers from the integral of the trace of the Jacobian (Liouville).

        It is large for stiff cycles, where collocation contracts less than the flow. Zero for sparse flows, where not all multipliers are known.
        """
        if self._problem.sparse is not None:
            return 0.0
        with np.errstate(divide="ignore"):
            found = float(np.log(np.abs(self.multipliers)).sum())
        return abs(found - self._linearised().growth_of_volume())

    @property
    def stable(self) -> bool | None:
        """Whether all multipliers are inside the unit circle; at a special point None, unless one is outside."""
        sizes = np.abs(self.multipliers)
        return attracts(sizes, 1.0) if self.marginal else bool((sizes < 1.0).all())

    def critical(self, near: float) -> CycleOrbit:
        """Return the cycle as that of a special point: the multiplier nearest to the unit circle is moved onto it, if it is nearer than `near`."""
        found = copy(self)
        vars(found)["_spectrum"] = (onto_circle(self.multipliers, near), self.trivial_error)
        found.marginal = True
        return found

    @property
    def estimated_error(self) -> float:
        """Estimated largest error of the curve between the mesh points, relative to the size of the cycle."""
        return self._problem.estimated_error(self.u)

    # ------------------------------------------------------------------ as a seed
    def problem(self, parameter: str) -> CycleMesh:
        """Return the problem of cycles with this start and a varying parameter."""
        return self._problem.against(parameter, self.parameters)

    def seed(self, problem: Problem) -> tuple[np.ndarray, float]:
        """Return the unknowns, and the value of the varying parameter."""
        return self.u, self.parameters[problem.parameter]

    # ------------------------------------------------------------------ comparison with simulations
    def replay(self) -> float:
        """Return the largest distance of simulations (scipy's DOP853) from the cycle, relative to its scale; each covers an eighth of the period."""
        worst, field = 0.0, self._problem.field
        edges = np.linspace(0.0, self.period, SEGMENTS + 1)
        for start, stop in pairwise(edges):
            end = integrated(field, self.value, self(start), start, stop)
            gap = np.abs(end - self(stop)) / (self._problem.node_scale + np.abs(end))
            worst = max(worst, float(gap.max()))
        return worst

    def simulated_multipliers(self) -> np.ndarray:
        """Compute the multipliers from the variational equations along simulations (scipy's DOP853), with the trivial one; largest first.

        Each simulation begins on the cycle. It ends when one perturbation has grown `spread` times as much as another
        (:class:`contvines.flows.FlowSettings`), at the latest after an eighth of the period. The multipliers are those of the product of all their
        derivatives, computed from the factors, so that 1e+30 and 1e-30 can both be accurate. For sparse flows only the growth is limited, and
        multipliers below 1e-8 are not accurate.

        Raises
        ------
        ValueError
            If a simulation fails.
        """
        nodes = self.times[:: self._problem.rule.degree]
        cuts = np.unique(np.linspace(0, len(nodes) - 1, SEGMENTS + 1).astype(int))
        found = [m for i, j in pairwise(cuts) for m in self._flights(nodes[i : j + 1], self(nodes[i]))]
        return multipliers_of(
            np.array(found), np.broadcast_to(-np.eye(len(found[0])), (len(found), *found[0].shape))
        )

    def _flights(self, times: np.ndarray, x: np.ndarray) -> list[np.ndarray]:
        """Derivatives of simulations from a state through these times; halved, at mesh points first, until the spread is small enough."""
        field, scale = self._problem.field, self._problem.node_scale
        matrix = variational(field, self.value, x, times[0], times[-1])[1]
        if not np.isfinite(matrix).all():
            raise ValueError(
                f"the simulation from t = {times[0]:.6g} on the cycle fails; orbit.multipliers has the multipliers by collocation"
            )
        spread = np.linalg.norm if self._problem.sparse is not None else np.linalg.cond
        if spread(matrix * scale / scale[:, None]) < field.settings.spread:
            return [matrix]
        half = len(times) // 2
        if len(times) == 2:
            times = np.linspace(times[0], times[1], 3)
            middle = integrated(field, self.value, x, times[0], times[1])
        else:
            middle = self(times[half])
        return self._flights(times[: half + 1], x) + self._flights(times[half:], middle)

    # ------------------------------------------------------------------ pictures
    def plot(self, **options: Unpack[PictureOptions]) -> Figure:
        """Phase portrait and time series; see :func:`contvines.plots.cycles.plot_cycle`."""
        from ..plots.cycles import plot_cycle

        return plot_cycle(self, **options)

    def animate(self, path: str | Path | None = None, **options: Unpack[MotionOptions]) -> FuncAnimation:
        """Animate the cycle, and write a gif, mp4 or html file if a path is given; see :func:`contvines.plots.cycles.animate_cycle`."""
        from ..plots.cycles import animate_cycle

        return animate_cycle(self, path, **options)


def integrated(field: Field, p: float, x: np.ndarray, start: float, stop: float) -> np.ndarray:
    """Integrate a state from one time to another; NaN if the integrator fails."""
    from scipy.integrate import solve_ivp

    s = field.settings
    size = cast("float", s.exact_absolute * (s.smallest * field.lengths + np.abs(x)))
    found = solve_ivp(field.rate_at(p), (start, stop), x, method="DOP853", rtol=s.exact_relative, atol=size)
    return found.y[:, -1] if found.success else np.full(len(x), np.nan)


def variational(
    field: Field, p: float, x: np.ndarray, start: float, stop: float
) -> tuple[np.ndarray, np.ndarray]:
    """Integrate a state from one time to another, with its derivative by the initial state; NaN if the integrator fails."""
    from scipy.integrate import solve_ivp

    d = len(x)

    def rate(t: float, y: np.ndarray) -> np.ndarray:
        time, state = np.array([t]) if field.forced else None, y[None, :d]
        matrix = field.jacobian(state, p, time)[0]
        return np.concatenate([field(state, p, time)[0], (matrix @ y[d:].reshape(d, d)).reshape(-1)])

    begin = np.concatenate([x, np.eye(d).reshape(-1)])
    s = field.settings
    try:
        found = solve_ivp(
            rate, (start, stop), begin, method="DOP853", rtol=s.exact_relative, atol=s.exact_absolute
        )
    except NotEvaluable:
        return np.full(d, np.nan), np.full((d, d), np.nan)
    end = found.y[:, -1] if found.success else np.full(len(begin), np.nan)
    return end[:d], end[d:].reshape(d, d)
