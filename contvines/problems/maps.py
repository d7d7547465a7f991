"""MapProblem: cycles of a map x -> f(x, p)."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from copy import copy
from functools import cmp_to_key
from typing import Any

import numpy as np

from .dense import KERNELS, DenseWork, dense_workspace
from .derivatives import Differentiated
from .images import image_map
from .parameters import ParameterSet
from .protocol import Embedding, ProblemDefaults, Symmetry
from .registry import find_callables

SAME = 1e-7  # points closer than this, relative to 1 + the largest coordinate, are one


class MapProblem(ProblemDefaults):
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
        (x, p) -> df/dx of shape (d, d), df/dp of shape (d,). Else the complex step, where f allows it, or sixth-order
        differences.
    mirror : callable, matrix or permutation, optional
        x -> R x with f(R x, p) = R f(x, p). Bifurcations to less symmetric cycles are symmetry breakings, of two mirror
        images one is traced.
    name : str
    dimension : int, optional
        d, where u0 leaves it open (a flat u0 of n d numbers is otherwise read with d = len(u0) / n).

    Raises
    ------
    ValueError
        If the start does not fit the cycle, or f does not return d finite numbers.
    """

    spectrum = "map"
    flip_kind = "period-doubling"

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
        mirror: Any = None,
    ) -> None:
        if not (isinstance(cycle, (int, np.integer)) and cycle >= 1):
            raise ValueError(f"cycle = {cycle!r} must be a whole number of at least 1")
        start = np.array(u0, dtype=float)
        flat = start.reshape(-1)
        if dimension is None:
            if start.ndim == 2 or (cycle > 1 and len(flat) % cycle == 0 and len(flat) >= cycle):
                d = len(flat) // (start.shape[0] if start.ndim == 2 else cycle)
            else:
                d = len(flat)
        else:
            d = int(dimension)
        self.values = ParameterSet(p0, parameter)
        self.cycle, self.name = int(cycle), name
        value = np.asarray(f(flat[:d].copy(), self.values.at(self.p0)), dtype=float).reshape(-1)
        if len(value) != d or not np.all(np.isfinite(value)):
            raise ValueError(f"the map must return {d} finite numbers for {d} at the start, not {value}")
        if len(flat) == d and cycle > 1:
            nodes = [flat]
            for _ in range(cycle - 1):
                nodes.append(np.asarray(f(nodes[-1], self.values.at(self.p0)), dtype=float).reshape(-1))
            flat = np.concatenate(nodes)
        if len(flat) != d * cycle:
            raise ValueError(
                f"u0 has {len(flat)} numbers; a {cycle}-cycle of points with {d} needs {d * cycle}"
            )
        self.u0 = flat
        self.node = d
        self.dimension = d * self.cycle
        self.n_multipliers = d
        self.functions = Differentiated(f, jacobian, derivative, flat[:d], self.values)
        self.kernels = KERNELS
        self.data = self
        self.given_mirror = mirror
        self.mirror = None if mirror is None else image_map(mirror, d)
        self._find_symmetries()
        self.describe()  # its callables are known by their addresses from now on

    def _find_symmetries(self) -> None:
        """Images of a cycle that solve the same equations: half a cycle on, mirrored, and both at once."""
        even = self.cycle % 2 == 0
        found = [Symmetry("period-doubling", self._shift_by_half, self._root)] if even else []
        if self.mirror is not None:
            found.append(Symmetry("symmetry-breaking", self._mirrored))
            if even:
                found.append(Symmetry("symmetry-breaking", lambda u: self._mirrored(self._shift_by_half(u))))
        self.symmetries = tuple(found)

    @property
    def parameter(self) -> str:
        """Name of the parameter that varies."""
        return self.values.varying

    @property
    def parameters(self) -> dict[str, float]:
        """All parameters by name; of the one that varies the value at the start."""
        return dict(self.values.values)

    @property
    def p0(self) -> float:
        """Value of the varying parameter at the start."""
        return self.values.start

    def against(self, parameter: str, values: Mapping[str, float] | None = None) -> MapProblem:
        """The same cycles with another parameter varying, and with other values of some parameters."""
        other = copy(self)
        other.values = self.values.against(parameter, values)
        other.functions = self.functions.against(other.values)
        other.data = other
        other._find_symmetries()
        return other

    def workspace(self) -> DenseWork:
        """Arrays for the kernels."""
        return dense_workspace(self.dimension)

    def equations(self, u: np.ndarray, p: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Residual f(x_i) - x_{i+1}, its Jacobian and parameter derivative."""
        n, d = self.cycle, self.node
        nodes = u.reshape(n, d)
        following = np.roll(nodes, -1, axis=0)
        residual = np.empty((n, d))
        derivative = np.empty((n, d))
        jacobian = np.zeros((n, d, n, d))
        for i in range(n):
            residual[i] = self.functions.value(nodes[i], p) - following[i]
            jacobian[i, :, i, :] = self.functions.jacobian(nodes[i], p)
            derivative[i] = self.functions.derivative(nodes[i], p)
            jacobian[i, :, (i + 1) % n, :] -= np.eye(d)
        return residual.reshape(-1), jacobian.reshape(n * d, n * d), derivative.reshape(-1)

    def turn_closure(self, jacobian: np.ndarray, sign: float) -> None:
        """x_n = x_0 in the Jacobian becomes x_n = -x_0 (sign = -1) or x_n = x_0 again (sign = 1)."""
        n, d = self.cycle, self.node
        jacobian.reshape(n, d, n, d)[n - 1, :, 0, :] -= 2.0 * sign * np.eye(d)

    def raw_spectrum(self, work: DenseWork) -> np.ndarray:
        """Multipliers: eigenvalues of the product of the Jacobians along the cycle."""
        n, d = self.cycle, self.node
        blocks = work.jacobian.reshape(n, d, n, d)
        product = np.eye(d)
        for i in range(n):
            step = blocks[i, :, i, :]
            if n == 1:
                step = step + np.eye(d)
            product = step @ product
        return np.linalg.eigvals(product)

    def _shift_by_half(self, u: np.ndarray) -> np.ndarray:
        return np.roll(u, self.dimension // 2)

    def _mirrored(self, u: np.ndarray) -> np.ndarray:
        assert self.mirror is not None
        return np.concatenate([self.mirror(x) for x in np.asarray(u, dtype=float).reshape(-1, self.node)])

    def sibling(self, u: np.ndarray, p: float, cycle: int) -> MapProblem:
        """The problem of cycles of another length of the same map, with its start at (u, p)."""
        return MapProblem(
            self.functions.f,
            u,
            self.values.against(self.parameter, {self.parameter: p}).given(),
            cycle,
            self.parameter,
            self.functions.given_jacobian,
            self.functions.given_derivative,
            self.name,
            self.node,
            self.given_mirror,
        )

    def _root(self, u: np.ndarray) -> tuple[MapProblem, np.ndarray]:
        half = 0.5 * (u[: self.dimension // 2] + u[self.dimension // 2 :])
        return self.sibling(half, self.p0, self.cycle // 2), half

    def _shortest(self, u: np.ndarray) -> tuple[np.ndarray, float]:
        """The points of the shortest cycle of which u is a repetition, and the difference at which points are one."""
        nodes, n = np.asarray(u, dtype=float).reshape(self.cycle, self.node), self.cycle
        scale = SAME * (1.0 + float(np.abs(nodes).max()))
        root = next(
            r
            for r in range(1, n + 1)
            if n % r == 0 and np.abs(nodes - np.roll(nodes, r, axis=0)).max() <= scale
        )
        return nodes[:root], scale

    def root(self, u: np.ndarray, p: float) -> tuple[MapProblem, np.ndarray] | None:
        """The problem of the shortest cycle of which u is a repetition, and its points; None if u is no repetition."""
        nodes, _ = self._shortest(u)
        return None if len(nodes) == self.cycle else (self.sibling(nodes, p, len(nodes)), nodes.reshape(-1))

    def offspring(
        self, kind: str, u: np.ndarray, p: float, tangent: np.ndarray, multiplier: complex
    ) -> list[Embedding]:
        """At a period doubling: the cycle of twice the length."""
        if kind != "period-doubling":
            return []
        doubled = np.tile(u, 2)
        direction = np.append(np.tile(tangent[:-1], 2), tangent[-1])
        return [Embedding(self.sibling(doubled, p, 2 * self.cycle), doubled, direction, kind)]

    def canonical(self, u: np.ndarray, p: float) -> tuple[Any, np.ndarray]:
        """The shortest cycle of which u is a repetition, of its rotations and mirror images the smallest."""
        nodes, scale = self._shortest(u)
        root = len(nodes)
        forms = [nodes]
        if self.mirror is not None:
            forms.append(self._mirrored(nodes.reshape(-1)).reshape(root, self.node))
        turned = [np.roll(form, -first, axis=0).reshape(-1) for form in forms for first in range(root)]
        return ("cycle", root, self.node), min(turned, key=_in_order(scale))

    @property
    def measure_names(self) -> tuple[str, ...]:
        """Mean, smallest and largest of each coordinate over the cycle, and the coordinates of its first point."""
        names = [f"{what}{j}" for what in ("x", "mean", "min", "max") for j in range(self.node)]
        return ("norm", *names)

    def measures(self, names: Sequence[str], u: np.ndarray, p: np.ndarray) -> dict[str, np.ndarray]:
        """Measures for an array of solutions."""
        nodes = np.asarray(u, dtype=float).reshape(-1, self.cycle, self.node)
        result = {}
        for name in names:
            if name not in self.measure_names:
                raise KeyError(f"there is no measure {name!r}; choose from {', '.join(self.measure_names)}")
            what = name.rstrip("0123456789")
            j = int(name[len(what) :] or 0)
            if what == "norm":
                result[name] = np.sqrt((nodes**2).sum(axis=(1, 2)) / self.cycle)
            elif what == "x":
                result[name] = nodes[:, 0, j]
            else:
                result[name] = getattr(nodes[:, :, j], what)(axis=1)
        return result

    def at_each_point(self, name: str, u: np.ndarray, p: np.ndarray) -> np.ndarray | None:
        """A coordinate ``x0``, ``x1`` ... at every point of the cycle, shape (m, n); None for other measures."""
        if name not in {f"x{j}" for j in range(self.node)}:
            return None
        return np.asarray(u, dtype=float).reshape(-1, self.cycle, self.node)[:, :, int(name[1:])]

    def population(self, over: str | None = None, *, box: Sequence[tuple[float, float]] | None = None) -> Any:
        """Starts in a box (by default round this cycle) and what they settle on; see `contvines.coexistence.maps`."""
        from ..coexistence.maps import MapPopulation

        return MapPopulation(self if over in (None, self.parameter) else self.against(str(over)), box)

    def orbit(self, u: np.ndarray, p: float) -> np.ndarray:
        """The points of the cycle, shape (n, d)."""
        return np.array(u).reshape(self.cycle, self.node)

    def replay(self, u: np.ndarray, p: float) -> float:
        """Largest distance after iterating each point of the cycle once."""
        nodes = np.asarray(u).reshape(self.cycle, self.node)
        images = np.array([self.functions.value(x, p) for x in nodes])
        return float(np.abs(images - np.roll(nodes, -1, axis=0)).max())

    def describe(self) -> dict[str, Any]:
        """Name, cycle, start, and how to build the problem again if f can be imported."""
        where, importable = self.functions.addresses(mirror=self.given_mirror)
        return {
            "name": self.name,
            "word": f"{self.cycle}-cycle",
            "periods": self.cycle,
            "cycle": self.cycle,
            "dimension": self.node,
            "parameter": self.parameter,
            "u0": self.u0.tolist(),
            "p0": self.values.given(),
            "callables": where,
            "factory": "contvines.problems.maps:from_description" if importable else None,
        }


def from_description(description: Mapping[str, Any], trust: bool = False) -> MapProblem | None:
    """A MapProblem from what ``describe()`` returned; None where its callables are not at hand."""
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
        **functions,
    )


def _in_order(scale: float) -> Any:
    """A key of dictionary order, in which differences at roundoff do not count."""

    def compare(a: np.ndarray, b: np.ndarray) -> int:
        different = np.flatnonzero(np.abs(a - b) > scale)
        return 0 if not len(different) else (-1 if a[different[0]] < b[different[0]] else 1)

    return cmp_to_key(compare)
