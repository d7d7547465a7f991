"""AdaptiveLocus: a locus of solutions on a mesh, which is adapted while the locus is followed, as it is along branches."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cached_property
from typing import Any

import numpy as np

from ..flows.cycles import CycleProblem
from ..problems.protocol import Problem, Symmetry
from .kernels import FOLD, GROWTH, KNOWN, PERIOD
from .linear import borders_at
from .problem import LocusProblem, Work


def on_mesh(problem: Problem) -> CycleProblem:
    """The problem, which is one of cycles of a flow.

    Raises
    ------
    TypeError
        If it is none.
    """
    if not isinstance(problem, CycleProblem):
        raise TypeError(f"a {type(problem).__name__} has no mesh")
    return problem


class AdaptiveLocus(LocusProblem):
    """Special points of cycles of flows, against a second parameter; see :class:`contvines.problems.abilities.Adaptive`.

    The borders of the bordered systems belong to a mesh, and are found anew on each.
    """

    @cached_property
    def works(self) -> list[Work]:
        """Workspaces whose borders follow the mesh."""
        return []

    @property
    def tested(self) -> int:
        """Folds of cycles in the plane by their multiplier: at canards the equations are singular to rounding all along the branch, and it is not 1."""
        return GROWTH if self.condition == FOLD and self.n_multipliers == 1 else self.condition

    @property
    def mesh(self) -> CycleProblem:
        """The problem of the branches."""
        return on_mesh(self.base)

    @property
    def symmetries(self) -> tuple[Symmetry, ...]:  # type: ignore[override]
        """Those in whose fixed spaces other motions lie: equilibria, and cycles of half the period. A locus that comes there has ended."""
        return tuple(self._of_motion(symmetry) for symmetry in self.base.symmetries if symmetry.root)

    def _of_motion(self, symmetry: Symmetry) -> Symmetry:
        """A symmetry of the motion as one of the special point."""
        apply, kind_at, n = symmetry.apply, symmetry.kind_at, self.size

        def image(U: np.ndarray) -> np.ndarray:
            return np.concatenate([apply(U[:n]), U[n:]])

        return Symmetry(symmetry.kind, image, None, None if kind_at is None else lambda U: kind_at(U[:n]))

    def workspace(self) -> Work:
        """Arrays for the kernels, whose borders follow the mesh."""
        self.works.append(super().workspace())
        return self.works[-1]

    @property
    def chunk(self) -> int:
        """Points after which the mesh is adapted."""
        return self.mesh.chunk

    def accuracy(self, u: np.ndarray, p: float) -> float:
        """Of values on the mesh, relative."""
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
        """Points of codimension two have forms of their own."""
        return None

    def anchor(self, u: np.ndarray | None, p: float = 0.0) -> None:
        """Keep the phase, and take the borders, of a point for those that follow; None: the phase of none."""
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
            work.state[KNOWN] = min(work.state[KNOWN], 0.0)  # slopes belong to the borders

    def in_phase(self, u: np.ndarray) -> bool:
        """Never: the borders are those of the last point."""
        return False

    def adapted(self, u: np.ndarray) -> Callable[..., np.ndarray] | None:
        """How unknowns, and directions of unknowns, read on a better mesh; None where the mesh is good."""
        own = self.mesh.adapted(u[: self.size])
        if own is None:
            return None

        def image(v: np.ndarray, direction: bool = False) -> np.ndarray:
            return np.concatenate([own(v[: self.size], direction), v[self.size :]])

        return image

    def terms(self, u: np.ndarray) -> np.ndarray:
        """Sizes of the terms of the equations of the motion, and of the locus."""
        own = np.ones(self.dimension) if self.scales is None else self.scales.rows.copy()
        own[: self.size] = self.mesh.terms(u[: self.size])
        return own

    def lags(self, u: np.ndarray) -> bool:
        """Whether the motion asks for another mesh."""
        return self.mesh.lags(u[: self.size])

    def too_coarse(self, u: np.ndarray, p: float, stuck: bool = False) -> bool:
        """Whether more intervals are needed."""
        inner, value = self.split(u)
        base = on_mesh(self.at(p))
        coarse = base.too_coarse(inner, float(value), stuck)
        self.mesh.parts_of_refined = base.parts_of_refined
        return coarse

    @property
    def parts_of_refined(self) -> int:
        """Equal parts, into which `halved` divides the mesh."""
        return self.mesh.parts_of_refined

    def refined(self) -> AdaptiveLocus:
        """The same locus with twice as many intervals."""
        finer = self.mesh.refined()
        position = float(self.works[0].reference[0]) if self.works else self.reference
        index = finer.period_place if self.condition == PERIOD else self.index
        return self.again(finer, index=index, reference=position)

    def halved(self, u: np.ndarray, direction: bool = False) -> np.ndarray:
        """Unknowns, or a direction of unknowns, with every interval halved."""
        return np.concatenate(
            [self.mesh.halved(u[..., : self.size], direction), u[..., self.size :]], axis=-1
        )


def from_description(description: Mapping[str, Any], trust: bool = False) -> AdaptiveLocus | None:
    """The AdaptiveLocus that `describe` described; None where functions of the user's own are not at hand."""
    return AdaptiveLocus.rebuilt(description, trust)
