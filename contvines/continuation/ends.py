"""Where a branch ends by itself: it comes back to its start, runs away, or creeps."""

from __future__ import annotations

import numpy as np

from .engine import Engine, Solved
from .layout import Chunk, Status, packed
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


# doublings of the distance, to `SOLUTION.huge`, for which the rest of the interval has to have room, on branches that go on
DOUBLINGS = 26
# a doubling that takes so much less than the one before, and so little of the interval, is one of the last
SHRINKS, SMALL = 0.5, 0.05
STEADY = 0.05  # relative difference of two shares by which the parameter's change shrinks with a doubling, up to which they are one
MANY = 600  # short steps in a row that lead nowhere
OFF = 2.0  # times `escape`, of cycles at one value of the parameter: as of families of a linear oscillator, which have all amplitudes
GROW = 2.0  # distance, in typical sizes, from which on steps grow with it


class Reach:
    """How far a branch is from its start, whether it runs away, and how long its steps may be there.

    Where typical sizes of the unknowns are known (they were given, or are 1) a branch has run away when it is further from its start
    than so many of them. Where points are dear steps may grow with the distance. Sizes that were learned near the start say little of what lies far
    from it: there a branch has run away when its distance doubles within changes of the parameter that shrink by the same share, as towards a pole in
    the interval, and are so small that it would be out of all bounds long before the end. Powers of the parameter double within ever larger ones and
    are followed.

    Parameters
    ----------
    engine : Engine
    start : Solved
    """

    def __init__(self, engine: Engine, start: Solved) -> None:
        self.engine, self.start = engine, start
        self.learned = engine.problem.scales_learned
        # cycles explode within next to no change of the parameter (canards) and stay bounded; their periods have a margin
        self.bounded = engine.adaptive is not None
        # largest distances so far, each twice the one before, and the extremes of the parameter since
        self.doubled = engine.settings.escape
        self.slow = 0  # points in a row that came next to nowhere
        self.low = self.high = start.p
        # change of the parameter while the distance doubled last: infinite where it turned back, as it stands still at a fold
        self.moved, self.turned = np.inf, False
        self.share = np.nan  # of that change in the one before

    def growth(self, point: Solved) -> float:
        """Factor of the longest step at a point; 1 where points are cheap."""
        if self.engine.compiled:
            return 1.0
        return max(1.0, float(self._distances(point.u[None, :])[0]) / GROW)

    def escapes(self, chunk: Chunk, apart: float = np.inf) -> int | None:
        """Index of the first point at which the branch has run away, or None; neighbours are at most so far apart."""
        escape = self.engine.settings.escape
        if not self.learned:
            scale = self.engine.scale[:-1]
            begin = float(
                np.abs((chunk.points[0] - self.start.u) / scale).max()
            )  # no root mean square is larger
            if begin + len(chunk) * apart < escape:
                return None
            away = _away(chunk.points, self.start.u, escape, scale)
            return int(np.argmax(away)) if away.any() else None
        distances = self._distances(chunk.points)
        if not distances.max() > 0.5 * self.doubled:
            self.low = self.high = float(chunk.values[-1])
            self.turned = False
            return None
        for i in range(1, len(chunk)):
            value = float(chunk.values[i])
            self.low, self.high = min(self.low, value), max(self.high, value)
            self.turned |= bool(chunk.tangents[i - 1, -1] * chunk.tangents[i, -1] < 0.0)
            if distances[i] <= self.doubled:
                if distances[i] <= 0.5 * self.doubled:
                    self.low, self.high, self.turned = value, value, False
                continue
            moved, ahead = self.high - self.low, chunk.tangents[i, -1] > 0.0
            room = self.engine.upper - value if ahead else value - self.engine.lower
            last = moved < SHRINKS * self.moved and moved < SMALL * (self.engine.upper - self.engine.lower)
            # where the parameter stands still its turns are those of rounding
            stands = (
                moved <= max(self.engine.settings.rounding, 10.0 * self.engine.noise) * self.engine.scale[-1]
            )
            turned = self.turned and not stands
            comparable = self.moved < np.inf and not turned
            share = moved / self.moved if comparable and self.moved > 0.0 else np.nan
            # near the start distances double within less and less however the branch goes on; by the same share towards a pole, here one in the interval
            pole = abs(share - self.share) <= STEADY * share and moved * share < (1.0 - share) * room
            soon = DOUBLINGS * moved < room and (pole or stands)
            bound = not self.bounded and comparable and moved <= self.moved and (last or soon)
            family = self.bounded and stands and self._one_of_a_family(chunk.rows[i])
            if bound or distances[i] > (OFF if family else SOLUTION.huge) * escape:
                return i
            self.doubled, self.low, self.high = 2.0 * float(distances[i]), value, value
            self.moved, self.turned, self.share = np.inf if turned else moved, False, share
        return None

    def _one_of_a_family(self, row: np.ndarray) -> bool:
        """Whether a multiplier is 1, as of cycles that all exist at one value of the parameter; those of a canard explosion are far from it."""
        return bool(
            np.abs(self.engine.spectrum(row) - 1.0).min(initial=np.inf) < self.engine.settings.together
        )

    def creeps(self, chunk: Chunk) -> bool:
        """Whether many points have come next to nowhere; of problems whose points are dear."""
        if self.engine.compiled or len(chunk) < 2:
            return False
        steps = np.diff(np.column_stack([chunk.points, chunk.values]), axis=0)
        way = float(np.sqrt((steps**2) @ self.engine.weights).sum())
        self.slow = self.slow + len(chunk) - 1 if way < self.engine.settings.creep * (len(chunk) - 1) else 0
        return self.slow >= MANY

    def _distances(self, points: np.ndarray) -> np.ndarray:
        """Root mean square distances from the start, in typical sizes."""
        return np.sqrt((((points - self.start.u) / self.engine.scale[:-1]) ** 2).mean(axis=1))


def _away(points: np.ndarray, u: np.ndarray, escape: float, scale: np.ndarray) -> np.ndarray:
    """Which points are further than `escape` times the scale from u (root mean square)."""
    if not (scale == 1.0).all():
        points, u = points / scale, u / scale
    limit = escape * escape * len(u)
    squares = np.einsum("ij,ij->i", points, points)
    # nothing as large as the points is made, unless unknowns are so large that their squares cancel
    if SOLUTION.cancels * (squares.max() + u @ u) < limit:
        return squares - 2.0 * (points @ u) + u @ u > limit
    return ~(((points - u) ** 2).sum(axis=1) <= limit)
