"""MapProblem: cycles of a map x -> f(x, p)."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping, Sequence
from copy import copy
from typing import TYPE_CHECKING, Any

import numpy as np

from contvines.shared.near_names import hinting

from .callables import CallableProblem
from .derivatives import Differentiated
from .functions import NotEvaluable, Outputs, ParameterSet
from .pieces import Pieces
from .protocol import Embedding, Symmetry
from .registry import addresses, find_callables
from .scales import flat_start, given_scale
from .settings import IDENTITY
from .spectra import vectors_of, without_roundoff
from .symmetries import image_map, in_order, refuse_no_mirror

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from .abilities import Linearised, Population


class MapSection:
    """Section of a map: one step is one period of the problem's cycle; see :mod:`contvines.circles.section`.

    Parameters
    ----------
    problem : MapProblem
    p : float
    """

    def __init__(self, problem: MapProblem, p: float) -> None:
        self.problem, self.p = problem, float(p)
        self.value = problem.in_own_pieces()

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the coordinates: x0, x1, ..."""
        return tuple(f"x{j}" for j in range(self.problem.node))

    def through(self, u: np.ndarray) -> np.ndarray:
        """Return the first point of the cycle."""
        return np.array(u[: self.problem.node], dtype=float)

    def rounds(self, u: np.ndarray) -> np.ndarray:
        """Return all points of the cycle, shape (periods, d)."""
        return np.array(u, dtype=float).reshape(self.problem.cycle, self.problem.node)

    def image(self, x: np.ndarray) -> np.ndarray:
        """Return f at a point, with the signs of the switches there; NaN where f is not defined."""
        try:
            with np.errstate(all="ignore"):
                return self.value(x, self.p)
        except NotEvaluable:
            return np.full(self.problem.node, np.nan)

    def step(self, x: np.ndarray) -> np.ndarray:
        """Return the point one period of the cycle later."""
        for _ in range(self.problem.cycle):
            x = self.image(x)
        return x


class MapProblem(CallableProblem):
    """The n-cycles of a map: f(x_i, p) = x_{i+1}, x_n = x_0. Unknowns are all points of the cycle.

    Parameters
    ----------
    f : callable
        (x of shape (d,), p) -> d numbers.
    u0 : array_like, shape (n, d), (n d,) or (d,)
        The points of the cycle; for ``cycle`` > 1 a single point is iterated to get the others.
    p0 : float, or mapping of str to float
        Parameter value, or the values of several parameters by name: ``f(x, p)`` then reads ``p.name``.
    cycle : int
        Length n of the cycle.
    parameter : str
    jacobian, derivative : callable, optional
        (x, p) -> df/dx of shape (d, d), df/dp of shape (d,) (a mapping by name for several parameters). By default the complex
        step if f allows it, else differences with an error estimate. Given derivatives are compared with differences of f.
    mirror : callable, matrix or permutation, optional
        x -> R x with R R x = x and f(R x, p) = R f(x, p). Bifurcations to less symmetric cycles are then symmetry breakings, and only one
        of two mirror images is traced.
    name : str
    dimension : int, optional
        d, if u0 does not determine it (by default a flat u0 of n d numbers has d = len(u0) / n).
    scale : float or array_like of shape (d,), optional
        Typical size of each coordinate; learned from the start and the branch if it is left out.
    switches : mapping of str to callable, optional
        (x, p) -> number whose sign selects a piece of f. f is then called as f(x, p, sign) with a mapping from the names to +1
        or -1, must be smooth for fixed signs, and must not look at the switches itself.
    outputs : mapping of str to callable, optional
        (x, p) -> number at the first point of the cycle: additional measures.

    Raises
    ------
    ValueError
        If the start does not fit the cycle, f does not return d finite numbers, or a derivative or the mirror disagrees with it.
    """

    spectrum = "map"
    flip_kind = "period-doubling"

    @hinting
    def __init__(
        self,
        f: Callable,
        u0: Sequence[float] | np.ndarray | float,
        p0: float | Mapping[str, float],
        cycle: int = 1,
        parameter: str = "p",
        jacobian: Callable | None = None,
        derivative: Callable | Mapping[str, Callable] | None = None,
        name: str = "map",
        dimension: int | None = None,
        mirror: Callable[[np.ndarray], ArrayLike] | ArrayLike | None = None,
        scale: ArrayLike | None = None,
        switches: Mapping[str, Callable] | None = None,
        outputs: Mapping[str, Callable] | None = None,
    ) -> None:
        if not (isinstance(cycle, (int, np.integer)) and cycle >= 1):
            raise ValueError(f"cycle = {cycle!r} must be a whole number of at least 1")
        start = np.array(u0, dtype=float)
        flat = flat_start(start.reshape(-1))
        d = len(flat) if dimension is None else int(dimension)
        all_points = start.ndim == 2 or (cycle > 1 and len(flat) % cycle == 0 and len(flat) >= cycle)
        if dimension is None and all_points:
            d = len(flat) // (start.shape[0] if start.ndim == 2 else cycle)
        self.values = ParameterSet(p0, parameter)
        self.cycle, self.name, self.node = int(cycle), name, d
        self.pieces = Pieces(switches, self.values, flat[None, :d])
        self.given = {"F": f, "jacobian": jacobian, "derivative": derivative, "mirror": mirror}
        self.functions = Differentiated(*self._wrapped(self.pieces), flat[:d], self.values, "the map")
        if self._structure_at(flat[:d]) != "dense":
            raise ValueError(
                "the jacobian of a map must be an array; use AlgebraicProblem for f(x, p) - x with sparse ones"
            )
        if len(flat) == d and cycle > 1:
            flat = self._iterated(flat)
        if len(flat) != d * cycle:
            raise ValueError(
                f"u0 has {len(flat)} numbers; a {cycle}-cycle of points with {d} needs {d * cycle}"
            )
        self.u0 = flat
        self.dimension = d * self.cycle
        self.n_multipliers = d
        self.pieces = Pieces(switches, self.values, flat.reshape(-1, d))
        self.functions = self.functions_in(self.pieces)
        self.n_margins = self.pieces.count
        self.outputs = Outputs(outputs, self.values)
        self.node_scale = given_scale(scale, d)
        self.given_scale = None if self.node_scale is None else np.tile(self.node_scale, self.cycle)
        self.data = self
        self.mirror = None if mirror is None else image_map(mirror, d)
        self.generators = [] if self.mirror is None else [("mirror", self.mirror)]
        if self.mirror is not None:
            refuse_no_mirror(self.mirror, d)
        self.symmetric_for = set()
        self._check_start(flat[:d])
        self._find_symmetries()
        self.describe()  # registers the callables by their addresses

    def _iterated(self, first: np.ndarray) -> np.ndarray:
        """Iterate the first point of a cycle to get all; the signs of the switches are taken at each point."""
        nodes = [first]
        for _ in range(self.cycle - 1):
            self.pieces = Pieces(self.pieces.given, self.values, nodes[-1][None, :])
            functions = self.functions_in(self.pieces)
            nodes.append(functions.checked_value(nodes[-1], self.p0))
        return np.concatenate(nodes)

    # ------------------------------------------------------------------ relatives
    def _find_symmetries(self) -> None:
        """Set the symmetries: the shift by half a cycle, the mirror, and both together."""
        even = self.cycle % 2 == 0
        found = [Symmetry("period-doubling", self._shift_by_half, self._root)] if even else []
        if self.mirror is not None:
            found.append(Symmetry("symmetry-breaking", self._mirrored))
            if even:
                found.append(Symmetry("symmetry-breaking", lambda u: self._mirrored(self._shift_by_half(u))))
        self.symmetries = tuple(found)

    def _rebind(self) -> MapProblem:
        super()._rebind()
        self._find_symmetries()
        return self

    def of_unknowns(self, each: np.ndarray) -> np.ndarray:
        return np.tile(each, self.cycle)

    def _with_cycle(self, u: np.ndarray, p: float, pieces: Pieces) -> MapProblem:
        """Return the problem of the same map's cycles of another length, or with other signs; scales are kept."""
        other = copy(self)
        other.values = self.values.against(self.parameter, {self.parameter: p})
        other.u0 = np.array(u, dtype=float)
        other.dimension = len(other.u0)
        other.cycle = other.dimension // self.node
        other.pieces = pieces
        other.functions = self.functions.against(other.values).of(*self._wrapped(pieces))
        other.n_margins = pieces.count
        if self.node_scale is not None:
            other.given_scale = np.tile(self.node_scale, other.cycle)
        if self.scales is not None:
            other.scales = self.scales.head(self.node).tiled(other.cycle)
        return other._rebind()

    def residuals(self, u: np.ndarray, p: float) -> np.ndarray:
        """Return f(x_i) - x_{i+1} without derivatives."""
        nodes = u.reshape(self.cycle, self.node)
        images = np.empty_like(nodes)
        for i, node in enumerate(nodes):
            self.pieces.current = i
            images[i] = self.functions.value(node, p)
        return (images - np.roll(nodes, -1, axis=0)).reshape(-1)

    def equations(self, u: np.ndarray, p: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return the residual f(x_i) - x_{i+1}, its Jacobian and its parameter derivative."""
        n, d = self.cycle, self.node
        nodes = u.reshape(n, d)
        following = np.roll(nodes, -1, axis=0)
        residual = np.empty((n, d))
        derivative = np.empty((n, d))
        jacobian = np.zeros((n, d, n, d))
        for i in range(n):
            self.pieces.current = i
            residual[i] = self.functions.value(nodes[i], p) - following[i]
            jacobian[i, :, i, :] = self.functions.dense_jacobian(nodes[i], p)
            derivative[i] = self.functions.derivative(nodes[i], p)
            jacobian[i, :, (i + 1) % n, :] -= np.eye(d)
        return residual.reshape(-1), jacobian.reshape(n * d, n * d), derivative.reshape(-1)

    def turn_closure(self, jacobian: np.ndarray, sign: float) -> None:
        """Change the closure x_n = x_0 in the Jacobian to x_n = -x_0 (sign = -1), or back (sign = 1), in place."""
        n, d = self.cycle, self.node
        jacobian.reshape(n, d, n, d)[n - 1, :, 0, :] -= 2.0 * sign * np.eye(d)

    def raw_spectrum(self, work: Linearised) -> np.ndarray:
        """Return the multipliers: eigenvalues of the product of the Jacobians along the cycle."""
        n, d = self.cycle, self.node
        jacobian = work.jacobian
        assert isinstance(jacobian, np.ndarray)
        blocks = jacobian.reshape(n, d, n, d)
        product = np.eye(d)
        for i in range(n):
            step = blocks[i, :, i, :]
            if n == 1:
                step = step + np.eye(d)
            product = step @ product
        return without_roundoff(np.linalg.eigvals(product))

    def with_pieces(self, pieces: Pieces) -> MapProblem:
        """Return the same cycles with other signs of the switches; signs of several rounds give cycles of several times the length."""
        rounds = len(pieces.signs) // self.cycle
        return self._with_cycle(np.tile(self.u0, rounds), self.p0, pieces)

    def cycle_through(self, points: np.ndarray, p: float) -> MapProblem:
        """Return the problem of cycles through n given points, shape (n, d), which are its start."""
        return self._with_cycle(
            np.asarray(points, dtype=float).reshape(-1), p, self.pieces.repeated(len(points), 1)
        )

    def _shift_by_half(self, u: np.ndarray) -> np.ndarray:
        return np.roll(u, self.dimension // 2)

    def _mirrored(self, u: np.ndarray) -> np.ndarray:
        assert self.mirror is not None
        return np.concatenate([self.mirror(x) for x in np.asarray(u, dtype=float).reshape(-1, self.node)])

    def _root(self, u: np.ndarray) -> tuple[MapProblem, np.ndarray]:
        half = 0.5 * (u[: self.dimension // 2] + u[self.dimension // 2 :])
        return self._with_cycle(half, self.p0, self.pieces.repeated(1, self.cycle // 2)), half

    def _shortest(self, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The points of the shortest cycle of which u is a repetition, and the largest differences between equal points."""
        nodes, n = np.asarray(u, dtype=float).reshape(self.cycle, self.node), self.cycle
        signs = self.pieces.signs.reshape(n, -1)
        scales = np.ones(self.node) if self.scales is None else self.scales.unknowns[: self.node]
        scale = IDENTITY.same * (scales + np.abs(nodes).max(axis=0))
        root = next(
            r
            for r in range(1, n + 1)
            if n % r == 0
            and (np.abs(nodes - np.roll(nodes, r, axis=0)) <= scale).all()
            and np.array_equal(
                signs, np.roll(signs, r, axis=0)
            )  # at a switch, points of different pieces may coincide
        )
        return nodes[:root], scale

    def root(self, u: np.ndarray, p: float) -> tuple[MapProblem, np.ndarray] | None:
        """Return the problem of the shortest cycle of which u is a repetition, and its points; None if u is no repetition."""
        nodes, _ = self._shortest(u)
        if len(nodes) == self.cycle:
            return None
        flat = nodes.reshape(-1)
        return self._with_cycle(flat, p, self.pieces.repeated(1, len(nodes))), flat

    def offspring(
        self, kind: str, u: np.ndarray, p: float, tangent: np.ndarray, multiplier: complex
    ) -> list[Embedding]:
        """Return, at a period doubling, the cycle as one of twice the length."""
        if kind != "period-doubling":
            return []
        doubled = np.tile(u, 2)
        direction = np.append(np.tile(tangent[:-1], 2), tangent[-1])
        return [Embedding(self._with_cycle(doubled, p, self.pieces.repeated(2)), doubled, direction, kind)]

    def canonical(self, u: np.ndarray, p: float) -> tuple[Hashable, np.ndarray]:
        """Return a key, and the first in dictionary order of the rotations and mirror images of the shortest cycle of which u is a repetition."""
        nodes, scale = self._shortest(u)
        root, n = len(nodes), self.cycle
        signs = self.pieces.signs.reshape(n, -1)
        forms = [nodes]
        if self.mirror is not None:
            forms.append(self._mirrored(nodes.reshape(-1)).reshape(root, self.node))
        turned = [np.roll(form, -first, axis=0).reshape(-1) for form in forms for first in range(root)]
        pieces = min(tuple(np.roll(signs, -first, axis=0).reshape(-1).tolist()) for first in range(n))
        return ("cycle", root, self.node, pieces), min(turned, key=in_order(np.tile(scale, root)))

    # ------------------------------------------------------------------ measures and motions
    @property
    def measure_names(self) -> tuple[str, ...]:
        """Names: the user's outputs, "norm", coordinates of the first point, and mean, smallest and largest coordinates over the cycle."""
        names = [f"{kind}{j}" for kind in ("x", "mean", "min", "max") for j in range(self.node)]
        return (*self.outputs.names, "norm", *names)

    def measures(self, names: Sequence[str], u: np.ndarray, p: np.ndarray) -> dict[str, np.ndarray]:
        """Return the named measures, each of shape (m,), of m solutions."""
        nodes = np.asarray(u, dtype=float).reshape(-1, self.cycle, self.node)
        outputs = [name for name in names if name in self.outputs.names]
        result = self.outputs.measures(outputs, nodes[:, 0], p)
        for name in names:
            if name not in self.measure_names:
                raise KeyError(f"there is no measure {name!r}; choose from {', '.join(self.measure_names)}")
            if name in outputs:
                continue
            kind = name.rstrip("0123456789")
            j = int(name[len(kind) :] or 0)
            if kind == "norm":
                result[name] = np.sqrt((nodes**2).sum(axis=(1, 2)) / self.cycle)
            elif kind == "x":
                result[name] = nodes[:, 0, j]
            else:
                result[name] = getattr(nodes[:, :, j], kind)(axis=1)
        return result

    def at_each_point(self, name: str, u: np.ndarray, p: np.ndarray) -> np.ndarray | None:
        """Return a coordinate ``x0``, ``x1`` ... at every point of m cycles, shape (m, n); None for other measures."""
        if name not in {f"x{j}" for j in range(self.node)}:
            return None
        return np.asarray(u, dtype=float).reshape(-1, self.cycle, self.node)[:, :, int(name[1:])]

    def eigenvectors(self, u: np.ndarray, p: float, values: np.ndarray) -> np.ndarray:
        """Return eigenvectors of the product of the Jacobians along the cycle, as columns, in the order of the given eigenvalues."""
        product = np.eye(self.node)
        for i, x in enumerate(np.asarray(u, dtype=float).reshape(self.cycle, self.node)):
            self.pieces.current = i
            product = self.functions.jacobian(x, p) @ product
        return vectors_of(product, values)

    def orbit(self, u: np.ndarray, p: float) -> np.ndarray:
        """Return the points of the cycle, shape (n, d)."""
        return np.array(u).reshape(self.cycle, self.node)

    def replay(self, u: np.ndarray, p: float) -> float:
        """Return the largest distance between f(x_i) and x_{i+1}."""
        nodes = np.asarray(u, dtype=float).reshape(self.cycle, self.node)
        worst = 0.0
        for i, x in enumerate(nodes):
            self.pieces.current = i
            gap = self.functions.value(x, p) - nodes[(i + 1) % self.cycle]
            worst = max(worst, float(np.abs(gap).max()))
        return worst

    def simulated_attractors(self, p: float, starts: int = 24) -> list[dict[str, Any]]:
        """Iterate starts around the cycle, and list the attractors they settle on, with "word", "periods" and "kind"."""
        population = self.population()
        motions, _, _ = population.settle(population.starts(starts, 7, p), p)
        found = {(m.word, m.periods, "cycle" if m.word else m.kind) for m in motions}
        return [
            {"word": word or None, "periods": periods, "kind": kind} for word, periods, kind in sorted(found)
        ]

    def attractor(self, u: np.ndarray, p: float) -> dict[str, Any]:
        """Return a stable cycle as an entry of `simulated_attractors`."""
        return {"word": f"{self.cycle}-cycle", "periods": self.cycle, "kind": "cycle"}

    def section(self, p: float) -> MapSection:
        """Return the section at a parameter value: one step is one period of the cycle."""
        return MapSection(self, p)

    @hinting
    def population(
        self, over: str | None = None, *, box: Sequence[tuple[float, float]] | None = None
    ) -> Population:
        """Return a population of starts in a box of states, for `atlas` and `basins`.

        Parameters
        ----------
        over : str, optional
            The parameter that varies; by default the problem's own.
        box : sequence of (float, float), optional
            Smallest and largest value of each unknown; by default a box around this cycle.

        Raises
        ------
        ValueError
            If there is no such parameter.
        """
        problem = self if over in (None, self.parameter) else self.against(str(over))
        from ..coexistence.maps import MapPopulation

        return MapPopulation(problem, box)

    def describe(self) -> dict[str, Any]:
        """Return name, cycle, start, and the data from which `from_description` rebuilds the problem if f can be imported."""
        address, importable = addresses(self.given)
        plain = not (self.pieces.count or self.outputs.names)
        return {
            "name": self.name,
            "word": f"{self.cycle}-cycle" + (f" {self.pieces.word}" if self.pieces.count else ""),
            "periods": self.cycle,
            "cycle": self.cycle,
            "dimension": self.node,
            "parameter": self.parameter,
            "u0": self.u0.tolist(),
            "p0": self.values.given(),
            "scale": None if self.node_scale is None else self.node_scale.tolist(),
            "callables": address,
            "factory": "contvines.problems.maps:from_description" if importable and plain else None,
        }


def from_description(description: Mapping[str, Any], trust: bool = False) -> MapProblem | None:
    """Rebuild a MapProblem from the result of ``describe()``; None if its callables cannot be found."""
    functions = find_callables(description["callables"], trust)
    if functions is None:
        return None
    f = functions.pop("F")
    return MapProblem(
        f,
        description["u0"],
        description["p0"],
        description["cycle"],
        description["parameter"],
        name=description["name"],
        dimension=description["dimension"],
        scale=description.get("scale"),
        **functions,
    )
