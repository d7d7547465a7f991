"""Closing: a branch that comes back to its start."""

from __future__ import annotations

import numpy as np

from .chunk import Chunk, Status, packed
from .engine import Engine, Solved
from .settings import SOLUTION

NEAR = 1.5  # distances of neighbours from the start at which a branch may close


class Closing:
    """Recognises that a branch comes back to its start, modulo the shift by a period."""

    def __init__(self, engine: Engine, start: Solved) -> None:
        self.engine, self.start = engine, start
        self.left = False  # whether a chunk has gone away from the start

    def cut(self, chunk: Chunk, apart: float = np.inf) -> Chunk | None:
        """The chunk up to the start, or None if it does not get there; neighbours are at most so far apart."""
        engine = self.engine
        if engine.adaptive is not None:
            return self._on_other_meshes(chunk)
        if chunk.values[0] == self.start.p:
            changes = chunk.values[1:] - chunk.values[:-1]
            rises = chunk.values[-1] > self.start.p
            if (changes > 0.0 if rises else changes < 0.0).all():
                return None  # from the start on the parameter only rises, or only falls
        far = NEAR * apart * (engine.upper - engine.lower)
        if self.start.p < chunk.values.min() - far or self.start.p > chunk.values.max() + far:
            return None
        z, border = engine.join(self.start.u, self.start.p), engine.weights * self.start.tangent
        along = chunk.points @ border[:-1] + chunk.values * border[-1] - border @ z
        turns = np.zeros(len(chunk))
        shift = engine.shift
        if shift is not None:
            turns = np.round((chunk.points @ shift - z[:-1] @ shift) / (shift @ shift))
            along -= turns * (shift @ border[:-1])
        along[np.abs(along) <= SOLUTION.predicted * (1.0 + abs(border) @ abs(z))] = 0.0  # the start itself
        (passed,) = ((along[:-1] < 0.0) & (along[1:] >= 0.0)).nonzero()
        if not len(passed):
            return None
        for i in passed[np.array(chunk.tangents[passed + 1] @ border) > 0.0]:
            pair = slice(i, i + 2)
            gaps = np.column_stack([chunk.points[pair], chunk.values[pair]]) - z
            if shift is not None:
                gaps[:, :-1] -= turns[pair, None] * shift
            if np.sqrt((gaps**2) @ engine.weights).min() > NEAR * engine.norm(gaps[1] - gaps[0]):
                continue
            share = along[i] / (along[i] - along[i + 1])
            guess = z + gaps[0] + share * (gaps[1] - gaps[0])
            found = engine.solve(guess[:-1], guess[-1], border, float(border @ z))
            if found is None:
                continue
            gap = np.abs(engine.join(found.u, found.p) - z) / (engine.scale + np.abs(z))
            if gap.max() <= engine.settings.same and engine.inner(found.tangent, self.start.tangent) > 0.0:
                end = self.start.u if shift is None else self.start.u + turns[i] * shift
                return chunk.cut(int(i) + 1).joined(packed([self.start._replace(u=end)], Status.CLOSED))
        return None

    def _on_other_meshes(self, chunk: Chunk) -> Chunk | None:
        """The same where unknowns belong to meshes, and solutions may be shifted in time: their canonical forms tell which is which."""
        engine, start, problem = self.engine, self.start, self.engine.problem
        ahead = np.sign(start.tangent[-1])
        gaps = (chunk.values - start.p) * ahead
        if not self.left:
            gaps[0], self.left = 0.0, True  # the start itself, solved for on another mesh
        for i in np.flatnonzero((gaps[:-1] < 0.0) & (gaps[1:] >= 0.0)):
            share = gaps[i] / (gaps[i] - gaps[i + 1])
            guess = chunk.points[i] + share * (chunk.points[i + 1] - chunk.points[i])
            found = engine.at_value(guess, start.p)
            if found is None:
                continue
            key, here = problem.canonical(found.u, found.p)
            wanted, there = problem.canonical(start.u, start.p)
            if key == wanted and here.shape == there.shape:
                size = engine.scale[: len(here)] if len(here) < len(engine.scale) else 1.0
                if (np.abs(here - there) <= engine.settings.one_place * (size + np.abs(there))).all():
                    points = chunk.cut(int(i) + 1)
                    # not the start itself: there the same motion may begin at another time, or lie on another mesh
                    way = 1.0 if engine.inner(found.tangent, points.tangents[-1]) > 0.0 else -1.0
                    found = found._replace(tangent=way * found.tangent, sign=way * found.sign)
                    return points.joined(packed([found], Status.CLOSED))
        return None
