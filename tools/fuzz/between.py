"""Orbits between the points of a branch, which the diagram itself has never looked at."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from contvines.bifurcation.locate import Segment
from contvines.continuation.engine import Engine, Solved
from contvines.continuation.settings import Settings

FAR = 1e-2  # in the metric of the continuation, in which the interval has length 1


class Between:
    """Any point of a branch.

    Parameters
    ----------
    branch : Branch
    within : (float, float)
        Interval of the diagram.
    """

    def __init__(self, branch: Any, within: tuple[float, float]) -> None:
        self.branch = branch
        self.engine = Engine(branch.problem, within, Settings())

    def segment(self, i: int, towards: int = 1) -> Segment:
        """From point i to the next one (or the one before, for -1)."""
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
        """The orbit at a share of the way from point i to the next; None where it cannot be solved for."""
        found = self.segment(i).at(share)
        return None if found is None else self.branch.problem.orbit(found.u, found.p)

    def beside(self, i: int, towards: int, parts: tuple[float, ...]) -> Iterator[tuple[float, Any]]:
        """Distances from point i, parts of `FAR` or of the way to the next point where that is shorter, and the orbits there."""
        segment = self.segment(i, towards)
        if not segment.length > 0.0:
            return
        far = min(FAR, segment.length)
        for part in parts:
            found = segment.at(part * far / segment.length)
            if found is not None:
                yield part * far, self.branch.problem.orbit(found.u, found.p)

    def ways(self, i: int) -> list[int]:
        """Directions in which the branch goes on from point i."""
        return [way for way in (-1, 1) if 0 <= i + way < len(self.branch)]
