"""AdaptiveLocus: a locus of cycles of a flow, whose mesh is adapted along the locus as it is along branches."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cached_property
from typing import Any

import numpy as np

from ..bifurcation.kind import Kind
from ..flows.cycles import CycleProblem
from ..problems.protocol import Problem, Symmetry
from .kernels import FOLD, GROWTH, PERIOD, VALID
from .linear import borders_at
from .problem import LocusProblem, Work


def on_mesh(problem: Problem) -> CycleProblem:
    """Return the problem, as one of cycles of a flow.

    Raises
    ------
    TypeError
        If it is another problem.
    """
    if not isinstance(problem, CycleProblem):
        raise TypeError(f"a {type(problem).__name__} has no mesh")
    return problem


class AdaptiveLocus(LocusProblem):
    """Special points of cycles of flows, against a second parameter; see :class:`contvines.problems.abilities.Adaptive`.

    The borders of the bordered systems belong to a mesh, and are computed again on each new mesh.
    """

    @cached_property
    def works(self) -> list[Work]:
        """Workspaces of this problem; `anchor` updates their borders."""
        return []

    @property
    def tested(self) -> int:
        """Condition whose test is evaluated. Folds of planar cycles use the multiplier: near canards the equations are singular to rounding although it is not 1."""
        return GROWTH if self.condition == FOLD and self.n_multipliers == 1 else self.condition

    @property
    def mesh(self) -> CycleProblem:
        """Problem of the branches, as one of cycles."""
        return on_mesh(self.base)

    @property
    def symmetries(self) -> tuple[Symmetry, ...]:  # type: ignore[override]
        """Symmetries of the cycles that equilibria and cycles of half the period have; the locus ends where its cycles get one of them."""
        return tuple(self._of_motion(symmetry) for symmetry in self.base.symmetries if symmetry.root)

    def _of_motion(self, symmetry: Symmetry) -> Symmetry:
        """A symmetry of the cycle as one of the locus's unknowns."""
        apply, kind_at, n = symmetry.apply, symmetry.kind_at, self.size

        def image(U: np.ndarray) -> np.ndarray:
            return np.concatenate([apply(U[:n]), U[n:]])

        return Symmetry(symmetry.kind, image, None, None if kind_at is None else lambda U: kind_at(U[:n]))

    def workspace(self) -> Work:
        """Return arrays for the kernels; their borders will follow the mesh."""
        self.works.append(super().workspace())
        return self.works[-1]

    @property
    def chunk(self) -> int:
        """Points of the locus after which the mesh is adapted."""
        return self.mesh.chunk

    def accuracy(self, u: np.ndarray, p: float) -> float:
        """Relative accuracy of values on the mesh."""
        inner, value = self.split(u)
        return on_mesh(self.at(p)).accuracy(inner, float(value))

    def normal_form(
        self,
        kind: str,
        u: np.ndarray,
        p: float,
        multiplier: complex = -1.0,
        along: np.ndarray | None = None,
    ) -> None:
        """Return None: the normal forms of points of codimension two are computed elsewhere."""
        return None

    def anchor(self, u: np.ndarray | None, p: float = 0.0) -> None:
        """Use the phase and the borders of a point for the following points; with None no phase is fixed."""
        first, second = on_mesh(self.first), on_mesh(self.second)
        first.anchor(None)
        second.anchor(None)
        if u is None:
            return
        inner, value = self.split(u)
        assign = self.base.kernels.assign
        assert assign is not None
        assign(self.first.data, self.second.data, float(p))
        first.anchor(inner, float(value))
        second.reference = first.reference
        for work in self.works:
            work.borders[:] = borders_at(self.at(p), self.condition, inner, float(value), work.borders)
            work.state[VALID] = min(work.state[VALID], 0.0)  # slopes of the old borders are invalid

    def in_phase(self, u: np.ndarray) -> bool:
        """Return False, so that phase and borders are renewed at every adaptation of the mesh."""
        return False

    def adapted(self, u: np.ndarray) -> Callable[..., np.ndarray] | None:
        """Return the interpolation of unknowns, or directions, to a better mesh; None if the mesh is good."""
        adapted = self.mesh.adapted(u[: self.size])
        if adapted is None:
            return None

        def image(v: np.ndarray, direction: bool = False) -> np.ndarray:
            return np.concatenate([adapted(v[: self.size], direction), v[self.size :]])

        return image

    def terms(self, u: np.ndarray) -> np.ndarray:
        """Sizes of the terms of the equations of the cycle, and of the locus."""
        rows = np.ones(self.dimension) if self.scales is None else self.scales.rows.copy()
        rows[: self.size] = self.mesh.terms(u[: self.size])
        return rows

    def lags(self, u: np.ndarray) -> bool:
        """Whether the error of the cycle on its mesh is too large."""
        return self.mesh.lags(u[: self.size])

    def too_coarse(self, u: np.ndarray, p: float, stuck: bool = False) -> bool:
        """Whether the cycle needs more intervals."""
        inner, value = self.split(u)
        base = on_mesh(self.at(p))
        coarse = base.too_coarse(inner, float(value), stuck)
        self.mesh.parts_of_refined = base.parts_of_refined
        return coarse

    @property
    def parts_of_refined(self) -> int:
        """Number of equal parts of the mesh that `halved` makes."""
        return self.mesh.parts_of_refined

    def refined(self) -> AdaptiveLocus:
        """Return the same locus with twice as many intervals."""
        finer = self.mesh.refined()
        position = float(self.works[0].reference[0]) if self.works else self.reference
        index = finer.period_place if self.condition == PERIOD else self.index
        return self.again(finer, index=index, reference=position)

    def halved(self, u: np.ndarray, direction: bool = False) -> np.ndarray:
        """Return unknowns, or a direction, on a mesh with twice as many intervals."""
        return np.concatenate(
            [self.mesh.halved(u[..., : self.size], direction), u[..., self.size :]], axis=-1
        )


def locus_of(description: Mapping[str, Any], trust: bool, kind: Kind) -> LocusProblem | None:
    """Rebuild the locus of a user-defined kind from the result of `describe`; None if the user's functions cannot be found."""
    on_a_mesh = "cycle" in description["problem"]
    return (AdaptiveLocus if on_a_mesh else LocusProblem).rebuilt(description, trust, kind)


def from_description(description: Mapping[str, Any], trust: bool = False) -> AdaptiveLocus | None:
    """Rebuild an AdaptiveLocus from the result of `describe`; None if the user's functions cannot be found."""
    return AdaptiveLocus.rebuilt(description, trust)
