"""Users' kinds in two parameters: loci of their points, whose condition is followed as the margin of a border is, and their points on loci."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from ..bifurcation.kind import Kind
from ..bifurcation.kinds import BY_NAME
from ..branches.special_point import SpecialPoint
from ..problems.protocol import Kernels
from .plane import Plane

if TYPE_CHECKING:
    from ..problems.protocol import Problem


class PointOfLocus:
    """What a kind's functions see of a point along a locus; as :class:`~contvines.bifurcation.point_on_branch.PointOnBranch`, without a tangent.

    ``problem`` is that of the branches, ``value`` the first parameter; ``parameters`` hold both that vary.
    """

    def __init__(
        self,
        problem: Problem,
        parameters: Mapping[str, float],
        place: tuple[np.ndarray, float],
        row: np.ndarray,
        jacobian: Callable[[], np.ndarray],
        measures: Callable[..., dict[str, np.ndarray]],
    ) -> None:
        self.problem, self.parameters = problem, dict(parameters)
        self.u, self.value = np.array(place[0]), float(place[1])
        self._row, self._jacobian, self._measures = row, jacobian, measures

    @cached_property
    def jacobian(self) -> np.ndarray:
        """F_u of the problem's equations, shape (N, N)."""
        return np.array(self._jacobian())

    @cached_property
    def multipliers(self) -> np.ndarray:
        """Of the full period (eigenvalues for flows), complex."""
        pairs = np.array(self._row[: 2 * int(self.problem.n_multipliers)])
        return np.asarray(self.problem.to_multipliers(pairs.view(complex)), dtype=complex)

    @property
    def margins(self) -> np.ndarray:
        """Distances from borders."""
        return np.array(self._row[2 * int(self.problem.n_multipliers) :])

    def measure(self, name: str) -> float:
        """A measure of the solution by its name."""
        return float(self._measures((name,), self.u[None, :], np.array([self.value]))[name][0])


def of_plane(plane: Plane) -> PointOfLocus:
    """The point at which a plane is."""
    u, p, q = plane.place
    problem, line = plane.locus.at(q), plane.first

    def jacobian() -> np.ndarray:
        if line.kernels.matrix is None:
            raise ValueError(f"a {type(line.problem).__name__} does not tell its Jacobian")
        line.at(u, p)
        return line.kernels.matrix(line.data, line.work)

    parameters = {**problem.parameters, plane.locus.inner: p, plane.locus.over: q}
    return PointOfLocus(problem, parameters, (u, p), plane.row, jacobian, problem.measures)


def tested(kind: Kind, plane: Plane) -> float:
    """A user's test at the point at which a plane is; NaN where it cannot be computed.

    Raises
    ------
    ValueError
        If the test fails for a reason of its own.
    """
    assert kind.test is not None
    point = of_plane(plane)
    try:
        return float(kind.test(point))
    except (ArithmeticError, np.linalg.LinAlgError):
        return float("nan")
    except Exception as error:
        _, p, q = plane.place
        place = f"{plane.locus.inner} = {p:.10g}, {plane.locus.over} = {q:.10g}"
        raise ValueError(
            f"kind {kind.name}: its test fails at {place}: {type(error).__name__}: {error}"
        ) from error


class WithCondition:
    """A problem with the condition of a kind as its last margin; all else is the problem's."""

    def __init__(self, problem: Problem, kind: Kind) -> None:
        self.plain, self.own_kind = problem, kind
        assert isinstance(problem.kernels, Kernels)
        self.kernels = replace(problem.kernels, inspect=self._inspect)

    def __getattr__(self, name: str) -> Any:
        if name in ("plain", "own_kind"):
            raise AttributeError(name)
        return getattr(self.plain, name)

    @property
    def n_margins(self) -> int:
        return int(self.plain.n_margins) + 1

    def margin_kind(self, j: int) -> str:
        """Of the last one the name of the kind."""
        return self.own_kind.name if j == int(self.plain.n_margins) else self.plain.margin_kind(j)

    def smooth_margin(self, j: int) -> int:
        return j if j == int(self.plain.n_margins) else self.plain.smooth_margin(j)

    def against(self, parameter: str, values: Mapping[str, float] | None = None) -> WithCondition:
        return WithCondition(self.plain.against(parameter, values), self.own_kind)

    def describe(self) -> dict[str, Any]:
        """Without a factory: a file does not know the condition."""
        return {**self.plain.describe(), "factory": None}

    def _inspect(self, data: Problem, u: np.ndarray, p: float, work: object, row: np.ndarray) -> None:
        self.plain.kernels.inspect(data, u, p, work, row[:-1])
        condition = self.own_kind.locus
        assert callable(condition)
        try:
            row[-1] = float(condition(self._point(data, u, p, work, row[:-1])))
        except (ArithmeticError, np.linalg.LinAlgError):
            row[-1] = np.nan

    def _point(self, data: Problem, u: np.ndarray, p: float, work: object, row: np.ndarray) -> PointOfLocus:
        parameters = {**data.parameters, data.parameter: float(p)}
        return PointOfLocus(
            self.plain, parameters, (u, p), row, lambda: self._matrix(data, work), data.measures
        )

    def _matrix(self, data: object, work: object) -> np.ndarray:
        assert self.kernels.matrix is not None
        return self.kernels.matrix(data, work)


def of_own_kind(point: SpecialPoint) -> bool:
    """Whether a special point is of a kind of the user's own; a problem's own borders are not."""
    return point.own_kind is not None or (point.kind not in BY_NAME and point.margin_index is None)


def followed(point: SpecialPoint) -> bool:
    """Whether a chart follows a special point: all but ends, and zeros of users' tests."""
    return point.kind not in ("end", "user") and not of_own_kind(point)


def with_condition(problem: Problem, kind: Kind | None, label: str) -> WithCondition:
    """The problem in which points of a user's kind are borders.

    Raises
    ------
    ValueError
        If the kind brings no condition, or the problem is compiled.
    """
    if kind is None or not callable(kind.locus):
        raise ValueError(
            f"{label}: its kind has no condition to follow; Kind(..., locus=lambda point: ...) gives it one, often its test"
        )
    if not isinstance(problem.kernels, Kernels):
        raise ValueError(f"{label}: kinds of your own are followed for problems in Python only")
    return WithCondition(problem, kind)
