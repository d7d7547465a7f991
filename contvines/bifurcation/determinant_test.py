"""Determinants at branch points: a test function with its zero where the bordered matrix is singular, and the sign of det F_u.

det [[F_u, F_p], [t]] = det(F_u) t.t / t_p for the tangent t: with its sign, which comes with every point, that of det(F_u) is
known. It has the accuracy of an elimination with pivots; eigenvalues may have less, where the others are very much larger.
"""

from __future__ import annotations

import numpy as np

from ..continuation.engine import Engine, Solved
from .segment import Segment


class DeterminantTest:
    """A smooth function with a simple zero where [[F_u, F_p], [border]] is singular: 1 / (c . M^-1 b).

    b is a fixed vector, c the direction of M^-1 b near the zero.
    """

    def __init__(self, engine: Engine, border: np.ndarray) -> None:
        self.engine, self.border = engine, border
        self.side = np.random.default_rng(2).standard_normal(engine.n + 1)
        self.side[-1] = 0.0
        self.row: np.ndarray | None = None

    def __call__(self, point: Solved) -> float:
        engine = self.engine
        engine.residual(point.u, point.p)
        x = engine.apply_inverse(self.border, self.side)
        if self.row is None:
            x2 = engine.apply_inverse(self.border, np.append(x[:-1], 0.0))
            self.row = x2 / max(float(np.abs(x2).max()), 1e-300)
        value = float(self.row @ x)
        return 1.0 / value if value != 0.0 else np.nan


def turned(a: Solved, b: Solved) -> bool | None:
    """Whether det(F_u) has another sign at b than at a; None where it is zero at one of them, or has no sign."""
    product = a.sign * a.tangent[-1] * b.sign * b.tangent[-1]
    return bool(product < 0.0) if product else None


def passes(segment: Segment, position: float, reach: float | None = None) -> bool:
    """Whether det(F_u) changes its sign within a reach of a place on a segment, as it does where one eigenvalue vanishes."""
    reach = segment.engine.settings.aside if reach is None else reach
    sides = segment.several((position - reach, position + reach))
    return sides[0] is not None and sides[1] is not None and turned(sides[0], sides[1]) is not False
