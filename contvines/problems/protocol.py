"""The protocol of a problem F(u, p) = 0: every method and attribute that contvines uses.

The contract:

1. A problem has N equations F(u, p) = 0 for N unknowns u (a flat float64 array), and one varying parameter p.
2. ``kernels`` holds three functions, plain Python or a table of C functions (`contvines.core.table`), with the same signatures:

   ``linearise(data, u, p, work) -> float``
       evaluates F, dF/du and dF/dp into ``work`` and returns the largest absolute residual (inf if the equations cannot
       be evaluated). ``work[0]`` is F (any C-contiguous shape with N entries); the caller may overwrite it between calls.
   ``bordered(data, work, border, n, step, tangent) -> float``
       solves ``[[F_u, F_p], [border]] x = rhs`` with one elimination for ``rhs = (-F, n)`` (into step) and
       ``rhs = (0, 1)`` (into tangent); F is read from ``work[0]``. Returns the sign of the determinant; for a singular
       matrix it returns 0, and the solution is that of a matrix with a tiny pivot.
   ``inspect(data, u, p, work, row) -> None``
       from the linearisation in ``work``, writes the m multipliers (or eigenvalues) into ``row[:2 m]`` as pairs (re, im),
       and the margins into ``row[2 m:]``. A margin is positive on a real solution, and +inf where it does not apply.

   Loci against a second parameter need five more entries, which are optional:

   ``assign(data, other, value) -> None``
       sets, in ``data`` and in place, the parameter that varies in the problem with the data ``other`` (see ``against``).
   ``column``
       index of F_p in ``work`` (any C-contiguous shape with N entries); the caller may overwrite F_p between calls, and
       ``bordered`` then uses the new column.
   ``flip(data, work, sign) -> None``
       maps only: changes F_u in ``work`` into the matrix that acts on perturbations which change sign over the period
       (sign = -1), or changes it back (sign = 1).
   ``transpose(data, work, column, other) -> None``
       writes the transposed F_u, and ``column`` in place of F_p, into the workspace ``other``.
   ``matrix(data, work) -> ndarray``
       returns F_u as ``work`` holds it, shape (N, N), for normal forms at single points.
3. The attribute ``data`` and the result of ``workspace()`` are the ``data`` and ``work`` of the kernels; their contents are private to the problem.
4. ``spectrum`` is the kind of the raw spectrum: "map" (stable inside the unit circle), "flow" (stable left of the imaginary axis), "none".
   With "none", ``detection`` = "real" still lets branch points be found from real eigenvalues.
   ``flip_kind`` is the bifurcation at a raw multiplier -1: "period-doubling" or "symmetry-breaking". ``to_multipliers`` converts the raw
   spectrum to multipliers over the full period (squares, if the raw ones belong to half a period) or eigenvalues in the unit of time.
5. Solutions that differ by a multiple of ``period_shift`` or by one of the ``symmetries`` are equivalent. ``canonical(u, p)`` returns a
   hashable key and a vector which are equal for equivalent solutions; the vector has the scales of the unknowns or, if it is longer,
   entries of order one. If a solution only repeats a shorter one (a cycle run through twice), ``root(u, p)`` returns the smaller
   problem and its unknowns, else None. ``same_motion(u, p, other, v)`` compares solutions of two problems that ``canonical`` cannot
   compare (two words of one motion at a border): True, False, or None if the problem cannot decide.
6. ``offspring`` returns larger problems in which a special point is a branch point (cycles of twice the period); ``beyond`` returns
   the solutions on the other side of a border, and ``dead_end`` the reason if there are none. ``margin_kind(j)`` is the kind of border at
   which margin j vanishes.
7. ``parameters`` are all parameters by name; ``against`` returns the problem with another parameter varying. ``check_value``
   raises ValueError for a value that a parameter cannot have.
8. ``scale_within`` returns typical sizes of the unknowns and the parameter; ``amplitude`` the length of a direction of the unknowns,
   by which normal forms are normalised. Equations without ``scales`` (learned or given) must have residuals of order 1.
9. ``movable`` solutions are not isolated: they form families by a continuous shift.
10. ``uncertainty`` is the relative accuracy of the equations, ``noise`` that of the unknowns if the equations have noise; ``check`` returns
    a sentence if given derivatives disagree with the equations; ``explain_end`` returns the reason why Newton's method fails at the end of
    a branch.
11. ``measures(names, u, p)`` returns measures by name, each of shape (m,), of m solutions u of shape (m, N); ``angles`` are the names of
    measures in radians modulo 2 pi. ``at_each_point`` returns a measure at each of the n points of m cycles, shape (m, n), or None.
    ``orbit(u, p)`` returns a solution as an object for users, ``replay(u, p)`` the largest deviation of a simulation from it (None: it cannot
    be simulated), and ``simulated_attractors(p)`` the motions on which simulated starts settle, as JSON-able dicts. ``describe()`` returns a
    JSON-able description, from which the factory that it names rebuilds the problem (`contvines.problems.registry`).

The protocol `Problem` consists of five smaller ones, `Equations`, `Spectrum`, `Symmetries`, `Borders` and `Description`; a function
requires the one that it uses. They are structural: a problem need not inherit from them. :class:`ProblemDefaults` implements the members
that a simple problem does not need. Optional abilities of some problems are in ``contvines/problems/abilities.py``.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol, cast

import numpy as np

from ..core.table import KernelFunctions

if TYPE_CHECKING:
    from .scales import Scales


class Places(Protocol):
    """A workspace: arrays by index."""

    def __getitem__(self, place: int, /) -> object: ...


def array_of(work: object, place: int = 0) -> np.ndarray:
    """Return an array of a workspace: F at index 0, F_p at the kernels' ``column``."""
    found = cast(Places, work)[place]  # unchecked, as it is called at every point
    assert isinstance(found, np.ndarray)
    return found


@dataclass(frozen=True)
class Kernels:
    """Kernels in Python; the contract is at the top of :mod:`contvines.problems.protocol`.

    Parameters
    ----------
    linearise, bordered, inspect : callable
    compiled : bool
        False for kernels in Python.
    assign, flip, transpose, matrix : callable, optional
        For loci against a second parameter.
    column : int
        Index of F_p in a workspace, for loci; -1: none.
    """

    linearise: Callable[..., float]
    bordered: Callable[..., float]
    inspect: Callable[..., None]
    compiled: bool = False
    assign: Callable[..., None] | None = None
    flip: Callable[..., None] | None = None
    transpose: Callable[..., None] | None = None
    column: int = -1
    matrix: Callable[..., np.ndarray] | None = None


@dataclass(frozen=True)
class Symmetry:
    """A symmetry: it maps a solution u to another solution of the same problem.

    Parameters
    ----------
    kind : str
        Bifurcation at which branches without this symmetry leave a solution that has it: "symmetry-breaking" for a mirror,
        "period-doubling" for the shift of a doubled cycle by half its length.
    apply : callable
        u -> image of u, both of shape (N,).
    root : callable, optional
        u -> (problem, u): smaller problem and its unknowns, for a solution u that has the symmetry.
    kind_at : callable, optional
        u -> kind, if it depends on the symmetric solution u.
    offset : callable, optional
        p -> vector of shape (N,) added to `apply(u)`, if the image depends on the parameter.
    """

    kind: str
    apply: Callable[[np.ndarray], np.ndarray]
    root: Callable[[np.ndarray], tuple[Problem, np.ndarray]] | None = None
    kind_at: Callable[[np.ndarray], str] | None = None
    offset: Callable[[float], np.ndarray] | None = None


class Embedding(NamedTuple):
    """A solution as unknowns of a larger problem, in which it is a branch point.

    Attributes
    ----------
    problem : Problem
        The larger problem, such as that of cycles of twice the length.
    u : ndarray, shape (N,)
        The solution, as unknowns of the larger problem.
    tangent : ndarray, shape (N + 1,)
        Tangent of the known branch, in the larger problem.
    kind : str
        Kind of the special point.
    """

    problem: Problem
    u: np.ndarray
    tangent: np.ndarray
    kind: str


@dataclass(frozen=True)
class Seed:
    """A solution from which a branch is traced.

    Parameters
    ----------
    problem : Problem
    u : ndarray, shape (N,)
    p : float
    tangent : ndarray, shape (N + 1,), optional
        Direction in which the branch leaves; None: the branch is traced both ways.
    kind : str
        "start", "border", "root", or the kind of the special point.
    note : str
        Sentence shown in the graph.
    persistence : bool
        At a border: True if the branch continues with another word on the other side, False for a nonsmooth fold.
    """

    problem: Problem
    u: np.ndarray
    p: float
    tangent: np.ndarray | None = None
    kind: str = "start"
    note: str = ""
    persistence: bool = True


class BorderPoint(Protocol):
    """A special point at a border, as problems read it: unknowns, parameter value, outward tangent, index of the vanishing margin."""

    @property
    def u(self) -> np.ndarray: ...
    @property
    def value(self) -> float: ...
    @property
    def tangent(self) -> np.ndarray: ...
    @property
    def margin_index(self) -> int | None: ...


def margin_of(point: BorderPoint) -> int:
    """Index of the margin that vanishes at a border.

    Raises
    ------
    ValueError
        If the point lies at no border.
    """
    if point.margin_index is None:
        raise ValueError("no margin vanishes at this point: it lies at no border")
    return int(point.margin_index)


class Equations(Protocol):
    """F(u, p) = 0, its parameters, scales and accuracy (items 1 to 3, 7, 8 and 10 of the contract)."""

    @property
    def dimension(self) -> int: ...
    @property
    def parameter(self) -> str: ...
    @property
    def parameters(self) -> Mapping[str, float]: ...
    @property
    def kernels(self) -> KernelFunctions: ...
    @property
    def data(self) -> object: ...
    def workspace(self) -> object: ...
    def against(self, parameter: str, values: Mapping[str, float] | None = None) -> Problem: ...
    def check_value(self, name: str, value: float) -> None: ...
    @property
    def scales(self) -> Scales | None: ...
    @property
    def scales_learned(self) -> bool: ...
    @property
    def noise(self) -> float: ...
    def scale_within(self, within: tuple[float, float]) -> np.ndarray: ...
    def amplitude(self, direction: np.ndarray) -> float: ...
    def uncertainty(self) -> float: ...
    def check(self, u: np.ndarray, p: float) -> str | None: ...
    def explain_end(self, u: np.ndarray, p: float, tangent: np.ndarray, evaluable: bool) -> str: ...


class Spectrum(Protocol):
    """Multipliers, their kind, and the problems of the branches that leave at a critical one (items 4, 6 and 9)."""

    @property
    def spectrum(self) -> str: ...
    @property
    def detection(self) -> str: ...
    @property
    def flip_kind(self) -> str: ...
    @property
    def movable(self) -> bool: ...
    @property
    def n_multipliers(self) -> int: ...
    def to_multipliers(self, spectrum: np.ndarray) -> np.ndarray: ...
    def offspring(
        self, kind: str, u: np.ndarray, p: float, tangent: np.ndarray, multiplier: complex
    ) -> Sequence[Any]: ...  # embeddings


class Symmetries(Protocol):
    """Symmetries, and the identity of solutions (item 5)."""

    @property
    def period_shift(self) -> np.ndarray | None: ...
    @property
    def symmetries(self) -> Sequence[Any]: ...  # objects with the attributes of Symmetry
    def canonical(self, u: np.ndarray, p: float) -> tuple[Hashable, np.ndarray]: ...
    def same_motion(self, u: np.ndarray, p: float, other: Problem, v: np.ndarray) -> bool | None: ...
    def root(self, u: np.ndarray, p: float) -> tuple[Problem, np.ndarray] | None: ...


class Borders(Protocol):
    """Margins, and the solutions beyond the borders at which they vanish (items 2 and 6)."""

    @property
    def n_margins(self) -> int: ...
    def margin_kind(self, j: int) -> str: ...
    def beyond(self, point: BorderPoint) -> Sequence[Any]: ...  # seeds
    def dead_end(self, point: BorderPoint) -> str: ...


class Description(Protocol):
    """Measures, description and simulation of solutions (item 11)."""

    @property
    def measure_names(self) -> Sequence[str]: ...
    @property
    def default_measure(self) -> str: ...
    @property
    def angles(self) -> Sequence[str]: ...
    def measures(self, names: Sequence[str], u: np.ndarray, p: np.ndarray) -> dict[str, np.ndarray]: ...
    def at_each_point(self, name: str, u: np.ndarray, p: np.ndarray) -> np.ndarray | None: ...
    def describe(self) -> dict[str, Any]: ...
    def orbit(self, u: np.ndarray, p: float) -> object: ...
    def replay(self, u: np.ndarray, p: float) -> float | None: ...
    def simulated_attractors(self, p: float) -> list[dict[str, Any]]: ...


class Problem(Equations, Spectrum, Symmetries, Borders, Description, Protocol):
    """The whole protocol; the contract is at the top of this module."""


PARTS = (Equations, Spectrum, Symmetries, Borders, Description)
MEMBERS = tuple(name for part in PARTS for name in vars(part) if not name.startswith("_"))


@dataclass(frozen=True)
class Solution:
    """Parameter value and unknowns of a solution: result of ``orbit`` for problems without an orbit class of their own."""

    parameter: str
    value: float
    u: np.ndarray = field(repr=False)


class ProblemDefaults:
    """Defaults of a problem without symmetries, margins, larger problems and further parameters, and with unknowns of order 1.

    A problem of your own derives from it and adds its equations. The contract of each member is in :mod:`contvines.problems.protocol`.
    """

    parameter = "p"
    spectrum = "none"
    detection = ""
    flip_kind = "period-doubling"
    movable = False
    n_multipliers = 0
    n_margins = 0
    dimension = 0
    period_shift: np.ndarray | None = None
    symmetries: tuple[Symmetry, ...] = ()
    scales: Scales | None = None
    scales_learned = False
    noise = 0.0
    default_measure = ""
    angles: tuple[str, ...] = ()

    @property
    def parameters(self) -> Mapping[str, float]:
        return {}

    def against(self, parameter: str, values: Mapping[str, float] | None = None) -> Problem:
        raise ValueError(
            f"{parameter} cannot vary: a {type(self).__name__} has the one parameter {self.parameter!r}"
        )

    def check_value(self, name: str, value: float) -> None:
        """Accept every value."""

    def scale_within(self, within: tuple[float, float]) -> np.ndarray:
        return np.ones(self.dimension + 1)

    def amplitude(self, direction: np.ndarray) -> float:
        return float(np.linalg.norm(direction[: self.dimension]))

    def margin_kind(self, j: int) -> str:
        raise IndexError(f"this problem has no margins, so there is no margin {j}")

    def to_multipliers(self, spectrum: np.ndarray) -> np.ndarray:
        return np.asarray(spectrum, dtype=complex)

    def offspring(
        self, kind: str, u: np.ndarray, p: float, tangent: np.ndarray, multiplier: complex
    ) -> list[Embedding]:
        return []

    def beyond(self, point: BorderPoint) -> list[Seed]:
        return []

    def dead_end(self, point: BorderPoint) -> str:
        return ""

    def canonical(self, u: np.ndarray, p: float) -> tuple[Hashable, np.ndarray]:
        return (type(self).__name__, self.dimension), np.asarray(u, dtype=float)

    def same_motion(self, u: np.ndarray, p: float, other: Problem, v: np.ndarray) -> bool | None:
        return None

    def root(self, u: np.ndarray, p: float) -> tuple[Problem, np.ndarray] | None:
        return None

    @property
    def measure_names(self) -> tuple[str, ...]:
        return ("norm", *(f"u{i}" for i in range(self.dimension)))

    def measures(self, names: Sequence[str], u: np.ndarray, p: np.ndarray) -> dict[str, np.ndarray]:
        u = np.atleast_2d(u)
        result = {}
        for name in names:
            if name == "norm":
                result[name] = np.linalg.norm(u, axis=1)
            elif name in self.measure_names:
                result[name] = u[:, int(name[1:])].copy()
            else:
                raise KeyError(f"there is no measure {name!r}; choose from {', '.join(self.measure_names)}")
        return result

    def at_each_point(self, name: str, u: np.ndarray, p: np.ndarray) -> np.ndarray | None:
        return None

    def describe(self) -> dict[str, Any]:
        return {"name": type(self).__name__, "factory": None}

    def orbit(self, u: np.ndarray, p: float) -> object:
        return Solution(self.parameter, float(p), np.array(u))

    def explain_end(self, u: np.ndarray, p: float, tangent: np.ndarray, evaluable: bool) -> str:
        return ""

    def uncertainty(self) -> float:
        return 0.0

    def check(self, u: np.ndarray, p: float) -> str | None:
        return None

    def replay(self, u: np.ndarray, p: float) -> float | None:
        return None

    def simulated_attractors(self, p: float) -> list[dict[str, Any]]:
        return []
