"""CycleRelatives: mirror images, doubled and halved cycles, and what tells that two cycles are one."""

from __future__ import annotations

from collections.abc import Hashable
from typing import TYPE_CHECKING, Self

import numpy as np

from ..problems.protocol import Embedding, Symmetry
from ..problems.symmetries import in_order
from . import mesh
from .cycle_borders import CycleBorders

if TYPE_CHECKING:
    from ..problems.algebraic import AlgebraicProblem

MEANS = 20  # per state, at most: ten intervals of degree two have as many values


class CycleRelatives(CycleBorders):
    """Symmetries of cycles, those of half and of twice the period, and their identity."""

    def _symmetries(self) -> list[Symmetry]:
        found = []
        even = self.intervals % 2 == 0
        if even and self.copies % 2 == 0 and (self.free_period or self.rounds % 2 == 0):
            at = self._kind_at if self.free_period else None
            found.append(Symmetry("period-doubling", self._half_later, self._root, at))
        elif even and self.free_period:
            found.append(Symmetry("hopf", self._half_later, self._root))
        mirror = self.flow.mirror
        if mirror is not None:
            if even and (self.free_period or self.flow.mirror_shifted != (self.rounds % 2 == 0)):
                found.append(Symmetry("symmetry-breaking", lambda u: self._mirrored(self._half_later(u))))
            if self.free_period or not self.flow.mirror_shifted:
                found.append(Symmetry("symmetry-breaking", self._mirrored))
        return found

    def _kind_at(self, u: np.ndarray) -> str:
        """Whether a cycle that is equal to itself half a period later is an equilibrium or a cycle of half the period."""
        y = u[: self.states].reshape(-1, self.node) / self.node_scale
        return "hopf" if np.ptp(y, axis=0).max() < self.flow.settings.at_rest else "period-doubling"

    def _half_later(self, u: np.ndarray) -> np.ndarray:
        v = np.array(u, dtype=float)
        x = v[: self.states].reshape(self.intervals, -1)
        v[: self.states] = np.roll(x, self.intervals // 2, axis=0).reshape(-1)
        return v

    def _mirrored(self, u: np.ndarray) -> np.ndarray:
        v = np.array(u, dtype=float)
        x = v[: self.states].reshape(-1, self.node)
        mirror = self.flow.mirror
        assert mirror is not None
        v[: self.states] = np.array([mirror(y) for y in x]).reshape(-1)
        return v

    def _root(self, u: np.ndarray) -> tuple[AlgebraicProblem | Self, np.ndarray]:
        return self.root(u, self.p0, self.flow.settings.at_rest) or (self, u)

    def root(
        self, u: np.ndarray, p: float, loose: float | None = None
    ) -> tuple[AlgebraicProblem | Self, np.ndarray] | None:
        """The equilibrium, or the cycle of half the period, that a solution only repeats; else None."""
        x, widths = self._curve(u)
        y = x.reshape(-1, self.node)
        near = self.flow.settings.same if loose is None else loose
        if (np.ptp(y, axis=0) <= near * self.node_scale).all() and self.free_period:
            return self.flow.equilibria(self.parameter, {**self.values.values, self.parameter: p}), y.mean(
                axis=0
            )
        half = self.intervals // 2
        if self.copies % 2 or (self.free_period == 0 and self.rounds % 2):
            return None
        apart = np.abs(x[:half] - x[half:]).max(axis=(0, 1)) / self.node_scale
        if not (apart <= near * (1.0 + np.abs(y).max(axis=0) / self.node_scale)).all():
            return None
        period = u[self.states] / 2.0 if self.free_period else 0.0
        shorter = np.concatenate(
            [
                0.5 * (x[:half] + x[half:]).reshape(-1),
                [period] if self.free_period else [],
                2.0 * widths[:half],
            ]
        )
        rounds = self.rounds if self.free_period else self.rounds // 2
        return self.with_unknowns(shorter, p, half, self.copies // 2, rounds), shorter

    def center(self, u: np.ndarray) -> tuple[np.ndarray, float]:
        """The mean state, and the mean square of the distance from it, in units of the scale."""
        x = u[: self.states].reshape(-1, self.node)
        mean = x.mean(axis=0)
        return mean, float((((x - mean) / self.node_scale) ** 2).mean())

    def resting(self, u: np.ndarray, x: np.ndarray) -> np.ndarray:
        """An equilibrium as a cycle with the period and the mesh of another."""
        return np.concatenate([np.tile(x, self.states // self.node), u[self.states :]])

    def offspring(
        self, kind: str, u: np.ndarray, p: float, tangent: np.ndarray, multiplier: complex
    ) -> list[Embedding]:
        """At a period doubling: the cycle of twice the period."""
        if kind != "period-doubling":
            return []
        x, widths = self._curve(u)
        y = tangent[: self.states].reshape(x.shape)
        both = np.concatenate([x, x]).reshape(-1)
        own = [2.0 * u[self.states]] if self.free_period else []
        doubled = np.concatenate([both, own, np.tile(0.5 * widths, 2)])
        direction = np.concatenate(
            [
                np.concatenate([y, y]).reshape(-1),
                [2.0 * tangent[self.states]] if self.free_period else [],
                np.zeros(2 * self.intervals),
                [tangent[-1]],
            ]
        )
        rounds = self.rounds if self.free_period else 2 * self.rounds
        problem = self.with_unknowns(doubled, p, 2 * self.intervals, 2 * self.copies, rounds)
        return [Embedding(problem, doubled, direction, kind)]

    def canonical(self, u: np.ndarray, p: float) -> tuple[Hashable, np.ndarray]:
        """Means over the shortest period of powers and products of the coordinates, the same for all meshes and phases; of mirror images the smaller.

        Of many states the first ones tell cycles apart: no more than there are values at the nodes of any mesh, whose scales they have.
        """
        shorter = self.root(u, p)
        if shorter is not None:
            return shorter[0].canonical(shorter[1], p)
        x, period, widths = self.parts(u, p)
        forms = [x]
        if self.flow.mirror is not None:
            forms.append(self._mirrored(u)[: self.states].reshape(x.shape))
        found = [self._means(form, widths, period)[: MEANS * self.node] for form in forms]
        best = min(found, key=in_order(np.full(len(found[0]), self.flow.settings.same)))
        kind = ("cycle", self.rounds if not self.free_period else 0, self.node)
        return kind, best * self.column_scale[: len(best)]

    def _means(self, x: np.ndarray, widths: np.ndarray, period: float) -> np.ndarray:
        r, d = self.rule, self.node
        ends = mesh.closed(x / self.node_scale)
        points = np.einsum("cj,ijk->ick", r.values, ends).reshape(-1, d)
        slopes = np.einsum("cj,ijk->ick", r.slopes, ends).reshape(-1, d)
        share = (widths[:, None] * r.weights).reshape(-1)
        turns = np.repeat(r.weights[None, :], len(widths), axis=0).reshape(-1)
        mean = share @ points
        rest = points - mean
        size = np.sqrt(share @ rest**2)
        moves = size > self.flow.settings.same * size.max()  # what stands still has no shape
        unit = np.where(moves, rest / np.where(moves, size, 1.0), 0.0)
        second = np.einsum("i,ia,ib->ab", share, rest, unit)
        area = np.einsum("i,ia,ib->ab", turns, unit, slopes)
        upper = np.triu_indices(d)
        third = np.einsum("i,ia,ib->ab", share, unit**2, rest)
        clock = period / self.clock if self.free_period else 1.0
        return np.concatenate([[clock], mean, second[upper], area[np.triu_indices(d, 1)], third.reshape(-1)])
