"""Chunk: consecutive points of a branch, as arrays."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from ..shared.number_text import number_text
from .engine import Solved


class Status(IntEnum):
    """Status codes of the continuation loop; ``sentence`` says what they mean."""

    RUNNING = 0
    LEFT_INTERVAL = 1
    STEP_TOO_SMALL = 2
    NOT_EVALUABLE = 3
    BORDER = 4
    MAX_POINTS = 5
    CLOSED = 6
    ESCAPED = 7
    CREEPING = 8
    COARSE = 9

    def sentence(self, parameter: str = "p", value: float = float("nan"), unit: float = 1.0) -> str:
        """The status as a sentence about a branch at this parameter value; beside ``unit`` rounding is zero."""
        long, short = number_text(value, 10, unit), number_text(value, 6, unit)
        return {
            Status.RUNNING: "unfinished",
            Status.LEFT_INTERVAL: f"reaches the end of the interval, {parameter} = {short}",
            Status.STEP_TOO_SMALL: f"no convergence near {parameter} = {long}, even with the smallest step",
            Status.NOT_EVALUABLE: f"the equations cannot be evaluated beyond {parameter} = {long}",
            Status.BORDER: f"reaches a border at {parameter} = {long}",
            Status.MAX_POINTS: f"the largest number of points is reached at {parameter} = {short}",
            Status.ESCAPED: f"the unknowns run away near {parameter} = {short}",
            Status.CREEPING: f"creeps near {parameter} = {long}: very many points with next to no progress",
            Status.COARSE: f"the mesh is too coarse beyond {parameter} = {long}",
            Status.CLOSED: "closed: the branch returns to its start",
        }[self]


OF_SOLVED = ("u", "p", "tangent", "row", "sign", "correction")
"""What a chunk has of solved points."""


@dataclass
class Chunk:
    """Consecutive points of a branch; the first one is the last point of the chunk before.

    The loop writes the rows of the next chunk to the same place: copy what is needed later. ``before`` is the point before the
    first one, where there is one.
    """

    points: np.ndarray
    values: np.ndarray
    tangents: np.ndarray
    rows: np.ndarray
    signs: np.ndarray
    corrections: np.ndarray
    status: Status
    before: Solved | None = None

    def __len__(self) -> int:
        return len(self.values)

    @property
    def arrays(self) -> tuple[np.ndarray, ...]:
        """All that is known of the points."""
        return self.points, self.values, self.tangents, self.rows, self.signs, self.corrections

    def cut(self, n: int) -> Chunk:
        """The first n points."""
        return Chunk(*(array[:n] for array in self.arrays), status=self.status, before=self.before)

    def joined(self, other: Chunk) -> Chunk:
        """These points and those of another chunk, with its status."""
        return Chunk(*map(np.concatenate, zip(self.arrays, other.arrays, strict=True)), status=other.status)

    def widened(self) -> Chunk:
        """The chunk with the point before its first one, where there is one."""
        return self if self.before is None else packed([self.before], self.status).joined(self)

    def solved(self, i: int, sign: float | None = None) -> Solved:
        """Point i; with another sign where that is known better."""
        return Solved(
            self.points[i],
            float(self.values[i]),
            self.tangents[i],
            self.rows[i].copy(),
            float(self.signs[i]) if sign is None else sign,
            0.0,
            float(self.corrections[i]),
        )


def packed(points: Sequence[Solved], status: Status) -> Chunk:
    """Some points as a chunk."""
    return Chunk(*(np.array([getattr(point, name) for point in points]) for name in OF_SOLVED), status=status)
