"""Kind: a kind of special point, built-in or user-defined: its name and marker, and how its points are found, verified, classified and followed.

The functions of a user-defined kind receive a `Point`; a return value of a wrong type raises a ValueError that names the kind and the function.
"""

from __future__ import annotations

import math
import numbers
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

import numpy as np

from ..continuation.layout import SORTS, aim_at_multiplier
from ..continuation.settings import hinted

if TYPE_CHECKING:
    from ..continuation.engine import Engine, Solved
    from ..continuation.layout import Aim, Chunk
    from ..problems.protocol import Problem
    from .locate import Located, Segment


@dataclass(frozen=True, eq=False)
class Test:
    """A test function that changes its sign on a segment.

    Attributes
    ----------
    function : Aim or callable
        Value of the test function at a solved point.
    index : int
        Rank of the multiplier among those of its sort, or index of the margin.
    jump : float
        The zero is rejected as a jump if the function changes by more than this over a small part of the segment.
    """

    __test__ = False  # pytest must not collect this class
    function: Aim | Callable[[Solved], float]
    index: int = 0
    jump: float = float("inf")


JUMP = 0.05  # change of a multiplier's logarithm over a small part of a segment from which it counts as a jump: another multiplier has taken its rank


def passing(segment: Segment, sort: str) -> list[Test]:
    """Return one test for each multiplier of a sort ("plus", "minus", "pair") that is outside the unit circle at one end only."""
    engine, place = segment.engine, tuple(SORTS).index(sort)
    one, other = segment.counts[0][place], segment.counts[1][place]
    return [
        Test(aim_at_multiplier(engine.m, engine.detection, sort, k), k, JUMP)
        for k in range(min(one, other) + 1, max(one, other) + 1)
    ]


class Classified(NamedTuple):
    """Normal form of a special point: criticality, coefficient (a number, or a function that computes it when needed), and remarks."""

    criticality: str | None = None
    coefficient: float | Callable[[], float | None] | None = None
    remarks: tuple[str, ...] = ()


Sides = tuple[str | None, float | None]
"""Result of `classify` of a user-defined kind, instead of `Classified`: criticality and coefficient."""
SIDES = ("supercritical", "subcritical", None)
NAME = re.compile(r"[a-z][a-z0-9-]*")
LABEL = re.compile(r"[A-Z][A-Z0-9]*")
MARKERS = tuple("*os^vDpdhHPXx+|<>8.,1234_")
"""Markers as matplotlib names them."""


@hinted
@dataclass(frozen=True, eq=False)
class Kind:
    """A kind of special point.

    The test function is evaluated at every point of a branch. If it changes its sign between two points, or the parabola through
    three values crosses zero, a safeguarded secant method locates the zero on the branch; it is then verified, labelled and classified.

    Parameters
    ----------
    name : str
        Name in files, JSON and :meth:`contvines.Graph.of_kind`: small letters, digits and hyphens.
    label : str
        Prefix of the labels: capital letters, as ``LP`` of LP1, LP2 ...
    test : callable, optional
        point -> float: zero at the special point, with a change of sign and a nonzero slope. The point is a
        ``PointOnBranch``: ``point.u``, ``point.value``, ``point.parameters``,
        ``point.multipliers``, ``point.margins``, ``point.jacobian``, ``point.tangent``, ``point.measure(name)``.
    text : str
        Name shown in tables and legends; by default the name without hyphens.
    marker : str
        Marker in pictures, as matplotlib names it: one of ``* o s ^ v D p d h H P X x + | < > 8 . , 1 2 3 4 _``.
    filled : bool
        Whether the marker is filled.
    verify : callable, optional
        point -> True or False: whether a located zero is of this kind, for example if the sign of another number decides.
    classify : callable, optional
        point -> (criticality, coefficient): "supercritical", "subcritical" or None, and a number or None.
    locus : callable, optional
        point -> float: the condition that ``contvines.locus`` adds to the equations, often the test itself. Its point has no tangent.
    ends : bool
        Whether branches end at these points.
    border, tests, find, leaves, nothing, without
        Used by built-in kinds only: searches that one test function cannot express, and sentences for points that no branch leaves.

    Raises
    ------
    ValueError
        If the name, the label or the marker is invalid, or ``test``, ``verify``, ``classify`` or ``locus`` is not callable. Also during
        the computation of a diagram, if one of these functions fails or returns a value of a wrong type. A test may return NaN at points where it
        is not defined.
    """

    name: str
    label: str
    test: Callable[[Point], float] | None = None
    text: str = ""
    marker: str = "*"
    filled: bool = True
    verify: Callable[[Point], bool] | None = None
    classify: Callable[[PointOnBranch], Classified | Sides] | None = None
    locus: Callable[[Point], float] | str | None = None
    ends: bool = False
    # of built-in kinds only
    border: bool = False  # a margin vanishes at these points, and branches end there
    tests: Callable[[Segment], list[Test]] | None = None  # the test functions that change sign on a segment
    find: Callable[[Segment, Sequence[Located]], list[Located]] | None = None  # own search, instead of tests
    leaves: str = (
        ""  # "branch", "doubled", "cycles", "circle" or "beyond": see contvines.graph.schedule_branches
    )
    nothing: str = ""  # sentence for the user: no branch leaves points of this kind
    without: str = ""  # sentence for the user: a branch leaves, but the problem has no equations for it

    def __post_init__(self) -> None:
        if not (isinstance(self.name, str) and NAME.fullmatch(self.name)):
            raise ValueError(
                f"kind {self.name!r}: a name has small letters, digits and hyphens, for example 'neutral-saddle'"
            )
        if not (isinstance(self.label, str) and LABEL.fullmatch(self.label)):
            raise ValueError(
                f"kind {self.name}: label = {self.label!r}; expected capital letters, for example 'NSD'"
            )
        for role in ("test", "verify", "classify", *(["locus"] if self.test is not None else [])):
            given = getattr(self, role)
            if given is not None and not callable(given):
                raise ValueError(f"kind {self.name}: {role} = {given!r} must be a function of a point")
        if self.marker not in MARKERS:
            raise ValueError(
                f"kind {self.name}: marker = {self.marker!r}; expected one of matplotlib's: {' '.join(MARKERS)}"
            )
        if not self.text:
            object.__setattr__(self, "text", self.name.replace("-", " "))

    def look(self) -> dict[str, str | bool]:
        """Return name, label, text and marker as JSON scalars; files store these of a user-defined kind."""
        return {
            "name": self.name,
            "label": self.label,
            "text": self.text,
            "marker": self.marker,
            "filled": self.filled,
        }


# ------------------------------------------------------------------ argument of the functions of a kind
class Point(Protocol):
    """Argument of the functions of a kind: a point of a branch or of a locus; see `PointOnBranch`."""

    @property
    def u(self) -> np.ndarray: ...
    @property
    def value(self) -> float: ...
    @property
    def problem(self) -> Problem: ...
    @property
    def parameters(self) -> dict[str, float]: ...
    @property
    def place(self) -> dict[str, float]: ...
    @cached_property
    def multipliers(self) -> np.ndarray: ...
    @property
    def margins(self) -> np.ndarray: ...
    @cached_property
    def jacobian(self) -> np.ndarray: ...
    def measure(self, name: str) -> float: ...


class PointOnBranch:
    """A point of a branch, as the functions of a kind receive it; expensive properties are computed at first use.

    Attributes
    ----------
    u : ndarray, shape (N,)
        Unknowns.
    value : float
        Parameter value.
    tangent : ndarray, shape (N + 1,)
        Unit tangent of the branch; the parameter's component is last.
    problem : Problem
    """

    def __init__(self, engine: Engine, solved: Solved, segment: Segment | None = None) -> None:
        self.engine, self.solved, self.segment = engine, solved, segment
        self.problem, self.u, self.value, self.tangent = engine.problem, solved.u, solved.p, solved.tangent

    @property
    def place(self) -> dict[str, float]:
        """The varying parameter: name -> value."""
        return {self.problem.parameter: self.value}

    @property
    def parameters(self) -> dict[str, float]:
        """All parameters: name -> value, the varying one included."""
        return {**self.problem.parameters, **self.place}

    @cached_property
    def multipliers(self) -> np.ndarray:
        """Complex multipliers of the full period (eigenvalues for flows)."""
        return self.engine.multipliers(self.solved.row)

    @property
    def margins(self) -> np.ndarray:
        """Margins: distances from borders, all positive on a real solution; +inf for a margin that does not apply."""
        return self.engine.margins(self.solved.row)

    @cached_property
    def jacobian(self) -> np.ndarray:
        """F_u of the problem's equations, shape (N, N)."""
        engine, kernels = self.engine, self.problem.kernels
        engine.residual(self.u, self.value)
        if kernels.matrix is None:
            raise ValueError(f"a {type(self.problem).__name__} provides no Jacobian matrix")
        return np.array(kernels.matrix(self.problem.data, engine.work))

    def measure(self, name: str) -> float:
        """Return a measure of the solution by its name."""
        if name == self.problem.parameter:
            return self.value
        return float(self.problem.measures((name,), self.u[None, :], np.array([self.value]))[name][0])


# ------------------------------------------------------------------ checked results of the functions of a kind
def number_of(kind: Kind, role: str, point: Point) -> float:
    """Return the value of a kind's "test" or condition ("locus") at a point; NaN if its arithmetic fails.

    Raises
    ------
    ValueError
        If the function raises another error, or does not return a real number.
    """
    try:
        found = _answer(kind, role, point)
    except (ArithmeticError, np.linalg.LinAlgError):
        return math.nan
    number = found.item() if isinstance(found, np.ndarray | np.generic) and np.size(found) == 1 else found
    if isinstance(number, bool) or not isinstance(number, numbers.Real):
        raise _wrong_type(kind, role, found, point, "a real number")
    return float(number)


def verified(kind: Kind, point: Point) -> bool:
    """Whether a located zero is of the kind: the result of its `verify`, True without one.

    Raises
    ------
    ValueError
        If `verify` of a user-defined kind fails, or returns neither True nor False.
    """
    if kind.verify is None:
        return True
    if kind.test is None:
        return kind.verify(point)
    found = _answer(kind, "verify", point)
    if not isinstance(found, bool | np.bool_):
        raise _wrong_type(kind, "verify", found, point, "True or False")
    return bool(found)


def classified(kind: Kind, point: PointOnBranch) -> Classified:
    """Return the normal form of a special point: the result of its kind's `classify`, empty without one.

    Raises
    ------
    ValueError
        If `classify` of a user-defined kind fails, or does not return a pair (criticality, coefficient).
    """
    if kind.classify is None:
        return Classified()
    found = _answer(kind, "classify", point) if kind.test else kind.classify(point)
    if isinstance(found, Classified):
        return found
    try:
        side, coefficient = found
        assert side in SIDES and (coefficient is None or isinstance(coefficient, numbers.Real))
    except (AssertionError, TypeError, ValueError):
        wanted = '(criticality, coefficient): "supercritical", "subcritical" or None, and a number or None'
        raise _wrong_type(kind, "classify", found, point, wanted) from None
    return Classified(side, None if coefficient is None else float(coefficient))


def _answer(kind: Kind, role: str, point: Point) -> Any:
    """Call one of a kind's functions at a point; errors but those of arithmetic become a ValueError that names kind, function and place."""
    try:
        return getattr(kind, role)(point)
    except Exception as error:
        if role in ("test", "locus") and isinstance(error, ArithmeticError | np.linalg.LinAlgError):
            raise
        reason = f"{type(error).__name__}: {error}"
        raise ValueError(f"kind {kind.name}: its {role} fails at {_place_text(point)}: {reason}") from error


def _wrong_type(kind: Kind, role: str, found: object, point: Point, wanted: str) -> ValueError:
    return ValueError(
        f"kind {kind.name}: its {role} returns {found!r} at {_place_text(point)}; expected {wanted}"
    )


def _place_text(point: Point) -> str:
    return ", ".join(f"{name} = {value:.10g}" for name, value in point.place.items())


# ------------------------------------------------------------------ user-defined tests along a branch
UserFunction = Callable[[np.ndarray, float], float] | tuple[str, float]
"""A function of a solution (u, p), or a pair (measure, value): the test is the measure minus this value."""


class Own(NamedTuple):
    """A user-defined test along a branch.

    Attributes
    ----------
    kind : Kind
        Kind of its zeros.
    name : str
        Name of the user function; empty for the test of a kind.
    at : callable
        Its value at one point.
    many : callable, optional
        Its values at many points: unknowns, shape (n, N), and parameter values, shape (n,), -> values, shape (n,).
    """

    kind: Kind
    name: str
    at: Callable[[Solved], float]
    many: Callable[[np.ndarray, np.ndarray], np.ndarray] | None = None

    def values(self, chunk: Chunk) -> np.ndarray:
        """Return the test's values at all points of a chunk, shape (n,)."""
        if self.many is None:
            return np.array([self.at(chunk.solved(i)) for i in range(len(chunk))])
        return np.asarray(self.many(chunk.points, chunk.values), dtype=float)


def own_tests(
    engine: Engine,
    kinds: Iterable[Kind],
    functions: Mapping[str, UserFunction],
    stops: Iterable[str],
    user: Kind,
) -> list[Own]:
    """Return the user-defined tests of an engine's problem.

    Parameters
    ----------
    engine : Engine
    kinds : iterable of Kind
        Each kind with a `test` gives one.
    functions : mapping of str to UserFunction
        User functions by name.
    stops : iterable of str
        Names of the functions at whose zeros branches end.
    user : Kind
        Kind of the zeros of the functions.
    """

    def of_kind(kind: Kind, point: Solved) -> float:
        return number_of(kind, "test", PointOnBranch(engine, point))

    def of_function(many: Callable[[np.ndarray, np.ndarray], np.ndarray], point: Solved) -> float:
        return float(many(point.u[None, :], np.array([point.p]))[0])

    found = [Own(kind, "", partial(of_kind, kind)) for kind in kinds if kind.test is not None]
    for name, function in functions.items():
        many = _vectorised(engine.problem, function)
        found.append(Own(replace(user, ends=name in stops), name, partial(of_function, many), many))
    return found


def _vectorised(problem: Problem, function: UserFunction) -> Callable[[np.ndarray, np.ndarray], np.ndarray]:
    """Return the user function for many points at once: unknowns, shape (n, N), and parameter values, shape (n,), -> values, shape (n,)."""
    if callable(function):
        return lambda points, values: np.array([float(function(u, float(p))) for u, p in zip(points, values)])
    try:
        measure, value = function[0], float(function[1])
    except (TypeError, ValueError, IndexError):
        raise ValueError(
            f"user function {function!r} must be a callable (u, p) -> float or a pair (measure, value)"
        ) from None
    if measure == problem.parameter:
        return lambda points, values: values - value
    return lambda points, values: problem.measures((measure,), points, values)[measure] - value
