"""What contvines must know about a problem: the protocol, and nothing else.

The contract, in words:

1. A problem is F(u, p) = 0 with N unknowns u (a flat float64 array) and as many equations, and one parameter p.
2. ``kernels`` holds three functions, plain Python or a table of C functions (`contvines.core.table`), with the same signatures:

   ``linearise(data, u, p, work) -> float``
       evaluates F, dF/du and dF/dp into ``work`` and returns the largest absolute residual (inf: not evaluable).
       ``work[0]`` is F itself (any C-contiguous shape with N entries); it may be overwritten between the calls.
   ``bordered(data, work, border, n, step, tangent) -> float``
       solves ``[[F_u, F_p], [border]] x = rhs`` with one elimination for ``rhs = (-F, n)`` (into step) and
       ``rhs = (0, 1)`` (into tangent); F is taken from ``work[0]``. Returns the sign of the determinant; 0 means
       singular, and the solution is then that of a matrix with a tiny pivot.
   ``inspect(data, u, p, work, row) -> None``
       from the linearisation in ``work``: ``row[:2 m]`` are the m multipliers (or eigenvalues) as re, im pairs,
       ``row[2 m:]`` are the margins. A margin is positive on a real solution, +inf where it does not apply.

   Loci against a second parameter need five more, optional, entries:

   ``assign(data, other, value) -> None``
       gives the parameter that varies in the problem of ``other`` (from ``against``) a value in ``data``, in place.
   ``column``
       place of F_p in ``work`` (as work[0] that of F; any C-contiguous shape with N entries); it may be overwritten
       between the calls, and ``bordered`` then takes that column.
   ``flip(data, work, sign) -> None``
       maps only: turns F_u in ``work`` into what acts on perturbations that change sign over the period (sign = -1), and
       back (sign = 1).
   ``transpose(data, work, column, other) -> None``
       writes the transposed F_u, with ``column`` in the place of F_p, into another workspace.
   ``matrix(data, work) -> ndarray``
       F_u as it stands in ``work``, shape (N, N), for normal forms at single points.
3. ``data`` and ``workspace()`` are the opaque first and last arguments of the kernels.
4. ``spectrum`` says how the raw spectrum is read: "map" (unit circle), "flow" (imaginary axis), "none". A problem without one
   may still have real eigenvalues watched for branch points: ``detection`` is then "real".
   ``flip_kind`` says what a raw multiplier -1 means: "period-doubling" or "symmetry-breaking".
5. Solutions may be equal up to ``period_shift`` and ``symmetries``; ``canonical(u, p)`` returns a hashable key and a
   vector which are the same for solutions that are one and the same thing; the vector is counted as the unknowns are or, where
   it has more entries than these, so that all are of order one. ``root(u, p)`` returns the smaller problem
   and its unknowns for a solution that only repeats a shorter one (a cycle run through twice), else None.
   ``same_motion(u, p, other, v)`` tells whether a solution of another problem is this one where ``canonical`` cannot (None:
   neither can it).
6. ``offspring`` hands out the larger problem in which a special point is a branch point, ``beyond`` the solutions
   on the other side of a border; where there are none, ``dead_end`` says why.
7. ``parameters`` are all parameters by name, and ``against`` hands out the problem against another one. ``check_value``
   refuses a value that a parameter cannot have, with a ValueError.
8. ``scale_within`` returns typical sizes of unknowns and parameter, ``amplitude`` the length of a direction of the unknowns
   as normal forms measure it. Equations without a scale of their own (``scales``, learned or given) have residuals of order 1.
9. ``movable`` solutions are not isolated: they may be shifted as a whole.
10. ``uncertainty`` is the relative accuracy of the equations; ``check`` a sentence on derivatives that disagree with them;
    ``explain_end`` one on why Newton's method fails at the end of a branch. ``at_each_point`` has a measure at each point of a
    cycle, shape (m, n), or None.

Five small protocols, `Equations`, `Spectrum`, `Symmetries`, `Borders` and `Description`, make it up; a function asks for the one it needs.
Satisfied by structure: nothing has to be imported or inherited; :class:`ProblemDefaults` answers what a problem has nothing to
say on. What only some problems can is in ``contvines/problems/abilities.py``.
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
    """What has arrays by their places."""

    def __getitem__(self, place: int, /) -> object: ...


def array_of(work: object, place: int = 0) -> np.ndarray:
    """An array of a workspace: F is the first, F_p that at the kernels' ``column``."""
    found = cast(Places, work)[place]  # unchecked, as it is called at every point
    assert isinstance(found, np.ndarray)
    return found


@dataclass(frozen=True)
class Kernels:
    """The functions of a problem, in Python; the contract is at the top of :mod:`contvines.problems.protocol`.

    Parameters
    ----------
    linearise, bordered, inspect : callable
    compiled : bool
        False.
    assign, flip, transpose, matrix : callable, optional
    column : int
        For loci against a second parameter.
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
    """An image of u that solves the same problem.

    Parameters
    ----------
    kind : str
        The bifurcation at which branches with less symmetry leave the fixed space: "symmetry-breaking" for a mirror,
        "period-doubling" for the shift of a doubled cycle by its half.
    apply : callable
        u -> the image of u, both of shape (N,).
    root : callable, optional
        u -> (problem, u) of the smaller problem for a solution that lies in the fixed space.
    kind_at : callable, optional
        u -> the kind at a solution in the fixed space, where it is not the same everywhere.
    offset : callable, optional
        p -> what is added to `apply(u)`, shape (N,), where the image depends on the parameter.
    """

    kind: str
    apply: Callable[[np.ndarray], np.ndarray]
    root: Callable[[np.ndarray], tuple[Problem, np.ndarray]] | None = None
    kind_at: Callable[[np.ndarray], str] | None = None
    offset: Callable[[float], np.ndarray] | None = None


class Embedding(NamedTuple):
    """A solution seen in a larger problem, in which it is a branch point.

    Attributes
    ----------
    problem : Problem
        The larger one, such as that of cycles of twice the length.
    u : ndarray, shape (N,)
        The solution, in its unknowns.
    tangent : ndarray, shape (N + 1,)
        Of the known branch there.
    kind : str
        Of the special point.
    """

    problem: Problem
    u: np.ndarray
    tangent: np.ndarray
    kind: str


@dataclass(frozen=True)
class Seed:
    """A solution from which a branch can be traced.

    Parameters
    ----------
    problem : Problem
    u : ndarray, shape (N,)
    p : float
    tangent : ndarray, shape (N + 1,), optional
        Direction in which the branch leaves; None: both ways.
    kind : str
        "start", "border", "root", or the kind of the special point.
    note : str
        A sentence for the graph.
    persistence : bool
        At a border: the branch simply goes on with another word (else: a nonsmooth fold).
    """

    problem: Problem
    u: np.ndarray
    p: float
    tangent: np.ndarray | None = None
    kind: str = "start"
    note: str = ""
    persistence: bool = True


class BorderPoint(Protocol):
    """What a problem is given of a special point at a border."""

    @property
    def u(self) -> np.ndarray: ...
    @property
    def value(self) -> float: ...
    @property
    def tangent(self) -> np.ndarray: ...
    @property
    def margin_index(self) -> int | None: ...


def margin_of(point: BorderPoint) -> int:
    """Number of the margin that vanishes at a border.

    Raises
    ------
    ValueError
        If the point lies at no border.
    """
    if point.margin_index is None:
        raise ValueError("no margin vanishes at this point: it lies at no border")
    return int(point.margin_index)


class Equations(Protocol):
    """F(u, p) = 0, its parameters, and how large its numbers are (1 to 3, 7, 8)."""

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
    """Multipliers, and what it means that one of them is critical (4, 9)."""

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
    """Which solutions are one and the same, and which are only part of another one (5)."""

    @property
    def period_shift(self) -> np.ndarray | None: ...
    @property
    def symmetries(self) -> Sequence[Any]: ...  # with what a Symmetry has
    def canonical(self, u: np.ndarray, p: float) -> tuple[Hashable, np.ndarray]: ...
    def same_motion(self, u: np.ndarray, p: float, other: Problem, v: np.ndarray) -> bool | None: ...
    def root(self, u: np.ndarray, p: float) -> tuple[Problem, np.ndarray] | None: ...


class Borders(Protocol):
    """Margins, and the solutions on the other side where one of them vanishes (6, 9)."""

    @property
    def n_margins(self) -> int: ...
    def margin_kind(self, j: int) -> str: ...
    def beyond(self, point: BorderPoint) -> Sequence[Any]: ...  # seeds
    def dead_end(self, point: BorderPoint) -> str: ...


class Description(Protocol):
    """What people see of a solution, and what simulation says of it (10)."""

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
    """All that may be asked of a problem; the numbers are those of the contract at the top of this module."""


PARTS = (Equations, Spectrum, Symmetries, Borders, Description)
MEMBERS = tuple(name for part in PARTS for name in vars(part) if not name.startswith("_"))


@dataclass(frozen=True)
class Solution:
    """What ``orbit`` returns for problems that have nothing better: the bare numbers."""

    parameter: str
    value: float
    u: np.ndarray = field(repr=False)


class ProblemDefaults:
    """Default answers of a problem without symmetries, margins, larger problems and further parameters, and with unknowns of order 1.

    A problem of your own derives from it and adds its equations. What each method is asked is said in :mod:`contvines.problems.protocol`.
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
        """Every value will do."""

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
