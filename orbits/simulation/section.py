"""The motion of a machine seen once per period of a cycle, by simulation.

The section is where the forcing passes phase zero; of a self-excited machine just after the event with which the cycle begins.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from orbits.flows.protocol import SimulationError, Simulator, later

if TYPE_CHECKING:
    from orbits.words import Word


class Section:
    """A stroboscopic section.

    Parameters
    ----------
    simulator : Simulator
    word : Word
        Of the cycle.
    periods : int
        Forcing periods of the cycle.
    unit : ndarray, shape (n,)
        What 1 is in each of the first node's unknowns, in the simulator's units.
    """

    def __init__(self, simulator: Simulator, word: Word, periods: int, unit: np.ndarray) -> None:
        self.simulator, self.word, self.periods, self.unit = simulator, word, periods, unit

    @property
    def names(self) -> tuple[str, ...]:
        """The coordinates of a point."""
        return self.simulator.names

    def through(self, u: np.ndarray) -> np.ndarray:
        """Where the motion that begins with the first of the nodes u passes phase zero next, shape (d,)."""
        return self.rounds(u, 1)[0]

    def rounds(self, u: np.ndarray, count: int | None = None) -> np.ndarray:
        """Where the cycle passes phase zero, once per forcing period, shape (periods, d)."""
        points = np.full((count or self.periods, len(self.names)), np.nan)
        try:
            self.simulator.begin(self.word, np.asarray(u, dtype=float)[: len(self.unit)] * self.unit)
            first = math.floor(self.simulator.time) + 1.0
            for k in range(len(points)):
                self.simulator.follow(first + k)
                points[k] = self.simulator.point
        except SimulationError:
            pass  # it does not come back
        return points

    def step(self, x: np.ndarray) -> np.ndarray:
        """One period of the cycle later; NaN where the motion does not come back."""
        return later(self.simulator, x, float(self.periods))

    def struck(self, x: np.ndarray, near: float) -> tuple[np.ndarray, np.ndarray] | None:
        """Of a point at a wall the other one there, just after the impact or just before it, and the direction away from the wall; None elsewhere."""
        return self.simulator.struck(x, near)
