"""Segment: the piece of a branch between two neighbouring points, parametrised so that any point of it can be solved."""

from __future__ import annotations

import numpy as np

from ..continuation.engine import Engine, Solved


class Segment:
    """Points between a and b: s in [0, 1] measures along the chord.

    Parameters
    ----------
    engine : Engine
    a, b : Solved
        Their tangents make an angle of less than a right angle with the chord.
    """

    def __init__(self, engine: Engine, a: Solved, b: Solved) -> None:
        self.engine, self.a, self.b = engine, a, b
        self.za, self.zb = engine.join(a.u, a.p), engine.join(b.u, b.p)
        chord = self.zb - self.za
        self.length = engine.norm(chord)
        self.direction = chord / self.length if self.length > 0.0 else a.tangent
        self.border = engine.weights * self.direction
        bend = engine.inner(a.tangent - b.tangent, a.tangent - b.tangent)
        self.arc = self.length * (1.0 + bend / 24.0)

    def guess(self, s: float) -> np.ndarray:
        """Cubic Hermite interpolation of (u, p)."""
        d, t = self.arc, s
        h00, h10 = (1 + 2 * t) * (1 - t) ** 2, t * (1 - t) ** 2
        h01, h11 = t * t * (3 - 2 * t), t * t * (t - 1)
        return h00 * self.za + h10 * d * self.a.tangent + h01 * self.zb + h11 * d * self.b.tangent

    def at(self, s: float) -> Solved | None:
        """The point of the branch at s, to roundoff; None if it cannot be solved or belongs to another branch."""
        if s == 0.0:
            return self.engine.polish(
                self.a.u, self.a.p, self.border, float(self.border @ self.za), self.direction
            )
        if s == 1.0:
            return self.engine.polish(
                self.b.u, self.b.p, self.border, float(self.border @ self.zb), self.direction
            )
        guess = self.guess(s)
        target = float(self.border @ self.za) + s * self.length
        found = self.engine.solve(guess[:-1], guess[-1], self.border, target, self.direction)
        if found is None or self.engine.norm(self.engine.join(found.u, found.p) - guess) > 0.3 * self.length:
            return None
        return found
