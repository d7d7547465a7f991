"""FlowProblem: a user's differential equations, and where their equilibria and cycles begin."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, TypedDict, Unpack

import numpy as np

from contvines.shared.floating_point import TINY
from contvines.shared.near_names import hinting

from ..problems.abilities import Populated, Started
from ..problems.functions import NotEvaluable, ParameterSet, difference_text
from ..problems.protocol import Seed
from ..problems.registry import addresses
from ..problems.scales import flat_start, given_scale
from ..problems.symmetries import image_map, refuse_no_mirror
from . import mesh
from .attractors import SAMPLES, Stopped, recurrence
from .collocation import rule
from .compiled import CompiledRates
from .cycles import CycleProblem
from .equilibria import Equilibria
from .events import Events
from .expressions import compiled_expressions, name_of
from .field import Field
from .names import OF_STATES, checked_names
from .newton import settled
from .orbit import CycleOrbit
from .population import FlowPopulation, Settled, curves
from .settings import FlowSettings
from .simulation import rates

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from ..problems.protocol import BorderPoint, Problem
    from .cycle_mesh import CycleMesh
    from .flow import Sizes

INTERVALS = 40  # of a cycle from data, to begin with ...
HALVES = 2  # equal parts of its mesh, so that what comes back half a period later, itself or its mirror image, is as exact as the cycle
MORE = 4, 16  # ... and times those, where that does not converge, as bursts of sharp spikes
MOST_TURNS = 64  # after which a motion may come back to where it was
MESHES = 10.0  # times the error of a cycle between its mesh points: cycles on different meshes that are one


class FlowOptions(TypedDict, total=False):
    """What may be said of a flow beside its equations; see :class:`FlowProblem`."""

    mirror: Callable[[np.ndarray], ArrayLike] | ArrayLike | None
    period: Callable | float | None
    derivative: Callable | Mapping[str, Callable] | None
    degree: int
    error: float | None
    settings: FlowSettings | Mapping[str, float] | None
    scale: ArrayLike | None
    events: Mapping[str, Callable] | None
    parameter: str
    name: str


class NamedOptions(FlowOptions, total=False):
    """The same, and names of the states."""

    states: Sequence[str] | None


class FlowProblem:
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
        rule(degree)
        self.settings = FlowSettings.of(settings)
        self.error = self.settings.error if error is None else error
        if not (isinstance(self.error, (int, float)) and 0.0 < self.error < 1.0):
            raise ValueError(f"error = {error!r} must be a number between 0 and 1")
        self.x0, self.degree, self.name = flat_start(x0, "x0"), int(degree), name
        if isinstance(f, CompiledRates):
            names = list(ParameterSet(params, parameter).values)
            jacobian = jacobian or (f.jacobian if f.dfdx is not None else None)
            derivative = derivative or (f.derivatives(names) if f.dfdp is not None else None)
        self.given = {"F": f, "jacobian": jacobian, "derivative": derivative, "mirror": mirror}
        if events:
            self.given["events"] = events
        self.given_states, self.states = states, checked_names(states, len(self.x0))
        names = [(what, j) for what in OF_STATES for j in range(len(self.x0))]
        self.of_states = {self.measure_of(what, self.states[j]): (what, j) for what, j in names}
        self.given_period, self.given_scale = period, scale
        self.values = ParameterSet(params, parameter)
        self.mirror = None if mirror is None else image_map(mirror, len(self.x0))
        if self.mirror is not None:
            refuse_no_mirror(self.mirror, len(self.x0))
        self.mirror_shifted = False
        self.origin: tuple[str, str, str] | None = None  # file, name and digest, of a flow that a study names
        self.sizes: tuple[np.ndarray, float] | None = None  # of states and periods of cycles
        self.box: Sequence[tuple[float, float]] | None = (
            None  # in which motions begin, of a study that has one
        )
        self.field = Field(
            f, jacobian, derivative, self.x0, self.values, _period(period, self.values), self.settings
        )
        self._refuse_random_rates()
        self.events = self.field.events = Events(events, self.field.forced, self.x0, self.values)
        if self.field.forced:
            self._check_period()
            self._find_mirror()
            self._equilibria = None
        else:
            self._equilibria = Equilibria(
                self,
                f,
                self.x0,
                params,
                parameter,
                jacobian=jacobian,
                derivative=derivative,
                mirror=mirror,
                name=name,
                scale=scale,
            )

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

    def _refuse_random_rates(self) -> None:
        """Refuse a right-hand side that differs when it is asked twice: a simulation of it may take ever smaller steps, without end."""
        rate = rates(self.field, self.values.start)
        with np.errstate(all="ignore"):
            different = difference_text(rate(0.0, self.x0), rate(0.0, self.x0))
        if different:
            raise ValueError(different)

    def _check_period(self) -> None:
        """Whether the right-hand side repeats after its period, tried at states beside the start.

        Raises
        ------
        ValueError
            If it does not.
        """
        rng, p = np.random.default_rng(6), self.values.start
        period = self.field.length_of_period(p)
        x = self.x0 + self.field.lengths * rng.uniform(-0.1, 0.1, (6, len(self.x0)))
        t = rng.uniform(0.0, period, 6)
        try:
            with np.errstate(all="ignore"):
                one, later = self.field(x, p, t), self.field(x, p, t + period)
        except NotEvaluable:
            return  # states beside the start may be outside of where f is defined
        size = TINY + np.nanmax(np.abs(one), initial=0.0)
        if np.nanmax(np.abs(one - later), initial=0.0) > self.settings.recurs * size:
            raise ValueError(
                f"period = {period:.10g} at the start is no period of f(x, p, t) in t: f differs there after that time; mend period= or f"
            )

    def _find_mirror(self) -> None:
        """Whether the mirror image of a forced motion is one at the same time, or half a period later.

        Raises
        ------
        ValueError
            If it is neither.
        """
        if self.mirror is None:
            return
        rng, p = np.random.default_rng(4), self.values.start
        x = self.x0 + self.field.lengths * rng.uniform(-1.0, 1.0, (6, len(self.x0)))
        period = self.field.length_of_period(p)
        t = rng.uniform(0.0, period, 6)
        images = np.array([self.mirror(y) for y in x])
        still = self.mirror(np.zeros(len(self.x0)))
        wanted = np.array([self.mirror(y) - still for y in self.field(x, p, t)])
        size = TINY + np.abs(wanted).max()
        for shifted in (True, False):
            found = self.field(images, p, t + (0.5 * period if shifted else 0.0))
            if np.abs(found - wanted).max() <= self.settings.agree * size:
                self.mirror_shifted = shifted
                return
        raise ValueError(
            "mirror: f(R x, p, t) is neither R f(x, p, t) nor R f(x, p, t + period/2); leave mirror= out, or mend it"
        )

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
        if transient is not None and not (_is_number(transient) and 0.0 < transient < np.inf):
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
        return self._cycle(times, states, parameters, rounds)

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
        return self._cycle(t, x, parameters, rounds or 1)

    def _cycle(
        self, times: np.ndarray, states: np.ndarray, parameters: ParameterSet, rounds: int
    ) -> CycleOrbit:
        field, d = self.field.against(parameters), len(self.x0)
        ranges = np.ptp(states, axis=0)
        given = given_scale(self.given_scale, d)
        s = self.settings
        moves = (ranges > s.still * field.lengths).any()
        own = np.maximum(ranges, s.smallest * ranges.max()) if moves else field.lengths
        scale = own if given is None else given
        count = INTERVALS * (rounds if field.forced else 1)
        unit, clock = abs(parameters.start) or 1.0, float(times[-1] - times[0])
        found = None
        for more in (1, *MORE):
            if found is not None:
                break
            n = more * count
            for widths in (np.full(n, 1.0 / n), mesh.along_data(times, states / scale, n, HALVES)):
                guess = self._guess(field, parameters.start, times, states, widths, rounds)
                cycles = self.cycles(field, guess, (n, rounds, HALVES), (scale, clock, unit))
                found = found or settled(cycles, guess, parameters.start)
        if found is None:
            raise ValueError(
                "Newton's method does not converge from these states; give a longer transient= (of attractor), or times and states nearer to one period of a cycle"
            )
        cycles, u = found
        # rest of a forced flow is a motion with the period of its forcing
        if not field.forced and np.ptp(u[: cycles.states].reshape(-1, d) / scale, axis=0).max() < s.same:
            raise ValueError("Newton's method leads from these states to an equilibrium, not to a cycle")
        name = cycles.crossed(u, parameters.start)
        if name is not None:
            raise Stopped(f"the cycle crosses the event {name}, which stops the motion")
        shorter = cycles.root(u, parameters.start)
        if shorter is not None and isinstance(shorter[0], CycleProblem):
            cycles, u = shorter[0], shorter[1]
        orbit = CycleOrbit(cycles, u, parameters.start)
        return self._once(orbit, parameters, cycles.rounds) or orbit

    def _once(self, orbit: CycleOrbit, parameters: ParameterSet, rounds: int) -> CycleOrbit | None:
        """The shorter cycle that an orbit repeats several times; None if there is none.

        A motion that goes round a cycle while it comes nearer may recur after several periods sooner than after one.
        """
        field, s = self.field.against(parameters), self.settings
        if field.forced and rounds == 1:
            return None
        own = np.ptp(orbit.states, axis=0) / field.lengths
        size = field.lengths * np.maximum(own, s.least * own.max())
        near, exact = (size * share + s.still * field.lengths for share in (s.recurs, MESHES * self.error))
        times = np.linspace(0.0, orbit.period, SAMPLES + 1)
        states, parts = orbit(times), np.arange(rounds if field.forced else MOST_TURNS, 1, -1)
        parts = parts[(np.abs(orbit(orbit.period / parts) - states[0]) <= near).all(axis=1)]
        for n in parts.tolist():
            if field.forced and rounds % n:
                continue
            if not (np.abs(orbit((times + orbit.period / n) % orbit.period) - states) <= near).all():
                continue
            share, left = times / n, rounds // n if field.forced else 1
            try:
                shorter = self._cycle(share, orbit(share), parameters, left)
            except ValueError:
                continue
            again = shorter(n * shorter.period * times / orbit.period % shorter.period)
            if (np.abs(again - states) <= exact).all():
                return shorter
        return None

    def _guess(
        self, field: Field, p: float, times: np.ndarray, states: np.ndarray, widths: np.ndarray, rounds: int
    ) -> np.ndarray:
        """Unknowns of a cycle from states at times."""
        places = mesh.node_places(rule(self.degree), widths)
        own = [] if field.forced else [times[-1] - times[0]]
        if field.forced:
            period = rounds * float(field.length_of_period(p))
            places = places * period
            places = np.where(places < times[0], places + period, places)
        else:
            places = times[0] + places * (times[-1] - times[0])
        x = np.column_stack([np.interp(places, times, column) for column in states.T])
        return np.concatenate([x.reshape(-1), own, widths])

    def cycles(self, field: Field, u: np.ndarray, counts: tuple[int, int, int], sizes: Sizes) -> CycleProblem:
        """The problem of cycles; scales are those of the first one that was asked for, so that cycles of all can be compared."""
        if self.sizes is None:
            self.sizes = np.array(sizes[0], dtype=float), float(sizes[1])
        return CycleProblem(self, field, u, *counts, *self.sizes, sizes[2])

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
    @property
    def of_cycles(self) -> dict[str, str]:
        """What tables call a cycle."""
        return {"word": "cycle"}

    @property
    def own_measures(self) -> tuple[str, ...]:
        """Measures beside those of any flow."""
        return ()

    def measure_of(self, what: str, state: str) -> str:
        """What the largest, smallest or mean value of a state is called."""
        return f"{what} {state}"

    def measure_own(self, name: str, problem: Problem, u: np.ndarray, p: float) -> float:
        """One of ``own_measures``."""
        raise KeyError(name)

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

    def rebuilt_by(self, importable: bool) -> str | None:
        """The factory that builds the flow's problems again; None where its functions cannot be found again."""
        return "contvines.flows.files:from_description" if importable or self.origin else None

    # ------------------------------------------------------------------ events that stop
    def border_kind(self, k: int) -> str:
        """The kind of border at which a motion touches event k."""
        return "event"

    def beyond(self, problem: Problem, point: BorderPoint, k: int) -> list[Seed]:
        """The motions that go on where one touches event k: none."""
        return []

    def dead_end(self, problem: Problem, point: BorderPoint, k: int) -> str:
        """What stops motions at event k, in words."""
        assert isinstance(problem, Equilibria | CycleProblem)
        x, when = problem.touching(point.u, point.value, k)
        place = ", ".join(f"{name} = {value:.6g}" for name, value in zip(self.states, x, strict=True))
        ahead = "" if when is None else f" at t = {when:.6g} of its period"
        return f"the event {self.events.names[k]} stops the motion: it is zero{ahead}, where {place}"

    def described(self) -> dict[str, Any]:
        """What distinguishes the flow from its equations."""
        period, scale = self.given_period, given_scale(self.given_scale, len(self.x0))
        where, _ = addresses({"period": period if callable(period) else None})
        return {
            "degree": self.degree,
            "error": self.error,
            **({"settings": self.settings.changed()} if self.settings.changed() else {}),
            "period": period if not callable(period) else where["period"],
            "x0": self.x0.tolist(),
            "scale": None if scale is None else scale.tolist(),
            "states": None if self.given_states is None else list(self.states),
            "file": None if self.origin is None else list(self.origin),
        }

    def describe(self) -> dict[str, Any]:
        """Name, start, and how to build the flow again if its functions can be imported."""
        if self._equilibria is not None:
            return self._equilibria.describe()
        given = {**self.given, "period": self.given_period if callable(self.given_period) else None}
        where, importable = addresses(given)
        scale = given_scale(self.given_scale, len(self.x0))
        return {
            "name": self.name,
            "parameter": self.values.varying,
            "u0": self.x0.tolist(),
            "p0": self.values.given(),
            "scale": None if scale is None else scale.tolist(),
            "callables": where,
            "flow": self.described(),
            "factory": self.rebuilt_by(importable),
        }


def _is_number(given: object) -> bool:
    return isinstance(given, (int, float, np.integer, np.floating)) and not isinstance(given, bool)


def _at_least_one(name: str, given: float) -> int:
    if not _is_number(given) or given != int(given) or given < 1:
        raise ValueError(f"{name} = {given!r} must be a whole number, 1 or more")
    return int(given)


def _numbers(name: str, given: ArrayLike) -> np.ndarray:
    try:
        return np.asarray(given, dtype=float)
    except (TypeError, ValueError):
        raise ValueError(f"{name} must be numbers") from None


def _period(given: Callable | float | None, values: ParameterSet) -> Callable | None:
    """The period of f in time as a function of the parameters.

    Raises
    ------
    ValueError
        If it is none at the start.
    """
    if given is None:
        return None
    if not (callable(given) or _is_number(given)):
        raise ValueError(f"period = {given!r} must be a positive number or a function of p")
    period = given if callable(given) else lambda p: float(given)
    try:
        length = period(values.at(values.start))
    except Exception as error:  # a user's function may fail in any way
        raise ValueError(f"period raises {type(error).__name__}: {error}, at the start") from error
    if not (_is_number(length) and 0.0 < length < np.inf):
        raise ValueError(f"period is {length!r} at the start; it must be a positive number there")
    return period
