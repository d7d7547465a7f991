"""FlowProblem: a user's differential equations, and where their equilibria and cycles begin."""

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

    ``contvines.diagram(flow, over=, within=)`` begins at the equilibrium near ``x0`` (at what a motion from ``x0`` settles on, of
    forced flows) and finds Hopf points, the cycles that leave there, and their bifurcations.

    Parameters
    ----------
    f : callable
        (x, p) -> d numbers, of forced flows (x, p, t). It may be written for arrays, ``x[0]`` being a number or an array of
        numbers; whether it is, is found out. Or :class:`contvines.flows.CompiledRates`, functions in C.
    x0 : array_like, shape (d,)
        A start.
    params : float, or mapping of str to float
        Values of the parameters by name: ``f`` then reads ``p.name``.
    mirror : callable, matrix or permutation, optional
        x -> R x with R R x = x and f(R x, p) = R f(x, p); of forced flows at the same time or half a period later, which is found out.
    period : callable or float, optional
        p -> period of f in t: the flow is forced.
    jacobian : callable, optional
        df/dx of the same arguments, shape (d, d). Else the complex step, where f allows it, or differences.
    derivative : callable, or mapping of str to callable, optional
        df/dp, shape (d,); of several parameters by name.
    degree : int
        Of the collocation polynomials, 2 to 7.
    error : float, optional
        Largest error of a cycle between its mesh points, relative to its size; intervals are halved where it is larger. Periods,
        parameters and multipliers have the square of that, nearly.
    settings : FlowSettings or mapping of str to float, optional
        Other tolerances than the defaults; see :class:`contvines.flows.FlowSettings`.
    scale : float or array_like of shape (d,), optional
        What counts as large in each coordinate.
    states : sequence of str, optional
        Names of the states, as measures have them (``max x``); x0, x1, ... if left out.
    events : mapping of str to callable, optional
        By name, functions (x, p) -> number, of forced flows (x, p, t), that stop a motion where one of them becomes zero. Motions are
        on the side of ``x0``. Branches end, labelled EV, where an equilibrium or a cycle comes to touch an event.
    parameter : str
        Name of the parameter that varies if nobody says so; the first one if it is left out.
    name : str

    Raises
    ------
    ValueError
        If f does not return d finite numbers at the start, or a derivative, the mirror or the degree is wrong.
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
            self.measure_of(what, state): (what, j)
            for what in OF_STATES
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
        """A flow from SymPy expressions; its Jacobian is differentiated.

        Parameters
        ----------
        expressions : sequence of sympy expressions
            The rates of the states.
        states : sequence of sympy symbols, or functions of time as x(t)
        x0 : array_like
        params : mapping of str to float
            Values of all other symbols, by name.
        time : sympy symbol, optional
            Of forced flows.
        **options
            Of :class:`FlowProblem`.

        Raises
        ------
        ValueError
            If a symbol has no value.
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
        """The equilibria as a continuation problem; of a forced flow the cycle on which its start settles.

        Parameters
        ----------
        parameter : str, optional
            The one that varies; by default the first of `params`.
        """
        parameter = self.values.varying if parameter is None else parameter
        if self._equilibria is not None:
            return self.equilibria(parameter)
        return self.attractor(self.x0).problem(parameter)

    def seed(self, problem: Started) -> tuple[np.ndarray, float]:
        """The start of such a problem."""
        return problem.u0, problem.p0

    def equilibria(
        self, parameter: str | None = None, values: Mapping[str, float] | None = None
    ) -> Equilibria:
        """The equilibria as a continuation problem.

        Parameters
        ----------
        parameter : str, optional
            The one that varies; by default the first of `params`.
        values : mapping, optional
            Of other parameters.

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
        """Starts in a box of states, for `atlas` and `basins`.

        Parameters
        ----------
        over : str, optional
            The parameter that varies; by default the first of `params`.
        box : sequence of (float, float), optional
            Smallest and largest value of each state; by default round the flow's own start.
        around : ndarray, shape (n, d), optional
            States round which the box is laid, such as those of a cycle.
        **values
            Of parameters.
        """
        return self.population_at(values, over, box, around)

    def population_at(
        self,
        values: Mapping[str, float],
        over: str | None = None,
        box: Sequence[tuple[float, float]] | None = None,
        around: np.ndarray | None = None,
    ) -> FlowPopulation:
        """:meth:`population` with values of parameters in a mapping."""
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
        """The cycle on which a motion settles: simulated until it recurs, then solved for.

        Parameters
        ----------
        x0 : array_like, optional
            Where the motion begins; the flow's own start if left out.
        transient : float, optional
            Time before recurrence is looked for; it is lengthened as long as nothing recurs.
        longest : int
            Returns (periods of the forcing) after which a motion is given up.
        doublings : int
            How often the transient is lengthened before that.
        **values
            Of parameters.

        Returns
        -------
        CycleOrbit
            `contvines.diagram` begins with it.

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
        """:meth:`attractor` with values of parameters in a mapping: they may have the names of its arguments."""
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
        """The cycle near given states at given times, from the first time to one period later.

        Parameters
        ----------
        times : array_like, shape (n,)
        states : array_like, shape (n, d)
        rounds : int, optional
            Of forced flows: after so many periods of the forcing; by default as many as the times tell.
        **values
            Of parameters.

        Raises
        ------
        ValueError
            If the data are no cycle, or Newton's method does not lead from them to one.
        """
        return self.cycle_at(values, times, states, rounds)

    def cycle_at(
        self, values: Mapping[str, float], times: ArrayLike, states: ArrayLike, rounds: int | None = None
    ) -> CycleOrbit:
        """:meth:`cycle` with values of parameters in a mapping."""
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
        """The problem of cycles; scales are those of the first one that was asked for, so that cycles of all can be compared."""
        if self.sizes is None:
            self.sizes = np.array(sizes[0], dtype=float), float(sizes[1])
        return CycleProblem(self, field, u, counts, (*self.sizes, sizes[2]))

    def problem_of(self, description: Mapping[str, Any]) -> Equilibria | CycleProblem:
        """Equilibria or cycles from what ``describe()`` of them returned."""
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

    # ------------------------------------------------------------------ measures, and what else attracts
    def simulated_attractors(self, problem: Problem, p: float, starts: int) -> list[dict[str, Any]]:
        """What starts settle on: "word" and "kind" of each motion, "periods" of the forcing, and "u", the extremes of its states."""
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
        """A stable solution as `simulated_attractors` lists it."""
        if isinstance(problem, CycleProblem):
            word, periods = "cycle", problem.rounds if self.field.forced else 0
            curve, image = curves(self, problem.orbit(u, p), periods)
        else:
            word, periods, curve = "equilibrium", 0, np.asarray(u, dtype=float)[None, : len(self.x0)]
            image = None if self.mirror is None else self.mirror(curve[0])[None]
        return {"word": word, "periods": periods, "kind": "periodic", "u": self._extremes(curve, image)}

    def _extremes(self, curve: np.ndarray, image: np.ndarray | None) -> list[float]:
        """Least and largest state along a motion, of two mirror images those of the one that is larger first: of two motions that are one they agree to a few digits."""
        own = np.concatenate([curve.min(axis=0), curve.max(axis=0)])
        if image is not None:
            other = np.concatenate([image.min(axis=0), image.max(axis=0)])
            apart = np.flatnonzero(np.abs(own - other) > self.settings.near * np.abs(own).max())
            own = other if apart.size and other[apart[0]] > own[apart[0]] else own
        return own.tolist()

    def describe(self) -> dict[str, Any]:
        """Name, start, and how to build the flow again if its functions can be imported."""
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
