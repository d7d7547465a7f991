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
        self.chord = np.array([self.za, self.arc * a.tangent, self.zb, self.arc * b.tangent])
        self.start = float(self.border @ self.za)

    def at(self, s: float) -> Solved | None:
        """The point of the branch at s, to roundoff; None if it cannot be solved or belongs to another branch."""
        engine = self.engine
        if s == 0.0 or s == 1.0:
            end, z = (self.a, self.za) if s == 0.0 else (self.b, self.zb)
            return engine.polish(end.u, end.p, self.border, float(self.border @ z), self.direction)
        return engine.on_chord(self.chord, float(s), self.start, self.length, self.border, self.direction)
