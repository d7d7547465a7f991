"""OrbitProblem: the orbits with one word as solutions of F(u, p) = 0, for continuation.

A symmetric orbit is solved on half its word and closed by the mirror. This halves the work, makes a symmetry breaking no branch point
(a multiplier of the half map passes -1), and classifies it exactly.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from orbits.borders import cross, dead_end
from orbits.cycle import canonical, size_of_one
from orbits.flows import flow_of, machine_of
from orbits.flows.equations import PLAIN, CycleKernels
from orbits.machines.parameters import along
from orbits.orbit import INSTANTS, Orbit, distance
from orbits.protocol import Motions
from orbits.words import Word, border_kind

if TYPE_CHECKING:
    from orbits.machines.varying import Varying
    from orbits.protocol import BorderPoint, Seed


class OrbitProblem(Motions):
    """Periodic orbits with a given word, against one parameter of their machine.

    Parameters
    ----------
    model : Model or Machine
    word : Word
        The word of the whole cycle.
    periods : int
        Forcing periods k of the whole cycle; 1 for a self-excited machine, whose period is unknown.
    parameter : str
        Name of the varying parameter.
    params : float array (P,)
        Parameter vector; its value of `parameter` is only a starting value.
    symmetric : bool
        Solve for symmetric orbits, on half the word.
    units : (float, float), optional
        Units of length and rate of the unknowns; by default those of the machine's own size.

    Raises
    ------
    ValueError
        If the parameter is unknown, or `symmetric` is set for a word whose halves are not mirror images.
    """

    spectrum = "map"
    # unknowns have units of the machine's own size; equations are exact to roundoff, and smooth between the borders:
    # no scales have to be learned, and no noise to be estimated
    detection = ""
    scales = None
    scales_learned = False
    noise = 0.0

    def __init__(
        self,
        model: Varying,
        word: Word,
        periods: int,
        parameter: str,
        params: np.ndarray,
        symmetric: bool = False,
        units: tuple[float, float] | None = None,
    ) -> None:
        params = np.array(params, dtype=float)
        self.model, self.word, self.periods = model, word, int(periods)
        self.parameter, self.params, self.symmetric = parameter, params, bool(symmetric)
        self.flow, self.forced = flow_of(model), bool(model.forced)
        model.place_of(parameter)
        self.mirrored = model.has_mirror(params, parameter)
        self.units = model.natural_units(params) if units is None else units
        self.equations = system = self.flow.equations(
            model, word, self.periods, parameter, params, self.symmetric, self.units
        )
        self.length, self.dimension = system.length, system.dimension
        self.twist, self.shift, self.movable = system.twist, system.shift, system.movable
        self.n_multipliers, self.n_margins = system.n_multipliers, system.n_margins
        self.path, self.data, self.period_shift = system.path, system.data, system.period_shift
        self.flip_kind = "symmetry-breaking" if self.twist < 0.0 else "period-doubling"

    # ------------------------------------------------------------------ numerics
    @property
    def kernels(self) -> CycleKernels:
        """The kernels: linearise, bordered, inspect."""
        return self.equations.kernels

    def workspace(self) -> tuple[np.ndarray, ...]:
        """Return new arrays for the kernels."""
        return self.equations.workspace()

    @property
    def parameters(self) -> dict[str, float]:
        """All parameters that can vary, by name; for the varying one its starting value."""
        return {
            name: float(value)
            for name, value in zip(self.model.amount_names, self.model.amounts(self.params))
        }

    def against(self, parameter: str, values: Mapping[str, float] | None = None) -> OrbitProblem:
        """Return the problem of the same orbits against another parameter, with new values of some parameters."""
        params = self.params
        for name, value in (values or {}).items():
            params = along(self.model.path(name, params), params, float(value))
        return OrbitProblem(
            self.model, self.word, self.periods, parameter, params, self.symmetric, self.units
        )

    def values(self, p: float | np.ndarray) -> np.ndarray:
        """Return the parameter vector at parameter value `p`, shape (P,); (m, P) for an array of values."""
        return self.equations.values(p)

    def scale_within(self, within: tuple[float, float]) -> np.ndarray:
        """Return typical sizes of the unknowns (1 unless the machine gives others) and of the parameter, shape (N + 1,)."""
        scale = np.ones(self.dimension + 1)
        sizes = self.model.sizes(self.params)
        if sizes is not None:
            scale[:-1] = np.tile(sizes, self.dimension // len(sizes))
        return scale

    def value(self, params: np.ndarray) -> float:
        """Return the value of the varying parameter in a parameter vector."""
        return self.equations.value(params)

    def check_value(self, name: str, value: float) -> None:
        """Raise ParameterError for an impossible value of a parameter; see `Model.check_value`."""
        self.model.check_value(name, value)

    def margin_kind(self, j: int) -> str:
        """Return the kind of border at which margin `j` vanishes."""
        return border_kind(self.word, j)

    def to_multipliers(self, spectrum: np.ndarray) -> np.ndarray:
        """Return the multipliers of the full period from those of the closure map (of half a period: their squares)."""
        return self.equations.to_multipliers(spectrum)

    def at_each_point(self, name: str, u: np.ndarray, p: np.ndarray) -> None:
        """Return None: measures belong to the whole motion."""
        return None

    def explain_end(self, u: np.ndarray, p: float, tangent: np.ndarray, evaluable: bool) -> str:
        """Return the reason for the end of a branch at which Newton's method fails; empty here."""
        return ""

    def uncertainty(self) -> float:
        """Return the relative accuracy of the equations: 0, they are exact to roundoff."""
        return 0.0

    def check(self, u: np.ndarray, p: float) -> None:
        """Return None: derivatives are not given by users."""
        return None

    # ------------------------------------------------------------------ shapes
    def expand(self, u: np.ndarray, p: float | np.ndarray | None = None) -> np.ndarray:
        """Return the nodes of the whole cycle, shape (..., L, n), from unknowns, shape (..., N), at parameter values `p`, shape (...)."""
        return self.equations.expand(u, p)

    def reduce(self, nodes: np.ndarray) -> np.ndarray:
        """Return the unknowns, shape (N,), from the nodes of the whole cycle."""
        return self.equations.reduce(nodes)

    def middle(self, p: float) -> float:
        """Return w in the middle between the walls."""
        return float(self.model.middle(self.values(p)))

    @property
    def image_offset(self) -> Callable[[float], np.ndarray] | None:
        """Twice the middle between the walls in the entries of positions, as a function of p; None if it is always w = 0."""
        began = self.equations.began
        if not (self.middle(began) or self.middle(1.5 * began)):
            return None
        positions = np.zeros((self.length, self.model.node))
        positions[:, 1] = (self.word.codes[: self.length] > 1) * 2.0 / self.equations.unit[: self.length, 1]
        flat = positions.ravel()
        return lambda p: self.middle(p) * flat

    # ------------------------------------------------------------------ larger and smaller problems
    def root(self, u: np.ndarray, p: float) -> tuple[OrbitProblem, np.ndarray] | None:
        """Return the problem of the shortest orbit that `u` repeats, and its unknowns there; None if `u` repeats none."""
        if len(self.word) and self.word.repetitions == 1:
            return None
        root = self.orbit(u, p).root()
        if (len(root.word), root.periods) == (len(self.word), self.periods):
            return None
        found = self.sibling(root.word, root.periods, root.symmetric)
        return found, found.reduce(root.nodes if len(self.word) else self.expand(u, p))

    def sibling(
        self, word: Word, periods: int, symmetric: bool, params: np.ndarray | None = None
    ) -> OrbitProblem:
        """Return the problem of another word of the machine, against the same parameter; symmetric only if the machine has a mirror image."""
        numbers, half = self.params if params is None else params, symmetric and self.mirrored
        return OrbitProblem(self.model, word, periods, self.parameter, numbers, half, self.units)

    def beyond(self, point: BorderPoint) -> Sequence[Seed]:
        """Return the orbits on the other side of a border, with the words that the laws of the contacts give."""
        return [self._as_flow(seed) for seed in cross(self, point)]

    def onward(self, point: BorderPoint) -> Sequence[Seed]:
        """Return the branches beyond a border, without orbits of less symmetry or longer period unless there are no others."""
        return [self._as_flow(seed) for seed in cross(self, point, every=False)]

    def _as_flow(self, seed: Seed) -> Seed:
        """Return the seed; a self-excited motion without events becomes a cycle of a smooth flow."""
        if self.forced or len(seed.problem.word) or not seed.problem.word.modes:
            return seed
        from orbits.flows.page.smooth import cycles_of

        cycle = cycles_of(seed.problem.orbit(seed.u, seed.p))
        problem: Any = cycle.problem(self.parameter)
        tangent = (
            None if seed.tangent is None else problem.direction(cycle.u, seed.p, float(seed.tangent[-1]))
        )
        return seed._replace(problem=problem, u=cycle.u, tangent=tangent)

    def dead_end(self, point: BorderPoint) -> str:
        """Return the reason why no motion was found on the other side of a border; empty if unknown."""
        return dead_end(self, point)

    # ------------------------------------------------------------------ identity
    def canonical(self, u: np.ndarray, p: float) -> tuple[Hashable, np.ndarray]:
        """Return a key and a vector that are equal for all descriptions of one orbit.

        Descriptions of one orbit differ by rotation of the word, by whole forcing periods, by the mirror image, and by repetition.
        """
        nodes = self.expand(u, p)
        if not len(nodes):
            return ("stuck", self.model.name), np.array(u, dtype=float)
        middle = self.middle(p)
        if middle:
            nodes = nodes.copy()
            nodes[self.word.codes > 1, 1] -= middle  # an image then has the opposite sign
        if self.units != PLAIN:
            nodes = nodes / self.equations.unit
        sizes = self.model.sizes(self.values(p))
        if sizes is not None:
            nodes = nodes / sizes
        mirrored, same = self._mirrored_at(p), size_of_one(nodes)
        return canonical(self.word, self.periods, nodes, mirrored, forced=self.forced, same=same)

    def same_motion(self, u: np.ndarray, p: float, other: object, v: np.ndarray) -> bool:
        """Return whether a solution of another problem at the same parameter value is this motion, or its mirror image.

        It compares positions, because at a border one motion has several words, and `canonical` cannot compare them.
        """
        if not isinstance(other, OrbitProblem) or other.model.name != self.model.name:
            return False
        one, another = self.orbit(u, p), other.orbit(v, p)
        # a few instants decide; the mirror image is compared only if the motions differ
        same = self.flow.resolution
        return distance(one, another, instants=INSTANTS) <= same or (
            self._mirrored_at(p) and distance(one, another, mirror=True, instants=INSTANTS) <= same
        )

    def _mirrored_at(self, p: float) -> bool:
        return self.mirrored or self.model.has_mirror(self.values(p))

    # ------------------------------------------------------------------ for people
    @property
    def measure_names(self) -> tuple[str, ...]:
        """Names of the measures of this machine's orbits."""
        return self.flow.measure_names(self.model)

    @property
    def angles(self) -> tuple[str, ...]:
        """Measures that are angles: a jump by 2 pi is no jump of the orbit."""
        return self.flow.angles

    @property
    def default_measure(self) -> str:
        """The default measure of diagrams."""
        return self.flow.default_measure(self.model)

    def measures(self, names: Sequence[str], u: np.ndarray, p: np.ndarray) -> dict[str, np.ndarray]:
        """Return measures of many solutions at once, each of shape (m,): `u` has shape (m, N), `p` shape (m,)."""
        p = np.atleast_1d(np.asarray(p, dtype=float))
        nodes = self.expand(np.atleast_2d(u), p)
        return self.flow.measures(self.model, self.word, self.periods, nodes, self.values(p), names)

    def orbit(self, u: np.ndarray, p: float) -> Orbit:
        """Return the solution as an `orbits.orbit.Orbit`."""
        nodes = self.expand(u, p)
        nodes = nodes if len(self.word) else nodes[:1]
        return Orbit(self.model, self.word, self.periods, nodes, self.values(p))

    def amplitude(self, direction: np.ndarray) -> float:
        """Return the length of a direction for normal forms: Euclidean, over the first node."""
        return float(np.linalg.norm(direction[: self.dimension // max(self.length, 1)]))

    def replay(self, u: np.ndarray, p: float) -> float | None:
        """Return the largest deviation of the event-driven simulation from the orbit over its period."""
        return self.orbit(u, p).replay()

    def prove(self, kind: str, u: np.ndarray, p: float, margin: int | None = None, bits: int | None = None):
        """Prove a special point of this problem; see `orbits.proofs.subjects.of_point`."""
        from orbits.proofs.subjects import of_point

        return of_point(self, kind, u, p, margin, bits)

    def gauges(self, names: Sequence[str], p: float) -> dict[str, tuple[float, str]]:
        """Return, by name of coordinate (w, w_rate, v, v_rate), the size of one in the shown unit, and this unit; empty without units."""
        return self.model.gauges(names, self.values(p))

    def population(self, over: str | None = None, **parameters: float):
        """Return starts of this machine; see `orbits.population.Population`."""
        over = over or self.parameter
        numbers = self.model.named(self.params)
        values = {**numbers, **parameters}
        return self.model.population(over, **{name: v for name, v in values.items() if name != over})

    def __repr__(self) -> str:
        symmetric = ", symmetric" if self.symmetric else ""
        word = f"word={self.spelling!r}, periods={self.periods}{symmetric}"
        return f"OrbitProblem({self.model.name}, {word}, parameter={self.parameter!r})"

    @property
    def spelling(self) -> str:
        """The word as printed: one spelling for one motion; `word` itself begins at the first node."""
        return self.word.spelled(self.mirrored)

    @property
    def notation(self) -> dict[str, str]:
        """Labels of axes by name of parameter or measure."""
        return self.model.notation

    def prove_branch(
        self,
        points: np.ndarray,
        values: np.ndarray,
        marks: Sequence[int] = (),
        within: tuple[float, float] | None = None,
        special: Mapping[int, Any] | None = None,
        bits: int | None = None,
    ):
        """Prove a branch of this problem's orbits; see `orbits.proofs.subjects.of_branch`."""
        from orbits.proofs.subjects import of_branch

        return of_branch(self, points, values, marks, within, special, bits)

    def describe(self) -> dict[str, Any]:
        """Return a JSON-able description, from which `rebuild` makes the problem again."""
        unnamed = "stuck" if not self.word.modes else "no events"
        return {
            "factory": "orbits.problem:rebuild",
            "name": f"P_{self.word.impacts}^{self.periods}" if len(self.word) else unnamed,
            "model": self.model.settings(self.params),
            "word": self.spelling,
            **self.word.describe(),
            "periods": self.periods,
            "impacts": self.word.impacts if self.word.alphabet.walled else None,
            "parameter": self.parameter,
            "params": [float(value) for value in self.params],
            **({"units": self.model.units} if self.model.units else {}),
            "symmetric": self.symmetric,
            **({"counted_in": list(self.units)} if self.units != PLAIN else {}),
        }


def rebuild(description: Mapping[str, Any], trust: bool = False) -> OrbitProblem | None:
    """Return the problem that `OrbitProblem.describe` described; None if its machine file must not be executed.

    Built-in machines are rebuilt from data. A declared machine is taken from this process if it exists here. Otherwise its machine file has to
    be executed, which needs `trust`.

    Raises
    ------
    PageChanged
        If the machine file is missing or has changed.
    """
    settings, params = description["model"], np.array(description["params"], dtype=float)
    if "page" in settings:
        from orbits.machines.page.loading import machine_again

        model: Varying | None = machine_again(settings, trust)
        if model is None:
            return None
    else:
        model = machine_of(settings)
    return OrbitProblem(
        model,
        Word.described(description, getattr(model, "alphabet", None)),
        description["periods"],
        description["parameter"],
        model.completed(params),
        bool(description["symmetric"]),
        tuple(description.get("counted_in", PLAIN)),  # in older files unknowns have the machine's own units
    )
