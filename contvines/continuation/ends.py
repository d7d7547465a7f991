"""Ends of a branch that lie in its solutions: it returns to its start, its unknowns grow without bound, or its steps creep."""

from __future__ import annotations

import numpy as np

from .engine import Engine, Solved
from .layout import Chunk, Status, packed
from .settings import SOLUTION

NEAR = 1.5  # a branch may close between two points if one is nearer to the start than this many of their distance


class Closing:
    """Detects that a branch returns to its start, modulo the shift by a period."""

    def __init__(self, engine: Engine, start: Solved) -> None:
        self.engine, self.start = engine, start
        self.left = False  # whether a chunk has gone away from the start

    def cut(self, chunk: Chunk, spacing: float = np.inf) -> Chunk | None:
        """Return the chunk up to the start, or None if it does not reach it; `spacing` bounds the distance of neighbouring points."""
        engine = self.engine
        if engine.adaptive is not None:
            return self._on_other_meshes(chunk)
        if chunk.values[0] == self.start.p:
            changes = chunk.values[1:] - chunk.values[:-1]
            rises = chunk.values[-1] > self.start.p
            if (changes > 0.0 if rises else changes < 0.0).all():
                return None  # the parameter changes in one direction only
        far = NEAR * spacing * (engine.upper - engine.lower)
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
        """Return the same for unknowns that belong to meshes, and may be shifted in time: solutions are compared by their canonical forms."""
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
            key, form = problem.canonical(found.u, found.p)
            wanted, target = problem.canonical(start.u, start.p)
            if key == wanted and form.shape == target.shape:
                size = engine.scale[: len(form)] if len(form) < len(engine.scale) else 1.0
                if (np.abs(form - target) <= engine.settings.one_place * (size + np.abs(target))).all():
                    points = chunk.cut(int(i) + 1)
                    # end with the point found, not with the start: the start may be shifted in time, or lie on another mesh
                    sense = 1.0 if engine.inner(found.tangent, points.tangents[-1]) > 0.0 else -1.0
                    found = found._replace(tangent=sense * found.tangent, sign=sense * found.sign)
                    return points.joined(packed([found], Status.CLOSED))
        return None


# a branch escapes if this many doublings of its distance, as fast as the last one, fit into the rest of the interval,
DOUBLINGS = 26
# or if the parameter's change during a doubling is less than SHRINKS of that before, and than SMALL of the interval
SHRINKS, SMALL = 0.5, 0.05
STEADY = 0.05  # the parameter's change shrinks steadily if its ratio from doubling to doubling varies by less than this part
CREEPING_STEPS = 600  # number of short steps in a row after which a branch creeps
FAMILY_ESCAPE = 2.0  # limit of the distance, in units of `escape`, for families of cycles at one parameter value, as of a linear oscillator
GROWS_FROM = 2.0  # distance from the start, in typical sizes, from which the longest step grows with it


class Reach:
    """Distance of a branch from its start: detects that the branch runs away, and bounds the length of steps.

    * If typical sizes of the unknowns are given (or 1), a branch has run away if its distance from the start exceeds `Settings.escape` of them.
    * Sizes learned near the start say little about solutions far from it. A branch then has run away if its distance doubles within changes of the
      parameter that shrink by a constant ratio, as towards a pole inside the interval, and are so small that the distance would become huge long
      before the end of the interval. Powers of the parameter double within growing changes, and are followed.
    * For problems in Python, whose points are expensive, the longest step grows with the distance.

    Parameters
    ----------
    engine : Engine
    start : Solved
    """

    def __init__(self, engine: Engine, start: Solved) -> None:
        self.engine, self.start = engine, start
        self.learned = engine.problem.scales_learned
        # cycles may grow within a tiny change of the parameter (canards) and stay bounded; long periods are detected by a margin
        self.bounded = engine.adaptive is not None
        # distance that counts as the next doubling, and the extremes of the parameter since the last one
        self.doubled = engine.settings.escape
        self.slow = 0  # number of short steps in a row
        self.low = self.high = start.p
        # change of the parameter during the last doubling; infinite if it turned back, as it is stationary at a fold
        self.moved, self.turned = np.inf, False
        self.share = np.nan  # ratio of this change to the one before

    def growth(self, point: Solved) -> float:
        """Return the factor by which the longest step grows at a point; 1 for compiled problems."""
        if self.engine.compiled:
            return 1.0
        return max(1.0, float(self._distances(point.u[None, :])[0]) / GROWS_FROM)

    def escapes(self, chunk: Chunk, spacing: float = np.inf) -> int | None:
        """Return the index of the first point at which the branch has run away, or None; `spacing` bounds the distance of neighbouring points."""
        escape = self.engine.settings.escape
        if not self.learned:
            scale = self.engine.scale[:-1]
            begin = float(
                np.abs((chunk.points[0] - self.start.u) / scale).max()
            )  # no root mean square is larger
            if begin + len(chunk) * spacing < escape:
                return None
            away = _is_far(chunk.points, self.start.u, escape, scale)
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
            # if the parameter does not change, its turns are rounding
            stands = (
                moved <= max(self.engine.settings.rounding, 10.0 * self.engine.noise) * self.engine.scale[-1]
            )
            turned = self.turned and not stands
            comparable = self.moved < np.inf and not turned
            share = moved / self.moved if comparable and self.moved > 0.0 else np.nan
            # near the start changes shrink on every branch; by a constant ratio only towards a pole, which here must lie in the interval
            pole = abs(share - self.share) <= STEADY * share and moved * share < (1.0 - share) * room
            early = DOUBLINGS * moved < room and (pole or stands)
            bound = not self.bounded and comparable and moved <= self.moved and (last or early)
            family = self.bounded and stands and self._one_of_a_family(chunk.rows[i])
            if bound or distances[i] > (FAMILY_ESCAPE if family else SOLUTION.huge) * escape:
                return i
            self.doubled, self.low, self.high = 2.0 * float(distances[i]), value, value
            self.moved, self.turned, self.share = np.inf if turned else moved, False, share
        return None

    def _one_of_a_family(self, row: np.ndarray) -> bool:
        """Whether a multiplier is 1, as for a family of cycles at one parameter value; in a canard explosion it is far from 1."""
        return bool(
            np.abs(self.engine.spectrum(row) - 1.0).min(initial=np.inf) < self.engine.settings.together
        )

    def creeps(self, chunk: Chunk) -> bool:
        """Whether many steps in a row were very short; False for compiled problems, whose points are cheap."""
        if self.engine.compiled or len(chunk) < 2:
            return False
        steps = np.diff(np.column_stack([chunk.points, chunk.values]), axis=0)
        way = float(np.sqrt((steps**2) @ self.engine.weights).sum())
        self.slow = self.slow + len(chunk) - 1 if way < self.engine.settings.creep * (len(chunk) - 1) else 0
        return self.slow >= CREEPING_STEPS

    def _distances(self, points: np.ndarray) -> np.ndarray:
        """Return the root mean square distances from the start, in typical sizes, shape (n,)."""
        return np.sqrt((((points - self.start.u) / self.engine.scale[:-1]) ** 2).mean(axis=1))


def _is_far(points: np.ndarray, u: np.ndarray, escape: float, scale: np.ndarray) -> np.ndarray:
    """Return which points are farther than `escape` times the scale from u (root mean square), shape (n,)."""
    if not (scale == 1.0).all():
        points, u = points / scale, u / scale
    limit = escape * escape * len(u)
    squares = np.einsum("ij,ij->i", points, points)
    # saves an array as large as the points, unless unknowns are so large that the difference of squares loses its digits
    if SOLUTION.cancels * (squares.max() + u @ u) < limit:
        return squares - 2.0 * (points @ u) + u @ u > limit
    return ~(((points - u) ** 2).sum(axis=1) <= limit)
