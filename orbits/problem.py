"""OrbitProblem: the orbits with one word as solutions of F(u, p) = 0, as a continuation code wants them.

A symmetric orbit is solved for on half its word, closed by the mirror: half the work, no branch point at its symmetry
breaking (there a multiplier of the half map passes -1), and a classification that is exact.
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
        Name of the parameter that varies.
    params : float array (P,)
        Parameter vector; what `parameter` moves in it is the starting value only.
    symmetric : bool
        Solve for symmetric orbits, on half the word.
    units : (float, float), optional
        Length and rate in which the unknowns are counted; those of the machine's own size if left out.

    Raises
    ------
    ValueError
        If the parameter is unknown, or `symmetric` is asked of a word whose halves are not mirror images.
    """

    spectrum = "map"
    # unknowns are counted in units of the machine's own size, equations exact to roundoff and smooth between the borders:
    # there is nothing to learn, to doubt or to explain
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
        """linearise, bordered, inspect: compiled, but for the empty word."""
        return self.equations.kernels

    def workspace(self) -> tuple[np.ndarray, ...]:
        """Arrays for the kernels."""
        return self.equations.workspace()

    @property
    def parameters(self) -> dict[str, float]:
        """All parameters that may vary, by name; of the one that does the starting value."""
        return {
            name: float(value)
            for name, value in zip(self.model.amount_names, self.model.amounts(self.params))
        }

    def against(self, parameter: str, values: Mapping[str, float] | None = None) -> OrbitProblem:
        """The same orbits against another parameter, with other values of some parameters."""
        params = self.params
        for name, value in (values or {}).items():
            params = along(self.model.path(name, params), params, float(value))
        return OrbitProblem(
            self.model, self.word, self.periods, parameter, params, self.symmetric, self.units
        )

    def values(self, p: float | np.ndarray) -> np.ndarray:
        """The parameter vector at parameter value `p`, shape (P,); (m, P) for an array of values."""
        return self.equations.values(p)

    def scale_within(self, within: tuple[float, float]) -> np.ndarray:
        """Typical sizes of the unknowns, 1 unless the machine knows others, and of the parameter, shape (N + 1,)."""
        scale = np.ones(self.dimension + 1)
        sizes = self.model.sizes(self.params)
        if sizes is not None:
            scale[:-1] = np.tile(sizes, self.dimension // len(sizes))
        return scale

    def value(self, params: np.ndarray) -> float:
        """The value of the parameter that varies in a parameter vector."""
        return self.equations.value(params)

    def check_value(self, name: str, value: float) -> None:
        """Refuse a value that a parameter of the machine cannot have; see `Model.check_value`."""
        self.model.check_value(name, value)

    def margin_kind(self, j: int) -> str:
        """Kind of the border at which margin `j` vanishes."""
        return border_kind(self.word, j)

    def to_multipliers(self, spectrum: np.ndarray) -> np.ndarray:
        """Multipliers of the full period from those of the closure map (half maps: squared)."""
        return self.equations.to_multipliers(spectrum)

    def at_each_point(self, name: str, u: np.ndarray, p: np.ndarray) -> None:
        """A measure at every point of a cycle: those of a motion have no order."""
        return None

    def explain_end(self, u: np.ndarray, p: float, tangent: np.ndarray, evaluable: bool) -> str:
        """Why a branch ends where Newton's method fails."""
        return ""

    def uncertainty(self) -> float:
        """Relative accuracy of the equations."""
        return 0.0

    def check(self, u: np.ndarray, p: float) -> None:
        """What is wrong with the derivatives at a solution."""
        return None

    # ------------------------------------------------------------------ shapes
    def expand(self, u: np.ndarray, p: float | np.ndarray | None = None) -> np.ndarray:
        """Nodes of the whole cycle, shape (..., L, n), from the unknowns, shape (..., N), at parameter values `p`, shape (...)."""
        return self.equations.expand(u, p)

    def reduce(self, nodes: np.ndarray) -> np.ndarray:
        """Unknowns, shape (N,), from the nodes of the whole cycle."""
        return self.equations.reduce(nodes)

    def middle(self, p: float) -> float:
        """w in the middle between the walls."""
        return float(self.model.middle(self.values(p)))

    @property
    def image_offset(self) -> Callable[[float], np.ndarray] | None:
        """Twice the middle between the walls, in the places of positions; None where it is w = 0 at all parameter values."""
        began = self.equations.began
        if not (self.middle(began) or self.middle(1.5 * began)):
            return None
        positions = np.zeros((self.length, self.model.node))
        positions[:, 1] = (self.word.codes[: self.length] > 1) * 2.0 / self.equations.unit[: self.length, 1]
        flat = positions.ravel()
        return lambda p: self.middle(p) * flat

    # ------------------------------------------------------------------ larger and smaller problems
    def root(self, u: np.ndarray, p: float) -> tuple[OrbitProblem, np.ndarray] | None:
        """The problem of the shortest orbit of which `u` is a repetition, and that orbit in it; None for a primitive one."""
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
        """The problem of another word of the same machine against the same parameter; on half the word only where the machine has a mirror image."""
        own, half = self.params if params is None else params, symmetric and self.mirrored
        return OrbitProblem(self.model, word, periods, self.parameter, own, half, self.units)

    def beyond(self, point: BorderPoint) -> Sequence[Seed]:
        """The orbits on the other side of a border, with the words that physics writes."""
        return [self._smoothly(seed) for seed in cross(self, point)]

    def onward(self, point: BorderPoint) -> Sequence[Seed]:
        """Of these what needs no switch alone; orbits of another period or symmetry only where nothing else is found."""
        return [self._smoothly(seed) for seed in cross(self, point, every=False)]

    def _smoothly(self, seed: Seed) -> Seed:
        """The seed; self-excited motions without events go on as cycles of a smooth flow."""
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
        """Why no motion was found on the other side of a border; empty where the reason is not known."""
        return dead_end(self, point)

    # ------------------------------------------------------------------ identity
    def canonical(self, u: np.ndarray, p: float) -> tuple[Hashable, np.ndarray]:
        """Key and vector that are equal for one orbit in all its descriptions.

        Rotations of the word, shifts by whole forcing periods, the mirror image and repetitions of a shorter orbit
        are one orbit.
        """
        nodes = self.expand(u, p)
        if not len(nodes):
            return ("stuck", self.model.name), np.array(u, dtype=float)
        middle = self.middle(p)
        if middle:
            nodes = nodes.copy()
            nodes[self.word.codes > 1, 1] -= middle  # from where an image has the opposite sign
        if self.units != PLAIN:
            nodes = nodes / self.equations.unit
        sizes = self.model.sizes(self.values(p))
        if sizes is not None:
            nodes = nodes / sizes
        mirrored, same = self._mirrored_at(p), size_of_one(nodes)
        return canonical(self.word, self.periods, nodes, mirrored, forced=self.forced, same=same)

    def same_motion(self, u: np.ndarray, p: float, other: object, v: np.ndarray) -> bool:
        """Whether a solution of another problem at the same parameter value is this motion, or its mirror image.

        At a border one motion has several words, so that `canonical` cannot tell.
        """
        if not isinstance(other, OrbitProblem) or other.model.name != self.model.name:
            return False
        one, another = self.orbit(u, p), other.orbit(v, p)
        # motions that are one at a few instants are one at all, and hardly ever one is the other's image
        same = self.flow.resolution
        return distance(one, another, instants=INSTANTS) <= same or (
            self._mirrored_at(p) and distance(one, another, mirror=True, instants=INSTANTS) <= same
        )

    def _mirrored_at(self, p: float) -> bool:
        return self.mirrored or self.model.has_mirror(self.values(p))

    # ------------------------------------------------------------------ for people
    @property
    def measure_names(self) -> tuple[str, ...]:
        """Measures that this machine's orbits have."""
        return self.flow.measure_names(self.model)

    @property
    def angles(self) -> tuple[str, ...]:
        """Measures that are angles: they jump by 2 pi without a jump of the orbit."""
        return self.flow.angles

    @property
    def default_measure(self) -> str:
        """The measure that a diagram shows when none is asked for."""
        return self.flow.default_measure(self.model)

    def measures(self, names: Sequence[str], u: np.ndarray, p: np.ndarray) -> dict[str, np.ndarray]:
        """Measures of many solutions at once: `u` has shape (m, N), `p` shape (m,)."""
        p = np.atleast_1d(np.asarray(p, dtype=float))
        nodes = self.expand(np.atleast_2d(u), p)
        return self.flow.measures(self.model, self.word, self.periods, nodes, self.values(p), names)

    def orbit(self, u: np.ndarray, p: float) -> Orbit:
        """The solution as an `orbits.orbit.Orbit`."""
        nodes = self.expand(u, p)
        nodes = nodes if len(self.word) else nodes[:1]
        return Orbit(self.model, self.word, self.periods, nodes, self.values(p))

    def amplitude(self, direction: np.ndarray) -> float:
        """Length of a direction as normal forms measure it: Euclidean, over the first node."""
        return float(np.linalg.norm(direction[: self.dimension // max(self.length, 1)]))

    def replay(self, u: np.ndarray, p: float) -> float | None:
        """Largest deviation of the event-driven simulation from the orbit over its period."""
        return self.orbit(u, p).replay()

    def prove(self, kind: str, u: np.ndarray, p: float, margin: int | None = None, bits: int | None = None):
        """Prove a special point of this problem; see `orbits.proofs.subjects.of_point`."""
        from orbits.proofs.subjects import of_point

        return of_point(self, kind, u, p, margin, bits)

    def gauges(self, names: Sequence[str], p: float) -> dict[str, tuple[float, str]]:
        """What one of these coordinates of a motion (w, w_rate, v, v_rate) is in the unit that is shown, and that unit; empty for a machine of plain numbers."""
        return self.model.gauges(names, self.values(p))

    def population(self, over: str | None = None, **parameters: float):
        """Starts of this machine and what they settle on; see `orbits.population.Population`."""
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
        """The word as printed: one spelling for one motion; `word` begins where the nodes do."""
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
    ):
        """Prove a branch of this problem's orbits; see `orbits.proofs.subjects.of_branch`."""
        from orbits.proofs.subjects import of_branch

        return of_branch(self, points, values, marks, within, special)

    def describe(self) -> dict[str, Any]:
        """A description that `rebuild` understands, ready for JSON."""
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
    """The problem that `OrbitProblem.describe` described.

    A declared machine that this process has already is taken as it is. Else its machine file has to be run: only with `trust`; without it the
    answer is None. The other machines are data.

    Raises
    ------
    PageChanged
        If the machine file is gone or has changed.
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
        tuple(description.get("counted_in", PLAIN)),  # older files count in the machine's own units
    )
