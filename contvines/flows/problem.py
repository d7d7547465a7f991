"""FlowProblem: a user's differential equations, with the starts of their equilibria and cycles."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Unpack

import numpy as np

from contvines.shared.near_names import hinting

from ..problems.abilities import Populated, Started
from ..problems.functions import ParameterSet
from ..problems.scales import flat_start
from ..problems.symmetries import image_map, refuse_no_mirror
from . import mesh
from .at_points import CompiledRates
from .cycles import CycleProblem
from .equilibria import Equilibria
from .expressions import compiled_expressions, name_of
from .field import Field
from .first_cycle import cycle_beside
from .flow import Flow, FlowOptions, is_number, period_of
from .measures import OF_STATES, checked_names
from .orbit import CycleOrbit
from .population import FlowPopulation, Settled, curves
from .settings import FlowSettings
from .simulation import Stopped, recurrence

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from ..problems.protocol import Problem
    from .cycle_mesh import CycleMesh
    from .flow import Sizes


class FlowProblem(Flow):
    """Equilibria and cycles of x' = f(x, p), or cycles of x' = f(x, p, t) with a period in t.

    ``contvines.diagram(flow, over=, within=)`` begins at the equilibrium near ``x0`` (for forced flows: at the cycle on which a motion from
    ``x0`` settles) and finds Hopf points, the cycles that leave there, and their bifurcations.

    Parameters
    ----------
    f : callable
        (x, p) -> d numbers; for forced flows (x, p, t) -> d numbers. It may be vectorised, so that ``x[0]`` is a number or an array of
        numbers; this is detected. Or :class:`contvines.flows.CompiledRates`, functions in C.
    x0 : array_like, shape (d,)
        A start.
    params : float, or mapping of str to float
        Values of the parameters by name: ``f`` then reads ``p.name``.
    mirror : callable, matrix or permutation, optional
        x -> R x with R R x = x and f(R x, p) = R f(x, p); for forced flows at the same time or half a period later, which is detected.
    period : callable or float, optional
        p -> period of f in t, for forced flows.
    jacobian : callable, optional
        df/dx of the same arguments, shape (d, d). By default the complex step if f allows it, else differences.
    derivative : callable, or mapping of str to callable, optional
        df/dp, shape (d,); a mapping by name for several parameters.
    degree : int
        Degree of the collocation polynomials, 2 to 7.
    error : float, optional
        Largest error of a cycle between its mesh points, relative to its size; if it is larger, the mesh intervals are halved. The errors
        of periods, parameters and multipliers are nearly the square of it.
    settings : FlowSettings or mapping of str to float, optional
        Tolerances that differ from the defaults; see :class:`contvines.flows.FlowSettings`.
    scale : float or array_like of shape (d,), optional
        Typical size of each state; by default from the start and the first cycle.
    states : sequence of str, optional
        Names of the states, for measures (``max x``); x0, x1, ... by default.
    events : mapping of str to callable, optional
        Functions (x, p) -> number, for forced flows (x, p, t) -> number, by name; a motion stops where one of them vanishes. Motions are
        on the side of ``x0``. A branch ends (label EV) where an equilibrium or a cycle touches an event.
    parameter : str
        Name of the parameter that varies by default; the first one if it is left out.
    name : str
        For tables.

    Raises
    ------
    ValueError
        If f does not return d finite numbers at the start, or if a derivative, the mirror, an event or another argument is wrong.
    """

    @hinting
    def __init__(
        self,
        f: Callable,
        x0: Sequence[float] | np.ndarray | float,
        params: float | Mapping[str, float] = 0.0,
        *,
        mirror: Callable[[np.ndarray], ArrayLike] | ArrayLike | None = None,
        period: Callable | float | None = None,
        jacobian: Callable | None = None,
        derivative: Callable | Mapping[str, Callable] | None = None,
        degree: int = 4,
        error: float | None = None,
        settings: FlowSettings | Mapping[str, float] | None = None,
        scale: ArrayLike | None = None,
        states: Sequence[str] | None = None,
        events: Mapping[str, Callable] | None = None,
        parameter: str = "p",
        name: str = "flow",
    ) -> None:
        if not callable(f):
            raise ValueError(f"f = {f!r} must be a function of (x, p), or of (x, p, t) with period=")
        mesh.rule(degree)
        self.settings = FlowSettings.of(settings)
        self.error = self.settings.error if error is None else error
        if not (isinstance(self.error, (int, float)) and 0.0 < self.error < 1.0):
            raise ValueError(f"error = {error!r} must be a number between 0 and 1")
        self.x0, self.degree, self.name = flat_start(x0, "x0"), int(degree), name
        self.values = ParameterSet(params, parameter)
        if isinstance(f, CompiledRates):
            jacobian = jacobian or (f.jacobian if f.dfdx is not None else None)
            derivative = derivative or (
                f.derivatives(list(self.values.values)) if f.dfdp is not None else None
            )
        self.given = {"F": f, "jacobian": jacobian, "derivative": derivative, "mirror": mirror}
        if events:
            self.given["events"] = events
        d = len(self.x0)
        self.given_states, self.states = states, checked_names(states, d)
        self.of_states = {
            self.measure_of(extreme, state): (extreme, j)
            for extreme in OF_STATES
            for j, state in enumerate(self.states)
        }
        self.given_period, self.given_scale = period, scale
        self.mirror = None if mirror is None else image_map(mirror, d)
        if self.mirror is not None:
            refuse_no_mirror(self.mirror, d)
        self.field = Field(
            f,
            jacobian,
            derivative,
            events,
            self.x0,
            self.values,
            period_of(period, self.values),
            self.settings,
        )
        self.events = self.field.events
        self._check_rates()
        self._equilibria = None if self.field.forced else Equilibria(self, params, parameter)

    @classmethod
    def from_sympy(
        cls,
        expressions: Sequence[object],
        states: Sequence[object],
        x0: Sequence[float],
        params: Mapping[str, float],
        *,
        time: object = None,
        **options: Unpack[FlowOptions],
    ) -> FlowProblem:
        """Make a flow from SymPy expressions; its Jacobian is derived symbolically.

        Parameters
        ----------
        expressions : sequence of sympy expressions
            The rates of the states.
        states : sequence of sympy symbols, or functions of time as x(t)
        x0 : array_like
        params : mapping of str to float
            Values of all other symbols, by name.
        time : sympy symbol, optional
            Symbol of the time, for forced flows.
        **options
            Options of :class:`FlowProblem`.

        Raises
        ------
        ValueError
            If a symbol has no value, or an expression cannot be read.
        """
        if not isinstance(params, Mapping):
            raise ValueError(f"params = {params!r} must be values by name, such as {{'a': 1.0}}")
        if (time is None) != (options.get("period") is None):
            raise ValueError(
                "time= and period= belong together: the symbol of the time, and the period of the forcing"
            )
        f, jacobian = compiled_expressions(expressions, states, list(params), time)
        return cls(f, x0, params, jacobian=jacobian, states=[name_of(state) for state in states], **options)

    # ------------------------------------------------------------------ as a seed
    @property
    def parameters(self) -> dict[str, float]:
        """All parameters by name."""
        return dict(self.values.values)

    def problem(self, parameter: str | None = None) -> Equilibria | CycleMesh:
        """Return the equilibria as a continuation problem; for a forced flow the cycle on which a motion from ``x0`` settles.

        Parameters
        ----------
        parameter : str, optional
            Parameter that varies; by default the first of `params`.
        """
        parameter = self.values.varying if parameter is None else parameter
        if self._equilibria is not None:
            return self.equilibria(parameter)
        return self.attractor(self.x0).problem(parameter)

    def seed(self, problem: Started) -> tuple[np.ndarray, float]:
        """Return the start of a problem of this flow: unknowns and parameter value."""
        return problem.u0, problem.p0

    def equilibria(
        self, parameter: str | None = None, values: Mapping[str, float] | None = None
    ) -> Equilibria:
        """Return the equilibria as a continuation problem.

        Parameters
        ----------
        parameter : str, optional
            Parameter that varies; by default the first of `params`.
        values : mapping, optional
            New values of parameters.

        Raises
        ------
        ValueError
            If the flow is forced.
        """
        if self._equilibria is None:
            raise ValueError("a forced flow has no equilibria")
        parameter = self._equilibria.parameter if parameter is None else parameter
        if parameter == self._equilibria.parameter and not values:
            return self._equilibria
        return self._equilibria.against(parameter, values)

    @hinting
    def population(
        self,
        over: str | None = None,
        *,
        box: Sequence[tuple[float, float]] | None = None,
        around: np.ndarray | None = None,
        **values: float,
    ) -> FlowPopulation:
        """Return a population of starts in a box of states, for `atlas` and `basins`.

        Parameters
        ----------
        over : str, optional
            Parameter that varies; by default the first of `params`.
        box : sequence of (float, float), optional
            Smallest and largest value of each state; by default a box around the flow's start.
        around : ndarray, shape (n, d), optional
            States that the default box contains, such as those of a cycle.
        **values
            Values of parameters.
        """
        return self.population_at(values, over, box, around)

    def population_at(
        self,
        values: Mapping[str, float],
        over: str | None = None,
        box: Sequence[tuple[float, float]] | None = None,
        around: np.ndarray | None = None,
    ) -> FlowPopulation:
        """Call :meth:`population` with parameter values in a mapping."""
        return FlowPopulation(self, self.values.varying if over is None else over, values, box, around)

    # ------------------------------------------------------------------ cycles
    @hinting
    def attractor(
        self,
        x0: ArrayLike | None = None,
        *,
        transient: float | None = None,
        longest: int = 64,
        doublings: int = 12,
        **values: float,
    ) -> CycleOrbit:
        """Find the cycle on which a motion settles: simulate until the motion recurs, then solve for the cycle.

        Parameters
        ----------
        x0 : array_like, optional
            Start of the motion; by default the flow's start.
        transient : float, optional
            Time before the motion is tested for recurrence; it is doubled while the motion does not recur.
        longest : int
            Most returns (periods of the forcing) of the cycle.
        doublings : int
            Most doublings of the transient.
        **values
            Values of parameters.

        Returns
        -------
        CycleOrbit
            A start for `contvines.diagram`.

        Raises
        ------
        ValueError
            If the motion escapes, comes to rest, or does not recur.
        """
        return self.attractor_at(values, x0, transient=transient, longest=longest, doublings=doublings)

    def attractor_at(
        self,
        values: Mapping[str, float],
        x0: ArrayLike | None = None,
        *,
        transient: float | None = None,
        longest: int = 64,
        doublings: int = 12,
    ) -> CycleOrbit:
        """Call :meth:`attractor` with parameter values in a mapping, so that parameters may have the names of its arguments."""
        parameters = self.values.against(self.values.varying, values)
        start = self.x0 if x0 is None else flat_start(x0, "x0")
        if len(start) != len(self.x0):
            raise ValueError(f"x0 has {len(start)} numbers; the flow has {len(self.x0)} states")
        if not np.isfinite(start).all():
            raise ValueError(f"x0 = {start.tolist()} must be finite")
        if transient is not None and not (is_number(transient) and 0.0 < transient < np.inf):
            raise ValueError(f"transient = {transient!r} must be a positive time")
        longest, doublings = _at_least_one("longest", longest), _at_least_one("doublings", doublings)
        field = self.field.against(parameters)
        for name, value in zip(
            self.events.names,
            self.events(start[None], parameters.at(parameters.start), np.zeros(1))[0],
            strict=True,
        ):
            if value < 0.0:
                raise Stopped(
                    f"x0 = {start.tolist()} lies beyond the event {name}, which stops motions; begin on the other side"
                )
        times, states, rounds = recurrence(field, parameters.start, start, transient, longest, doublings)
        return cycle_beside(self, times, states, parameters, rounds)

    @hinting
    def cycle(
        self, times: ArrayLike, states: ArrayLike, *, rounds: int | None = None, **values: float
    ) -> CycleOrbit:
        """Solve for the cycle near given states; the times cover one period.

        Parameters
        ----------
        times : array_like, shape (n,)
        states : array_like, shape (n, d)
        rounds : int, optional
            Forced flows: periods of the forcing in one period of the cycle; by default from the times.
        **values
            Values of parameters.

        Raises
        ------
        ValueError
            If the data have a wrong shape, or Newton's method does not converge to a cycle.
        """
        return self.cycle_at(values, times, states, rounds)

    def cycle_at(
        self, values: Mapping[str, float], times: ArrayLike, states: ArrayLike, rounds: int | None = None
    ) -> CycleOrbit:
        """Call :meth:`cycle` with parameter values in a mapping."""
        t, x = _numbers("times", times), _numbers("states", states)
        if t.ndim != 1 or len(t) < 5 or not (np.diff(t) > 0.0).all():
            raise ValueError("times must be at least five increasing numbers")
        if x.shape != (len(t), len(self.x0)):
            raise ValueError(f"states has shape {x.shape}; ({len(t)}, {len(self.x0)}) is needed")
        if not np.isfinite(x).all():
            raise ValueError("states must be finite")
        if rounds is not None:
            rounds = _at_least_one("rounds", rounds)
        parameters = self.values.against(self.values.varying, values)
        field = self.field.against(parameters)
        if field.forced and rounds is None:
            rounds = max(1, round(float(t[-1] - t[0]) / float(field.length_of_period(parameters.start))))
        return cycle_beside(self, t, x, parameters, rounds or 1)

    def cycles(self, field: Field, u: np.ndarray, counts: tuple[int, int, int], sizes: Sizes) -> CycleProblem:
        """Return the problem of cycles; all have the scales of the first call, so that cycles of different branches can be compared."""
        if self.sizes is None:
            self.sizes = np.array(sizes[0], dtype=float), float(sizes[1])
        return CycleProblem(self, field, u, counts, (*self.sizes, sizes[2]))

    def problem_of(self, description: Mapping[str, Any]) -> Equilibria | CycleProblem:
        """Rebuild equilibria or cycles of this flow from the result of their ``describe()``."""
        values = description["p0"]
        named = dict(values) if isinstance(values, Mapping) else {description["parameter"]: values}
        cycle = description.get("cycle")
        if cycle is None:
            found = self.equilibria(description["parameter"], named)
            found.u0 = np.array(description["u0"], dtype=float)
            return found
        self.sizes = np.array(cycle["scale"], dtype=float), float(cycle["clock"])
        field = self.field.against(self.values.against(description["parameter"], named))
        counts = cycle["intervals"], cycle["rounds"], cycle["copies"]
        return self.cycles(field, np.array(cycle["u0"], dtype=float), counts, (*self.sizes, cycle["unit"]))

    # ------------------------------------------------------------------ attractors
    def simulated_attractors(self, problem: Problem, p: float, starts: int) -> list[dict[str, Any]]:
        """Simulate starts and list what they settle on: "word", "kind" and forcing "periods" of each motion, and "u", the extremes of its states."""
        assert isinstance(problem, Populated)
        population = problem.population()
        motions, _, _ = population.settle(population.starts(starts, 7, p), p)
        found = []
        for motion in motions:
            entry: dict[str, Any] = {
                "word": motion.word or None,
                "periods": motion.periods,
                "kind": motion.kind,
            }
            if isinstance(motion, Settled) and motion.curve is not None:
                entry["u"] = self._extremes(motion.curve, motion.image)
            found.append(entry)
        return sorted(found, key=lambda one: (str(one["word"]), one["kind"], one.get("u", [])))

    def known(self, problem: Problem, u: np.ndarray, p: float) -> dict[str, Any]:
        """Return a stable solution as an entry of `simulated_attractors`."""
        if isinstance(problem, CycleProblem):
            word, periods = "cycle", problem.rounds if self.field.forced else 0
            curve, image = curves(self, problem.orbit(u, p), periods)
        else:
            word, periods, curve = "equilibrium", 0, np.asarray(u, dtype=float)[None, : len(self.x0)]
            image = None if self.mirror is None else self.mirror(curve[0])[None]
        return {"word": word, "periods": periods, "kind": "periodic", "u": self._extremes(curve, image)}

    def _extremes(self, curve: np.ndarray, image: np.ndarray | None) -> list[float]:
        """Smallest and largest values of the states along a motion; of two mirror images those of the one with the larger first different value.

        For equal motions they agree to a few digits.
        """
        extremes = np.concatenate([curve.min(axis=0), curve.max(axis=0)])
        if image is not None:
            other = np.concatenate([image.min(axis=0), image.max(axis=0)])
            different = np.flatnonzero(np.abs(extremes - other) > self.settings.near * np.abs(extremes).max())
            extremes = other if different.size and other[different[0]] > extremes[different[0]] else extremes
        return extremes.tolist()

    def describe(self) -> dict[str, Any]:
        """Return name, start, and the data from which the flow is rebuilt if its functions can be imported."""
        return super().describe() if self._equilibria is None else self._equilibria.describe()


def _at_least_one(name: str, given: float) -> int:
    if not is_number(given) or given != int(given) or given < 1:
        raise ValueError(f"{name} = {given!r} must be a whole number, 1 or more")
    return int(given)


def _numbers(name: str, given: ArrayLike) -> np.ndarray:
    try:
        return np.asarray(given, dtype=float)
    except (TypeError, ValueError):
        raise ValueError(f"{name} must be numbers") from None
