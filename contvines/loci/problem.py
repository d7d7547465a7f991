"""LocusProblem: the special points of one kind as solutions of a continuation problem in a second parameter."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping, Sequence
from functools import cached_property
from typing import Any, NamedTuple, Self

import numpy as np

from contvines.shared.near_names import did_you_mean

from ..bifurcation.kind import Kind, number_of
from ..bifurcation.kinds import critical
from ..core.library import native
from ..core.table import TableKernels, memory_of, native_table, pack
from ..problems.abilities import notation_of
from ..problems.protocol import KernelFunctions, Kernels, Problem, ProblemDefaults, array_of
from .kernels import (
    BRANCH,
    FLIP,
    LONGEST,
    MARGIN,
    OWN,
    PAIR,
    condition,
    locus_bordered,
    locus_inspect,
    locus_linearise,
)
from .linear import borders_at, fresh_borders
from .settings import SCALING

FURTHER = 100.0  # largest ratio of the scales of a locus to those of the branch
IN_PYTHON = Kernels(locus_linearise, locus_bordered, locus_inspect)
NOTHING = np.zeros(0)


class Data(NamedTuple):
    """The `data` of the kernels of a locus; ``memory`` is the struct `Data` of native/loci.hpp."""

    first: object
    second: object
    calls: KernelFunctions
    kind: int
    which: int
    multipliers: int
    flow: bool
    unit: float
    memory: np.ndarray = NOTHING
    own: Callable[..., float] | None = None


class Work:
    """Arrays of the kernels, in the order of the struct `Work` of native/loci.hpp, which is ``memory``."""

    memory = NOTHING

    def __init__(self, locus: LocusProblem) -> None:
        problem, n, size = locus.base, locus.size, locus.dimension
        column, tests = problem.kernels.column, max(size - n, 2)
        self.base, self.trial = locus.first.workspace(), locus.first.workspace()
        self.residual = np.zeros(size)
        self.base_F, self.base_Q = array_of(self.base).reshape(-1), array_of(self.base, column).reshape(-1)
        self.trial_F = array_of(self.trial).reshape(-1)
        self.trial_Q = array_of(self.trial, column).reshape(-1)
        self.point = np.zeros(size + 1)
        self.columns = np.zeros((2, n))
        self.solutions = np.zeros((6, n + 1))
        self.directions = np.zeros((4, size + 1))
        self.borders = locus.borders.copy()
        self.row = np.zeros(2 * problem.n_multipliers + problem.n_margins)
        self.shifted = np.zeros(n + 1)
        self.scales = locus.sizes
        self.values, self.slopes = np.zeros((2, tests))
        self.lines = np.zeros((2, n + 1))
        self.reference = np.array(
            [locus.reference, 0.0, 0.0, *(bound / locus.unit for bound in locus.bounds)]
        )
        self.small = np.zeros((3, 5))
        self.masked = np.array(locus.masked, np.int64).reshape(-1)
        self.rows = locus.rows
        self.frozen = np.zeros(size + 1)
        self.steep = np.zeros((3, tests))
        self.state = np.array([-1.0, 1.0, 0.0, LONGEST])
        self.frame = np.random.default_rng(7).standard_normal(n + 1) / np.sqrt(n)
        self.last_residual = np.zeros(size)
        if locus.compiled:
            arrays = [part for part in vars(self).values() if isinstance(part, np.ndarray)]
            places = memory_of(self.base), memory_of(self.trial)
            self.memory = pack(n, size, len(self.masked), *places, *arrays, len(self.row))

    def __getitem__(self, place: int) -> np.ndarray:
        return (self.residual,)[place]


class LocusProblem(ProblemDefaults):
    """Special points of one kind of a problem, as solutions with the second parameter q as the continuation parameter.

    The unknowns are (u, p), at branch points also the unfolding e, which is zero along the locus.

    Parameters
    ----------
    problem : Problem
        Its kernels must have the optional entries of the protocol.
    kind : str
        Kind of the special points.
    over : str
        Name of the second parameter.
    index : int
        For borders: index of the margin. For homoclinic orbits: index of the period among the unknowns.
    bounds : (float, float)
        Interval of the first parameter; the locus ends at its ends.
    borders : ndarray, shape (4, N + 1), optional
        Borders of the bordered systems, as :func:`contvines.loci.starts.begin` computes them.
    reference : float
        Position of the pair of multipliers, see ``pair_of``; for homoclinic orbits the period.
    masked : sequence of int
        Margins that are zero along the whole locus, such as that of a border.
    unit : float
        Unit of the first parameter as an unknown.
    own_kind : Kind, optional
        A user-defined kind, whose condition is evaluated in Python.

    Raises
    ------
    ValueError
        If the problem has no such parameter, has no kernels for loci, or has no locus of this kind.
    """

    spectrum = "none"

    def __init__(
        self,
        problem: Problem,
        kind: str,
        over: str,
        index: int = 0,
        bounds: tuple[float, float] = (-np.inf, np.inf),
        borders: np.ndarray | None = None,
        reference: float = 0.0,
        masked: Sequence[int] = (),
        unit: float = 1.0,
        own_kind: Kind | None = None,
    ) -> None:
        check_second(problem, over)
        kernels = problem.kernels
        if kernels.transpose is None:
            raise ValueError(
                f"{type(problem).__name__} has no kernels for loci (assign, flip, transpose, column)"
            )
        self.base, self.kind, self.over, self.index = problem, kind, over, int(index)
        self.own_kind = own_kind
        self.condition = condition(problem, kind) if own_kind is None else OWN
        if self.condition == FLIP and problem.movable:
            raise ValueError(
                "symmetric motions without impacts may be moved as a whole; their symmetry breaking is not isolated and "
                "has no locus"
            )
        if self.condition == PAIR and problem.n_multipliers < 2:
            raise ValueError("a pair of multipliers needs a problem with at least two of them")
        # copies, since the kernels change their parameters in place
        self.first = problem.against(problem.parameter)
        self.second = self.first.against(over)
        self.parameter = over
        self.inner = problem.parameter
        self.size = int(problem.dimension)
        self.dimension = self.size + (2 if self.condition == BRANCH else 1)
        self.bounds = (float(bounds[0]), float(bounds[1]))
        self.reference = float(reference)
        self.masked = tuple(int(j) for j in masked)
        self.unit = float(unit)
        # typical sizes of unknowns, both parameters, and equations; workspaces share these arrays
        self.sizes, self.rows = np.ones(self.size + 3), np.ones(self.size)
        self.borders = fresh_borders(self.size) if borders is None else np.array(borders, dtype=float)
        self.n_multipliers = int(problem.n_multipliers)
        self.n_margins = int(problem.n_margins) + 3
        self.compiled = bool(kernels.compiled) and native() and own_kind is None
        self.kernels = TableKernels(native_table("core_loci_table")) if self.compiled else IN_PYTHON
        self.natural = has_natural_units(problem)
        options = self.tested, self.index, self.n_multipliers, problem.spectrum == "flow", self.unit
        evaluate = None if own_kind is None else self._own_condition
        self.data = Data(self.first.data, self.second.data, self.first.kernels, *options, own=evaluate)
        if isinstance(kernels, TableKernels) and self.compiled:
            places = memory_of(self.first.data), memory_of(self.second.data)
            self.data = self.data._replace(memory=pack(kernels.table, *places, *options))
        shift = problem.period_shift
        if shift is not None and np.any(shift):
            self.period_shift = np.append(shift, np.zeros(self.dimension - self.size))

    def _own_condition(self, u: np.ndarray, p: float, q: float, work: object, row: np.ndarray) -> float:
        """Evaluate the condition of a user-defined kind at a solution; `work` and `row` are overwritten."""
        first, kind = self.first, self.own_kind
        assert kind is not None and callable(kind.locus)
        first.kernels.inspect(first.data, u, p, work, row)
        point = PointOfLocus(self, first, u, p, q, row)
        return number_of(kind, "locus", point)

    @property
    def tested(self) -> int:
        """Condition whose test the kernels evaluate."""
        return self.condition

    def workspace(self) -> Work:
        """Return arrays for the kernels; their borders and reference change along a trace."""
        return Work(self)

    def scale_within(self, within: tuple[float, float]) -> np.ndarray:
        """Typical sizes of unknowns, first parameter (and unfolding) and second parameter, shape (dimension + 1,)."""
        scale, width = np.ones(self.dimension + 1), within[1] - within[0]
        # second parameter: its value at the start or, if that is nearly zero, the width of the interval
        start = abs(self.base.parameters[self.over])
        second = min(width, start) if start > SCALING.start * width else width
        if not self.natural:
            scales = self.base.scales
            if scales is None and np.isfinite(self.bounds).all():
                self.base.scale_within(self.bounds)
                scales = self.base.scales
            if scales is not None:
                largest = float(scales.unknowns.max())
                # an unknown that is zero along the whole branch gets the largest scale
                sizes = np.where(scales.unknowns < SCALING.unseen * largest, largest, scales.unknowns)
                if self.base.scales_learned:
                    # the motion changes more along a locus: use the scales of a branch in the second parameter, too
                    moved = self.second.scale_within(within)[:-1]
                    sizes = np.maximum(sizes, np.minimum(moved, FURTHER * sizes))
                scale[: self.size], scale[self.size] = sizes, scales.parameter
                self.rows[:] = scales.rows
            scale[-1] = second
        self.sizes[: self.size + 1] = scale[: self.size + 1]
        self.sizes[self.dimension] = second
        return scale

    def sizes_at(self, u: np.ndarray, p: float, q: float) -> np.ndarray:
        """Return sizes of (u, p, q) near a place, relative to which changes are measured."""
        parameters = self.unit * self.sizes[self.size], self.sizes[self.dimension]
        sizes = np.append(self.sizes[: self.size], parameters)
        return np.maximum(sizes, np.abs(np.append(u, [p, q])))

    # ------------------------------------------------------------------ unknowns and related problems
    def split(self, U: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Split the unknowns of a locus into (u, p)."""
        return np.asarray(U[..., : self.size]), self.unit * U[..., self.size]

    def joined(self, u: np.ndarray, p: float) -> np.ndarray:
        """Join u and p to the unknowns of a locus."""
        return np.concatenate([u, [p / self.unit], np.zeros(self.dimension - self.size - 1)])

    def at(self, q: float) -> Problem:
        """Return the problem of the branches at a value of the second parameter."""
        return self.base.against(self.inner, {self.over: float(q)})

    def again(self, problem: Problem, **changed: Any) -> Self:
        """Return the same locus for another problem, with some of its arguments changed."""
        arguments = {
            "index": self.index,
            "bounds": self.bounds,
            "reference": self.reference,
            "masked": self.masked,
            "unit": self.unit,
            "own_kind": self.own_kind,
        }
        return type(self)(problem, self.kind, self.over, **arguments | changed)

    def bordered_at(self, u: np.ndarray, p: float, q: float, reference: float) -> Self:
        """Return the same locus with the borders of one of its points, and a given position of the pair."""
        problem = self.at(q)
        borders = borders_at(problem, self.condition, u, p)
        return self.again(problem, borders=borders, reference=reference)

    def margin_kind(self, j: int) -> str:
        """Return the kind of border of margin j: that of the problem, "end" if p leaves its interval, "resonance" if a pair becomes real."""
        count = int(self.base.n_margins)
        if j < count:
            return self.base.margin_kind(j)
        return "resonance" if j == count + 2 else "end"

    def to_multipliers(self, spectrum: np.ndarray) -> np.ndarray:
        """Return multipliers over the full period from raw ones."""
        return self.base.to_multipliers(spectrum)

    def canonical(self, u: np.ndarray, p: float) -> tuple[Hashable, np.ndarray]:
        """Return a key and a vector of the special point, with its parameter value."""
        inner, value = self.split(np.asarray(u, dtype=float))
        key, vector = self.base.canonical(inner, float(value))
        index = self.index if self.condition == MARGIN else 0
        return (self.kind, index, key), np.append(vector, value / self.unit)

    @property
    def measure_names(self) -> tuple[str, ...]:
        """Name of the first parameter, and of the measures of the problem."""
        return (self.inner, *self.base.measure_names)

    def measures(self, names: Sequence[str], u: np.ndarray, p: np.ndarray) -> dict[str, np.ndarray]:
        """Return the named measures, each of shape (m,), of m points of the locus."""
        inner, values = self.split(np.atleast_2d(u))
        result: dict[str, np.ndarray] = {self.inner: np.array(values)} if self.inner in names else {}
        others = tuple(name for name in names if name != self.inner)
        if others:
            rows = [
                self.at(q).measures(others, u[None, :], np.array([v]))
                for u, v, q in zip(inner, values, np.atleast_1d(np.asarray(p)))
            ]
            result |= {name: np.array([row[name][0] for row in rows]) for name in others}
        return result

    def orbit(self, u: np.ndarray, p: float) -> object:
        """Return the motion at a point of the locus as an orbit object of the problem."""
        inner, value = self.split(u)
        return critical(self.at(p).orbit(inner, float(value)), self.kind)

    @property
    def notation(self) -> dict[str, str]:
        """Axis labels of the problem."""
        return notation_of(self.base)

    def describe(self) -> dict[str, Any]:
        """Return a description from which `from_description` rebuilds the problem."""
        base = dict(self.base.describe())
        rebuilds = base.get("factory") and self.own_kind is None
        return {
            **{key: base[key] for key in ("word", "periods", "impacts", "symmetric") if key in base},
            "name": f"{self.kind} locus",
            "kind": self.kind,
            "parameter": self.over,
            "first": self.inner,
            "index": self.index,
            "bounds": list(self.bounds),
            "reference": self.reference,
            "masked": list(self.masked),
            **({"unit": self.unit} if self.unit != 1.0 else {}),
            "borders": self.borders.tolist(),
            "problem": base,
            "factory": f"{type(self).__module__}:from_description" if rebuilds else None,
        }

    @classmethod
    def rebuilt(
        cls, description: Mapping[str, Any], trust: bool, own_kind: Kind | None = None
    ) -> Self | None:
        """Rebuild a locus from the result of `describe`, with its user-defined kind if it has one; None if the user's functions cannot be found."""
        from ..problems.registry import rebuild

        problem, (low, high) = rebuild(description["problem"], trust), description["bounds"]
        if problem is None:
            return None
        options = {name: description[name] for name in ("index", "borders", "reference", "masked")}
        options |= {"bounds": (low, high), "unit": description.get("unit", 1.0), "own_kind": own_kind}
        return cls(problem, description["kind"], description["parameter"], **options)


def check_second(problem: Problem, over: str) -> None:
    """Check the name of a second parameter.

    Raises
    ------
    ValueError
        If the problem has no such parameter, or it is the varying one.
    """
    names = list(problem.parameters)
    if over == problem.parameter:
        raise ValueError(
            f"over = {over!r} is the parameter of the diagram itself; name another one: "
            + (", ".join(name for name in names if name != over) or "this problem has no other")
        )
    if over not in names:
        raise ValueError(
            f"over = {over!r}: the problem has no such parameter{did_you_mean(over, names)}; it has {', '.join(names) or 'none by name'}"
        )


def has_natural_units(problem: Problem) -> bool:
    """Whether all unknowns of a problem are of order 1, so that it needs no scales."""
    return bool(getattr(problem.kernels, "natural", problem.kernels.compiled))


def from_description(description: Mapping[str, Any], trust: bool = False) -> LocusProblem | None:
    """Rebuild a LocusProblem from the result of `describe`; None if the user's functions cannot be found."""
    return LocusProblem.rebuilt(description, trust)


class PointOfLocus:
    """A point of a locus, as the argument of functions of user-defined kinds: like :class:`~contvines.bifurcation.kind.PointOnBranch`, without a tangent.

    ``value`` is the first parameter; ``parameters`` contain all parameters, ``place`` only the two that vary, the first one first.

    Parameters
    ----------
    locus : LocusProblem
    there : Problem
        Problem whose data have the second parameter's value.
    u, p, q
        The point.
    row : ndarray
        Its multipliers and margins.
    """

    def __init__(
        self, locus: LocusProblem, there: Problem, u: np.ndarray, p: float, q: float, row: np.ndarray
    ) -> None:
        self.locus, self.there = locus, there
        self.u, self.value, self.row = np.array(u), float(p), np.array(row)
        self.place = {locus.inner: float(p), locus.over: float(q)}
        self.parameters = {**locus.base.parameters, **self.place}

    @property
    def problem(self) -> Problem:
        """Problem of the branches at this value of the second parameter."""
        return self.locus.at(self.place[self.locus.over])

    @cached_property
    def jacobian(self) -> np.ndarray:
        """F_u of the problem's equations, shape (N, N)."""
        kernels, data, work = self.there.kernels, self.there.data, self.there.workspace()
        if kernels.matrix is None:
            raise ValueError(f"a {type(self.there).__name__} does not provide its Jacobian")
        kernels.linearise(data, self.u, self.value, work)
        return np.array(kernels.matrix(data, work))

    @cached_property
    def multipliers(self) -> np.ndarray:
        """Multipliers over the full period (eigenvalues for flows), complex."""
        pairs = self.row[: 2 * self.locus.n_multipliers]
        return np.asarray(self.locus.to_multipliers(pairs.view(complex)), dtype=complex)

    @property
    def margins(self) -> np.ndarray:
        """Margins: distances from borders, positive inside."""
        return self.row[2 * self.locus.n_multipliers :]

    def measure(self, name: str) -> float:
        """Return a measure of the solution by its name."""
        found = self.problem.measures((name,), self.u[None, :], np.array([self.value]))
        return float(found[name][0])
