"""Event-driven simulation of a machine, and sections of its motions once per period of a cycle."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from orbits.flows import simulator_of
from orbits.flows.protocol import SimulationError, Simulator

if TYPE_CHECKING:
    from orbits.machines.varying import Varying
    from orbits.words import Word


Start = Mapping[str, float] | np.ndarray | None
"""Initial state of a simulation: values by name, or the last state of another simulation; None for rest."""

MOST_EVENTS = 1_000_000


def simulate(
    model: Varying,
    start: Mapping[str, float] | np.ndarray | None = None,
    *,
    periods: float | None = None,
    time: float | None = None,
    events: int | None = None,
    **parameters: float,
):
    """Simulate a machine from event to event; `Varying.simulate` documents parameters and result."""
    params = model.vector(parameters)
    if periods is None and time is None and events is None:
        raise SimulationError("neither periods, time nor events are given: say how long to simulate")
    if periods is not None and not model.forced:
        raise SimulationError("periods: a self-excited machine has no forcing to count; give time or events")
    for name, value in (("periods", periods), ("time", time), ("events", events)):
        if value is not None and not (math.isfinite(value) and value >= 0.0):
            raise SimulationError(f"{name} = {value}: give a number, 0 or above")
    simulator = simulator_of(model, params)
    simulator.put(start)
    if periods is None and time is not None:
        periods = (
            time * float(model.phase_speed(params)) / float(model.gauge("time", params)) / (2.0 * math.pi)
        )
    return simulator.run(math.inf if periods is None else periods, MOST_EVENTS if events is None else events)


class Section:
    """A Poincaré section of a machine's motions: phase zero of the forcing; for a self-excited machine, just after the cycle's first event.

    Parameters
    ----------
    simulator : Simulator
    word : Word
        Word of the cycle.
    periods : int
        Forcing periods of the cycle.
    unit : ndarray, shape (n,)
        Unit of each unknown of the first node, in the simulator's numbers.
    index : int
        Index of the parameter by which `varied` differentiates.
    """

    def __init__(self, simulator: Simulator, word: Word, periods: int, unit: np.ndarray, index: int) -> None:
        self.simulator, self.word, self.periods = simulator, word, periods
        self.unit, self.index = unit, index

    @property
    def names(self) -> tuple[str, ...]:
        """Names of a point's coordinates."""
        return self.simulator.names

    def through(self, u: np.ndarray) -> np.ndarray:
        """Next section point of the motion that begins at the first of the nodes u, shape (d,)."""
        return self.rounds(u, 1)[0]

    def rounds(self, u: np.ndarray, count: int | None = None) -> np.ndarray:
        """Section points of the cycle, one per forcing period, shape (periods, d); NaN where the simulation stops."""
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
            pass  # the remaining points stay NaN
        return points

    def step(self, x: np.ndarray) -> np.ndarray:
        """Image of a section point one period of the cycle later; NaN if the motion does not return."""
        return self._later(x, None)[0]

    def varied(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return `step` with its derivatives by x, shape (d, d), and by the parameter, shape (d,); NaN where the simulator has no derivatives."""
        return self._later(x, self.index)

    def struck(self, x: np.ndarray, near: float) -> tuple[np.ndarray, np.ndarray] | None:
        """For a point at a wall: the same point on the other side of the impact (before or after it), and the direction away from the wall; None elsewhere."""
        return self.simulator.struck(x, near)

    def _later(self, x: np.ndarray, index: int | None) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        simulator, n = self.simulator, len(x)
        try:
            simulator.start(x, 0.0, None if simulator.forced else self.word.entries(0))
            by_state, by_value = simulator.go_round(self.word, self.periods, index)
        except SimulationError:
            return np.full(n, np.nan), np.full((n, n), np.nan), np.full(n, np.nan)
        return simulator.point, by_state, by_value
