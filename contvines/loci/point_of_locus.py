"""PointOfLocus: what functions of users' kinds see of a point along a locus."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache, cached_property
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ..problems.protocol import Problem


class PointOfLocus:
    """As :class:`~contvines.bifurcation.point_on_branch.PointOnBranch`, without a tangent.

    ``problem`` is that of the branches, ``value`` the first parameter; ``parameters`` hold both that vary.

    Parameters
    ----------
    problem, jacobian : callable
        Called when they are asked for.
    parameters : mapping
    place : mapping
        Both parameters that vary, the first one first.
    u : ndarray, shape (N,)
    row : ndarray
        Its multipliers and margins.
    """

    def __init__(
        self,
        problem: Callable[[], Problem],
        parameters: Mapping[str, float],
        place: Mapping[str, float],
        u: np.ndarray,
        row: np.ndarray,
        jacobian: Callable[[], np.ndarray],
    ) -> None:
        self.parameters, self.place = {**parameters, **place}, dict(place)
        self.u, self.value = np.array(u), next(iter(place.values()))
        self._problem, self._row, self._jacobian = cache(problem), np.array(row), jacobian

    @property
    def problem(self) -> Problem:
        """That of the branches, at this value of the second parameter."""
        return self._problem()

    @cached_property
    def jacobian(self) -> np.ndarray:
        """F_u of the problem's equations, shape (N, N)."""
        return np.array(self._jacobian())

    @cached_property
    def multipliers(self) -> np.ndarray:
        """Of the full period (eigenvalues for flows), complex."""
        pairs = self._row[: 2 * int(self.problem.n_multipliers)]
        return np.asarray(self.problem.to_multipliers(pairs.view(complex)), dtype=complex)

    @property
    def margins(self) -> np.ndarray:
        """Distances from borders."""
        return self._row[2 * int(self.problem.n_multipliers) :]

    def measure(self, name: str) -> float:
        """A measure of the solution by its name."""
        found = self.problem.measures((name,), self.u[None, :], np.array([self.value]))
        return float(found[name][0])
