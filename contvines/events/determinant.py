"""Test function of branch points: where the bordered matrix is singular."""

from __future__ import annotations

import numpy as np

from ..continuation.engine import Engine, Solved


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
