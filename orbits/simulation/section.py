"""The motion of a machine seen once per period of a cycle, by simulation.

The section is where the forcing passes phase zero; of a self-excited machine just after the event with which the cycle begins.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from orbits.flows.protocol import SimulationError, Simulator

if TYPE_CHECKING:
    from orbits.words import Word


class Section:
    """A section of the motions of a machine.

    Parameters
    ----------
    simulator : Simulator
    word : Word
        Of the cycle.
    periods : int
        Forcing periods of the cycle.
    unit : ndarray, shape (n,)
        What 1 is in each of the first node's unknowns, in the simulator's units.
    index : int
        Of the parameter by which `varied` differentiates.
    """

    def __init__(self, simulator: Simulator, word: Word, periods: int, unit: np.ndarray, index: int) -> None:
        self.simulator, self.word, self.periods = simulator, word, periods
        self.unit, self.index = unit, index

    @property
    def names(self) -> tuple[str, ...]:
        """The coordinates of a point."""
        return self.simulator.names

    def through(self, u: np.ndarray) -> np.ndarray:
        """Where the motion that begins with the first of the nodes u passes the section next, shape (d,)."""
        return self.rounds(u, 1)[0]

    def rounds(self, u: np.ndarray, count: int | None = None) -> np.ndarray:
        """Where the cycle passes the section, once per forcing period, shape (periods, d)."""
        node = np.asarray(u, dtype=float)[: len(self.unit)] * self.unit
        if not self.simulator.forced:
            return node[None, 1:]
        points = np.full((count or self.periods, len(self.names)), np.nan)
        try:
            self.simulator.begin(self.word, node)
            first = math.floor(self.simulator.time) + 1.0
            for k in range(len(points)):
                self.simulator.follow(first + k)
                points[k] = self.simulator.point
        except SimulationError:
            pass  # it does not come back
        return points

    def step(self, x: np.ndarray) -> np.ndarray:
        """One period of the cycle later; NaN where the motion does not come back."""
        return self._later(x, None)[0]

    def varied(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """`step` with its derivatives by x, shape (d, d), and by the parameter, shape (d,); NaN where the simulator does not know them."""
        return self._later(x, self.index)

    def struck(self, x: np.ndarray, near: float) -> tuple[np.ndarray, np.ndarray] | None:
        """Of a point at a wall the other one there, just after the impact or just before it, and the direction away from the wall; None elsewhere."""
        return self.simulator.struck(x, near)

    def _later(self, x: np.ndarray, index: int | None) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        simulator, n = self.simulator, len(x)
        try:
            simulator.start(x, 0.0, None if simulator.forced else self.word.entries(0))
            by_state, by_value = simulator.go_round(self.word, self.periods, index)
        except SimulationError:
            return np.full(n, np.nan), np.full((n, n), np.nan), np.full(n, np.nan)
        return simulator.point, by_state, by_value
