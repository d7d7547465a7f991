"""Loci of users' kinds: the condition of the kind becomes one more margin of the problem, and is followed as the margin of a border is."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np

from ..bifurcation.kind import Kind
from ..bifurcation.kinds import BY_NAME
from ..branches.special_point import SpecialPoint


class PointOfLocus:
    """What a kind's condition sees of a point along a locus; as :class:`~contvines.bifurcation.point_on_branch.PointOnBranch`, without a tangent."""

    def __init__(self, problem: Any, data: Any, u: np.ndarray, p: float, work: Any, row: np.ndarray) -> None:
        self._about = problem, data, work, row
        self.u, self.value = np.array(u), float(p)

    @property
    def problem(self) -> Any:
        return self._about[0]

    @property
    def parameters(self) -> dict[str, float]:
        """All parameters by name, both that vary included."""
        data = self._about[1]
        return {**data.parameters, data.parameter: self.value}

    @cached_property
    def jacobian(self) -> np.ndarray:
        """F_u of the problem's equations, shape (N, N)."""
        problem, data, work, _ = self._about
        return np.array(problem.kernels.matrix(data, work))

    @cached_property
    def multipliers(self) -> np.ndarray:
        """Of the full period (eigenvalues for flows), complex."""
        problem, _, _, row = self._about
        pairs = np.array(row[: 2 * int(problem.n_multipliers)])
        return np.asarray(problem.to_multipliers(pairs.view(complex)), dtype=complex)

    @property
    def margins(self) -> np.ndarray:
        """Distances from borders."""
        problem, _, _, row = self._about
        return np.array(row[2 * int(problem.n_multipliers) :])

    def measure(self, name: str) -> float:
        """A measure of the solution by its name."""
        data = self._about[1]
        return float(data.measures((name,), self.u[None, :], np.array([self.value]))[name][0])


class WithCondition:
    """A problem with the condition of a kind as its last margin; all else is the problem's."""

    def __init__(self, problem: Any, kind: Kind) -> None:
        self.plain, self.own_kind = problem, kind
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

    def _inspect(self, data: Any, u: np.ndarray, p: float, work: Any, row: np.ndarray) -> None:
        self.plain.kernels.inspect(data, u, p, work, row[:-1])
        condition: Any = self.own_kind.locus
        try:
            row[-1] = float(condition(PointOfLocus(self.plain, data, u, p, work, row[:-1])))
        except (ArithmeticError, np.linalg.LinAlgError):
            row[-1] = np.nan


def of_own_kind(point: SpecialPoint) -> bool:
    """Whether a special point is of a kind of the user's own; a problem's own borders are not."""
    return point.own_kind is not None or (point.kind not in BY_NAME and point.margin_index is None)


def followed(point: SpecialPoint) -> bool:
    """Whether a chart follows a special point: all but ends, and zeros of users' tests."""
    return point.kind not in ("end", "user") and not of_own_kind(point)


def with_condition(problem: Any, kind: Kind | None, label: str) -> WithCondition:
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
    if problem.kernels.compiled:
        raise ValueError(f"{label}: kinds of your own are followed for problems in Python only")
    return WithCondition(problem, kind)
