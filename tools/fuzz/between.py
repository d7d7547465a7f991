"""Orbits between the points of a branch, which the diagram has not computed."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from contvines.bifurcation.locate import Segment
from contvines.continuation.engine import Engine, Solved
from contvines.continuation.settings import Settings

FAR = 1e-2  # largest distance from a point, in the metric of the continuation (the interval has length 1)


class Between:
    """Access to orbits between the points of a branch.

    Parameters
    ----------
    branch : Branch
    within : (float, float)
        Interval of the parameter.
    """

    def __init__(self, branch: Any, within: tuple[float, float]) -> None:
        self.branch = branch
        self.engine = Engine(branch.problem, within, Settings())

    def segment(self, i: int, towards: int = 1) -> Segment:
        """Return the segment from point i to the next one (for -1: to the one before)."""
        branch, engine = self.branch, self.engine
        ends = (
            Solved(
                branch.points[k],
                float(branch.values[k]),
                towards * engine.unit(branch.tangents[k]),
                np.zeros(engine.row_size),
                0.0,
                0.0,
                0.0,
            )
            for k in (i, i + towards)
        )
        return Segment(engine, *ends)

    def orbit(self, i: int, share: float) -> Any:
        """Return the orbit at a share of the way from point i to the next; None if the equations are not solved."""
        found = self.segment(i).at(share)
        return None if found is None else self.branch.problem.orbit(found.u, found.p)

    def beside(self, i: int, towards: int, parts: tuple[float, ...]) -> Iterator[tuple[float, Any]]:
        """Yield distances from point i and the orbits there; distances are `parts` of `FAR`, or of the way to the next point if this is shorter."""
        segment = self.segment(i, towards)
        if not segment.length > 0.0:
            return
        far = min(FAR, segment.length)
        for part in parts:
            found = segment.at(part * far / segment.length)
            if found is not None:
                yield part * far, self.branch.problem.orbit(found.u, found.p)

    def ways(self, i: int) -> list[int]:
        """Return the directions in which the branch continues from point i."""
        return [way for way in (-1, 1) if 0 <= i + way < len(self.branch)]
