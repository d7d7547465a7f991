"""Chunk: consecutive points of a branch, as arrays."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .engine import Solved
from .status import Status


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

    def cut(self, n: int) -> Chunk:
        """The first n points."""
        return Chunk(
            self.points[:n],
            self.values[:n],
            self.tangents[:n],
            self.rows[:n],
            self.signs[:n],
            self.corrections[:n],
            self.status,
            self.before,
        )

    def widened(self) -> Chunk:
        """The chunk with the point before its first one, where there is one."""
        first = self.before
        if first is None:
            return self
        return Chunk(
            np.vstack([first.u, self.points]),
            np.append(first.p, self.values),
            np.vstack([first.tangent, self.tangents]),
            np.vstack([first.row, self.rows]),
            np.append(first.sign, self.signs),
            np.append(first.correction, self.corrections),
            self.status,
        )

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
