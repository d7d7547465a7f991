"""MeshMotion: how the mesh of a branch's points moves: along with them, not at all, or to where its errors are equal."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from .engine import Engine, Solved

if TYPE_CHECKING:
    from .loop import InterpretedLoop
    from .native import NativeLoop

ALONG = 0.7  # cosine of the angle between a tangent and the way to the next point on a mesh that moves along, at least


class MeshMotion:
    """The motion of the mesh of an engine's problem; where it has no mesh, points stay as they are.

    Parameters
    ----------
    engine : Engine
    """

    def __init__(self, engine: Engine) -> None:
        self.engine, self.moving, self.adaptive = engine, engine.moving, engine.adaptive

    @cached_property
    def standing_loop(self) -> InterpretedLoop | NativeLoop:
        """The loop of a mesh that stands where it is."""
        return self.engine.loop_with(self.engine.metric._replace(moving=None))

    def steered(self, point: Solved) -> Solved:
        """The point, with the direction along which the mesh moves with the solution."""
        return point if self.moving is None else self._along(point, self.moving.steer)

    def standing(self, point: Solved) -> Solved:
        """The point, with the direction along which the mesh stands where it is."""
        return point if self.moving is None else self._along(point, self.moving.stand)

    def _along(self, point: Solved, change: Callable[[np.ndarray, np.ndarray], None]) -> Solved:
        tangent = point.tangent.copy()
        change(point.u, tangent)
        return point._replace(tangent=self.engine.unit(tangent))

    def carried(self, u: np.ndarray, other: np.ndarray, tangent: np.ndarray) -> np.ndarray | None:
        """Unknowns as they read on the mesh of those of the next point, where the mesh was adapted between both; else None.

        There the way from one to the other is not along the tangent.
        """
        if self.moving is None:
            return None
        engine = self.engine
        chord, direction = engine.join(other - u, 0.0), engine.join(tangent[:-1], 0.0)
        along = engine.inner(direction, chord) > ALONG * engine.norm(chord) * engine.norm(direction)
        return None if along else self.moving.carried(u, other)

    def adapted(self, history: list[Solved], still: bool = False) -> list[Solved]:
        """The last points of a branch; where the mesh, or the phase that is kept, no longer suits the last one, that one alone, on a mesh that does.

        So it is, too, where the mesh is to stand still.
        """
        engine, problem = self.engine, self.adaptive
        if problem is None:
            return history
        last, image = history[-1], problem.adapted(history[-1].u)
        if image is None and problem.in_phase(last.u) and not still:
            return history
        problem.anchor(last.u, last.p)
        last = self.standing(last)
        if image is not None:
            u, direction = image(last.u), image(last.tangent[:-1], True)
            problem.anchor(u, last.p)
            found = engine.across(u, last.p, engine.unit(engine.join(direction, float(last.tangent[-1]))))
            if found is None or self._past_a_border(last, found):
                # a border is met with the next steps on the mesh on which it is not there yet
                problem.anchor(last.u, last.p)
            else:
                last = found
        return [last if still else self.steered(last)]

    def _past_a_border(self, before: Solved, after: Solved) -> bool:
        margin = self.engine.smallest_margin
        return bool(margin(before.row) >= 0.0 > margin(after.row))

    def solved(self, guess: Solved) -> Solved | None:
        """The solution across the tangent of a guess, in phase with that."""
        assert self.adaptive is not None
        self.adaptive.anchor(guess.u, guess.p)
        guess = self.standing(guess)
        found = self.engine.across(guess.u, guess.p, guess.tangent)
        found = None if found is None else self.steered(found)
        self.adaptive.anchor(None)
        return found

    def release(self) -> None:
        """Keep the phase of no solution any more."""
        if self.adaptive is not None:
            self.adaptive.anchor(None)
