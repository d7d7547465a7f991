"""Motions without events of a self-excited machine: equilibria and cycles of a smooth flow, whose borders are events of the contacts.

In one mode a machine is a differential equation. `contvines.flows` solves for its equilibria and, by collocation, for its cycles. The
guards of the mode are events of this flow, so a branch ends where a velocity, a gap or a surface becomes zero. There the rules of the
contacts decide: the cycle becomes an orbit with the word "", whose node is at an extreme of the first state that moves.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from contvines.flows import FlowProblem
from contvines.flows.cycles import CycleProblem
from contvines.flows.equilibria import Equilibria
from orbits.contacts.dry_friction import STUCK, DryFriction
from orbits.contacts.wall import HELD, Wall
from orbits.flows.equations import newton
from orbits.flows.page import measures
from orbits.flows.page.flow import PageFlow
from orbits.flows.protocol import checked_start
from orbits.integrators.expressions import derivatives, variable, written
from orbits.machines.page.compiled import moving
from orbits.machines.page.loading import machine_again
from orbits.machines.page.machine import Machine
from orbits.settings import EVENTS, SOLVING
from orbits.words import Word, border_kind

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from contvines.flows.equilibria import Equilibria
    from contvines.flows.flow import BorderPoint, Problem
    from orbits.flows.protocol import Equations, Motion

SAMPLES = 800  # samples of a motion for collocation, and of a cycle in the search for its extreme
DEGREE = (
    7  # degree of the collocation polynomials; high, for accurate distances from contacts between mesh points
)
SECANTS = 20  # largest number of secant steps to a border
SWEEPS = 6  # Newton steps to an equilibrium


class Touching(NamedTuple):
    """A motion that touches a contact: a border, as problems of orbits receive it."""

    u: np.ndarray
    value: float
    tangent: np.ndarray
    margin_index: int


class WithoutEvents(FlowProblem):
    """The flow of a machine in one mode.

    Parameters
    ----------
    machine : Machine
        Self-excited.
    mode : tuple of int
        A mode in which nothing sticks and no wall holds.
    params : float array (P,)
    state : float array (n,)
        A state at which all guards are positive.
    """

    def __init__(
        self, machine: Machine, mode: tuple[int, ...], params: np.ndarray, state: np.ndarray
    ) -> None:
        self.machine, self.word = machine, Word((), (mode,), machine.alphabet)
        e = machine.equations
        pattern, layout = e.pattern(e.pattern_key(mode)), e.layout
        signs, names = e.signs(mode), machine.parameter_names

        def function(values: Sequence[Any]) -> Callable:
            code = written(layout, values, np)
            return lambda x, p: code(x, 0.0, [*(p[name] for name in names), *signs])

        def rows(values: Sequence[Any]) -> Callable:
            flat, count = function([entry for row in values for entry in row]), len(values[0])

            def table(x: np.ndarray, p: np.ndarray) -> list[Any]:
                found = flat(x, p)
                return [found[i : i + count] for i in range(0, len(found), count)]

            return table

        by_parameters = {name: derivatives(pattern.rates, [variable(f"p_{name}")]) for name in names}
        image = machine._image is not None and self.word.mirror() == self.word
        self.contacts = [guard.contact for guard in pattern.guards]
        super().__init__(
            function(pattern.rates),
            np.where(np.abs(state) > EVENTS.zero * np.abs(state).max(), state, 0.0),
            dict(zip(names, map(float, params), strict=True)),
            jacobian=rows(derivatives(pattern.rates, e.x)),
            derivative={name: function([row[0] for row in slopes]) for name, slopes in by_parameters.items()},
            states=machine.states,
            events={
                f"{e.contacts[guard.contact].described}": function_of_one(function([guard.value]))
                for guard in pattern.guards
            },
            mirror=(lambda x: -x) if image else None,
            name=machine.name,
            degree=DEGREE,
            error=SOLVING.mesh_error,
        )

    # ------------------------------------------------------------------ names, measures, files
    @property
    def of_cycles(self) -> dict[str, str]:
        """Word and name of cycles, as orbits of machines have them."""
        return {"word": self.word.text, "name": "no events"}

    def measure_of(self, what: str, state: str) -> str:
        """Return the machine's name of a measure of a state."""
        return f"{what}_{state}"

    @property
    def own_measures(self) -> tuple[str, ...]:
        """Measures of the machine besides those of every flow."""
        return tuple(name for name in measures.names(self.machine) if name not in (*self.of_states, "period"))

    def measure_own(self, name: str, problem: Problem, u: np.ndarray, p: float) -> float:
        """Return one of the `own_measures`; an equilibrium is evaluated as a motion of no duration."""
        nodes = (
            self.node(problem, u, p)[None]
            if isinstance(problem, CycleProblem)
            else np.append(np.nan, u)[None]
        )
        params = np.array(
            [{**problem.parameters, problem.parameter: p}[key] for key in self.machine.parameter_names]
        )
        return float(measures.measure(self.machine, self.word, 1, nodes[None], params[None], [name])[name][0])

    def described(self) -> dict[str, Any]:
        """Return the JSON-able machine and mode."""
        return {
            "machine": self.machine.settings(),
            "modes": list(self.word.entries(0)),
            "x0": self.x0.tolist(),
        }

    def rebuilt_by(self, importable: bool) -> str:
        """Return the factory that rebuilds the problem; files contain the machine file."""
        return "orbits.flows.page.smooth:rebuild"

    # ------------------------------------------------------------------ what else there is
    def population_at(  # a population of the machine, with other columns than a flow's
        self,
        values: Mapping[str, float],
        over: str | None = None,
        box: Sequence[tuple[float, float]] | None = None,
        around: np.ndarray | None = None,
    ) -> Any:
        """Return starts of the machine."""
        over = over or self.values.varying
        return self.machine.population(
            over, **{name: value for name, value in values.items() if name != over}
        )

    def simulated_attractors(self, problem: Problem, p: float, starts: int) -> list[dict[str, Any]]:
        """Return the attractors that simulations of the machine find."""
        return self._orbits(problem, p).simulated_attractors(p)

    def known(self, problem: Problem, u: np.ndarray, p: float) -> dict[str, Any]:
        """Return a stable motion in the form of `simulated_attractors`."""
        rest = {"word": None, "periods": 0, "kind": "rest"}
        return (
            rest
            if isinstance(problem, Equilibria)
            else {"word": self.word.text, "periods": 1, "kind": "periodic"}
        )

    # ------------------------------------------------------------------ borders
    def border_kind(self, k: int) -> str:
        """Return the kind of border at which guard k vanishes."""
        return border_kind(self.word, self.contacts[k])

    def beyond(self, problem: Problem, point: BorderPoint, k: int) -> list[Any]:
        """Return the solutions beyond a border at which a cycle touches a contact, by the rules of the contacts."""
        if not isinstance(problem, CycleProblem):
            return []
        orbits, p = self._orbits(problem, float(point.value)), float(point.value)
        u, p = on_border(orbits.equations, self.node(problem, point.u, p), p, self.contacts[k])
        if u is None:
            return []
        row = np.zeros(orbits.dimension + 1)
        row[-1] = 1.0
        tangent = newton(orbits.equations, u, p, row)[3]
        return list(orbits.beyond(Touching(u, p, tangent, self.contacts[k])))

    def dead_end(self, k: int, x: np.ndarray, when: float | None = None) -> str:
        """Return the sentence that says which contact is touched."""
        return (
            super()
            .dead_end(k, x, when)
            .replace("the event ", "")
            .replace(" stops the motion: it", " is touched: its guard")
        )

    def _orbits(self, problem: Problem, p: float):
        """Return the problem of the same motions as orbits with the word ""."""
        from orbits.problem import OrbitProblem

        values = {**problem.parameters, problem.parameter: p}
        params = np.array([values[name] for name in self.machine.parameter_names])
        return OrbitProblem(self.machine, self.word, 1, problem.parameter, params)

    def node(self, problem: CycleProblem, u: np.ndarray, p: float) -> np.ndarray:
        """Return period and state at the extreme of the first state that moves, shape (n + 1,)."""
        orbit = problem.orbit(u, p)
        return extreme_of(
            self.machine, self.word, orbit(np.linspace(0.0, orbit.period, SAMPLES)), orbit.period
        )


def function_of_one(f: Callable) -> Callable:
    """Return a function that gives the first value of a function's result."""
    return lambda x, p: f(x, p)[0] + 0.0 * x[0]


def extreme_of(machine: Machine, word: Word, states: np.ndarray, period: float) -> np.ndarray:
    """Return an approximate node of a motion without events: period, and the sampled state at which the first moving state is largest."""
    e = machine.equations
    first = moving(e, e.pattern(e.pattern_key(word.entries(0))).rates)
    return np.append(period, states[int(np.argmax(states[:, first]))])


def on_border(equations: Equations, u: np.ndarray, p: float, margin: int) -> tuple[np.ndarray | None, float]:
    """Return the orbit near a guess at which a margin is zero, and its parameter, by the secant method; None if it is not found."""
    row = np.empty(2 * equations.n_multipliers + equations.n_margins)

    def at(p: float) -> tuple[np.ndarray, float]:
        found, _, residual, _ = newton(equations, u, p)
        if not np.isfinite(residual):
            return found, np.nan
        equations.kernels.examine(equations.data, found, p, equations.scratch, row)
        return found, float(row[2 * equations.n_multipliers + margin])

    before, margin_now, q = at(p)[1], np.nan, p + SOLVING.shift * (1.0 + abs(p))
    for _ in range(SECANTS):
        u, margin_now = at(q)
        if not np.isfinite(margin_now) or margin_now == before:
            break
        if abs(margin_now) <= EVENTS.zero * (1.0 + np.abs(u).max()):
            return u, q
        p, q, before = q, q - margin_now * (q - p) / (margin_now - before), margin_now
    return (u, q) if np.isfinite(margin_now) and abs(margin_now) < SOLVING.near else (None, q)


def smooth(machine: Machine, mode: tuple[int, ...], params: np.ndarray, state: np.ndarray) -> WithoutEvents:
    """Return the flow of a machine in a mode; the same object at every call, so that its motions can be compared.

    Raises
    ------
    ValueError
        If something sticks or is held in the mode.
    """
    for contact, entry in zip(machine.contacts, mode, strict=True):
        if (isinstance(contact, DryFriction) and entry == STUCK) or (
            isinstance(contact, Wall) and entry == HELD
        ):
            raise ValueError(f"{contact.described} holds: such a motion is not smooth")
    flows: dict[tuple[int, ...], WithoutEvents] = vars(machine).setdefault("_smooth", {})
    if mode not in flows:
        flows[mode] = WithoutEvents(machine, mode, params, state)
    return flows[mode]


def beside(machine: Machine, state: Mapping[str, float] | None = None, **parameters: float) -> WithoutEvents:
    """Return the flow that begins at a state given by names, in the mode of this state.

    Raises
    ------
    ValueError
        If a name is unknown, or something is held or sticks in that state.
    """
    params, given = machine.vector(parameters), checked_start(dict(state or {}), machine.states)
    x = np.array([given.get(name, 0.0) for name in machine.states])
    mode = machine.rest_mode(params, x, 0.0)
    vars(machine).setdefault("_smooth", {}).pop(mode, None)
    return smooth(machine, mode, params, x)


def cycles_of(orbit: Motion):
    """Return the cycle, by collocation, of a self-excited orbit without events.

    Raises
    ------
    ValueError
        If Newton's method does not converge.
    """
    machine = orbit.model
    assert isinstance(machine, Machine)
    table = PageFlow().sample(orbit, SAMPLES)
    states = np.column_stack([table[name] for name in machine.states])
    flow = smooth(machine, orbit.word.entries(0), orbit.params, states[0])
    return flow.cycle_at(orbit.parameters, table["time"], states)


def cycle_near(machine: Machine, word: Word, params: np.ndarray, state: np.ndarray) -> np.ndarray | None:
    """Return the node of the cycle without events on which a motion settles, shape (n + 1,); None if it settles on no such cycle."""
    try:
        flow = smooth(machine, word.entries(0), params, state)
        orbit = flow.attractor_at(machine.named(params), state)
    except ValueError:  # the motion comes to rest, reaches an event, or does not recur
        return None
    return extreme_of(machine, word, orbit(np.linspace(0.0, orbit.period, SAMPLES)), orbit.period)


class Rest(NamedTuple):
    """An equilibrium, from which branches can begin as from an orbit."""

    flow: WithoutEvents
    state: np.ndarray
    parameters: dict[str, float]

    def problem(self, parameter: str):
        """Return the problem of equilibria against a parameter."""
        return self.flow.equilibria(parameter, self.parameters)

    def seed(self, problem: CycleProblem) -> tuple[np.ndarray, float]:
        """Return the state, and the value of the varying parameter."""
        return self.state, self.parameters[problem.parameter]


def rest_near(machine: Machine, mode: tuple[int, ...], params: np.ndarray, state: np.ndarray) -> Rest | None:
    """Return the equilibrium near a state at which a motion has come to rest, by Newton's method; None if there is none."""
    try:
        flow = smooth(machine, mode, params, state)
    except ValueError:
        return None
    values = machine.named(params)
    field = flow.field.against(flow.values.against(flow.values.varying, values))
    x, p = np.array(state, dtype=float), values[flow.values.varying]
    for _ in range(SWEEPS):
        x = x - np.linalg.lstsq(field.jacobian(x[None], p)[0], field(x[None], p)[0], rcond=EVENTS.zero)[0]
    near = SOLVING.equilibrium * (1.0 + np.abs(state).max())
    return Rest(flow, x, values) if np.abs(x - state).max() <= near else None


def rebuild(description: Mapping[str, Any], trust: bool = False) -> Equilibria | CycleProblem | None:
    """Rebuild the problem of equilibria or cycles from what ``describe()`` returned; None if its machine file must not be executed."""
    data = description["flow"]
    machine = machine_again(data["machine"], trust)
    if machine is None:
        return None
    params = machine.vector(description["p0"])
    flow = smooth(machine, tuple(data["modes"]), params, np.array(data["x0"], dtype=float))
    return flow.problem_of(description)
