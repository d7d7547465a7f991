"""Test function of symmetric solutions that are met: the part of the unknowns that a symmetry changes."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from ..shared.floating_point import CENTRAL, TINY
from .settings import LOCATING

if TYPE_CHECKING:
    from ..problems.protocol import Symmetry

OPPOSITE = 0.9  # cosine of the angle between what is opposite, at least, but for the sign


@lru_cache(maxsize=64)
def _patternless(n: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Twice n numbers without a pattern, multiples of irrational numbers, and the order of the first ones."""
    probe, check = (0.1 + 0.8 * np.modf(np.sqrt(a) * np.arange(1.0, n + 1.0))[0] for a in (2.0, 3.0))
    return probe, check, np.argsort(probe, kind="stable")


def image_of(symmetry: Symmetry, u: np.ndarray, p: float) -> np.ndarray:
    """The image of a solution (u, p)."""
    image = symmetry.apply(u)
    return image if symmetry.offset is None else image + symmetry.offset(p)


class SymmetryTest:
    """The part of u that a symmetry changes: u - T(u), modulo the shift by a period, in units of the unknowns' scale.

    T is usually a signed permutation plus a constant; it is then found out once and applied to whole chunks. Where T depends on the
    parameter it is asked at each point. ``shift`` is not zero, ``scale`` not one all over: else they are None.
    """

    def __init__(
        self, symmetry: Symmetry, n: int, shift: np.ndarray | None, scale: np.ndarray | None = None
    ) -> None:
        self.symmetry, self.kind = symmetry, symmetry.kind
        self.shift, self.scale = shift, scale
        probe, check, places = _patternless(n)
        self.affine: tuple[np.ndarray, np.ndarray, np.ndarray] | None = None
        if symmetry.offset is not None:
            return
        try:
            constant = np.asarray(symmetry.apply(np.zeros(n)), dtype=float)
            image = np.asarray(symmetry.apply(probe), dtype=float) - constant
            order = np.empty(n, dtype=int)
            order[np.argsort(np.abs(image), kind="stable")] = places
            signs = np.sign(image)
            wrong = np.abs(signs * check[order] + constant - symmetry.apply(check)).max()
            if np.abs(signs * probe[order] - image).max() < LOCATING.rounding and wrong < LOCATING.rounding:
                self.affine = (order, signs, constant)
        except (ArithmeticError, ValueError, IndexError):
            self.affine = None

    def part(self, points: np.ndarray, values: Sequence[float] | np.ndarray) -> np.ndarray:
        """u - T(u) for points of shape (n, N) at parameter values of shape (n,)."""
        if self.affine is not None:
            order, signs, constant = self.affine
            gap = np.take(points, order, axis=1)  # of long branches a large array: worked on in place
            gap *= signs
            gap += constant
            np.subtract(points, gap, out=gap)
        else:
            gap = points - np.array([image_of(self.symmetry, u, float(p)) for u, p in zip(points, values)])
        if self.shift is not None:
            turns = np.rint(gap.dot(self.shift) / self.shift.dot(self.shift))
            if turns.any():
                gap = gap - turns[:, None] * self.shift
        return gap if self.scale is None else gap / self.scale

    def image_direction(self, u: np.ndarray, v: np.ndarray) -> np.ndarray:
        """Derivative of T at u applied to v."""
        if self.affine is not None:
            order, signs, _ = self.affine
            return signs * v[order]
        scale = CENTRAL / max(float(np.abs(v).max()), TINY)
        return (self.symmetry.apply(u + scale * v) - self.symmetry.apply(u - scale * v)) / (2.0 * scale)


def turns_round(test: SymmetryTest, parts: np.ndarray, least: float, accuracy: float = np.inf) -> bool:
    """Whether the part that a symmetry changes has turned round between two points, shape (2, N).

    Both are larger than noise; or all their many unknowns are opposite, as those of noise are not: of a cycle on a mesh, known to an accuracy, that has
    become one of half the period, or an equilibrium.
    """
    along = float(parts[0] @ parts[1])
    if not along < 0.0:
        return False
    smaller = np.abs(parts).max(axis=1).min()
    if smaller > least:
        return True
    opposite = along < -OPPOSITE * float(np.linalg.norm(parts[0]) * np.linalg.norm(parts[1]))
    return opposite and (test.kind == "hopf" or (test.kind == "period-doubling" and bool(smaller > accuracy)))
