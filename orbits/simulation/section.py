"""The motion of a machine seen once per period of a cycle, whenever the forcing passes phase zero, by simulation."""

from __future__ import annotations

import numpy as np

from orbits.machines.states import state_of
from orbits.machines.stepping import FAILED, PSI, TURNS, Machine, W
from orbits.simulation.driver import buffers, skip

EVENTS = 4096  # in one period at most


class Section:
    """A stroboscopic section.

    Parameters
    ----------
    engine : Machine
    params : ndarray, shape (P,)
    code, mode : int
        First event of the cycle, and the mode after it.
    periods : int
        Forcing periods of the cycle.
    unit : ndarray, shape (n,)
        What 1 is in each of the first node's unknowns, in the machine's units.
    restitutions : (float, float)
        Of the left and of the right wall.
    """

    def __init__(
        self,
        engine: Machine,
        params: np.ndarray,
        code: int,
        mode: int,
        periods: int,
        unit: np.ndarray,
        restitutions: tuple[float, float],
    ) -> None:
        self.engine, self.params = engine, params
        self.code, self.mode, self.periods, self.unit = code, mode, periods, unit
        self.restitutions = restitutions
        self.places = list(engine.places)
        self.scratch = buffers(engine, 64)

    @property
    def names(self) -> tuple[str, ...]:
        """Position and velocity in the cavity, then those of the centre of mass."""
        return self.engine.coordinates

    def through(self, u: np.ndarray) -> np.ndarray:
        """Where the motion that begins with the first of the nodes u passes phase zero next, shape (d,)."""
        state = self._first(u)
        return self._after(state, float(state[TURNS]) + 1.0)

    def rounds(self, u: np.ndarray) -> np.ndarray:
        """Where the cycle passes phase zero, once per forcing period, shape (periods, d)."""
        state = self._first(u)
        first = float(state[TURNS]) + 1.0
        return np.array([self._after(state, first + k) for k in range(self.periods)])

    def step(self, x: np.ndarray) -> np.ndarray:
        """One period of the cycle later; NaN where the motion is no longer finite, or leaves its cavity at once."""
        state = np.zeros(self.engine.state)
        state[self.places] = x
        left, right = self.engine.walls(self.params)
        if not right <= state[W] <= left:
            return np.full(len(self.places), np.nan)
        self.engine.launch(state, self.params)
        return self._after(state, float(self.periods))

    def struck(self, x: np.ndarray, near: float) -> tuple[np.ndarray, np.ndarray] | None:
        """Of a point at a wall the other one there, just after the impact or just before it, and the direction away from the wall; None elsewhere."""
        for wall, side, r in zip(self.engine.walls(self.params), (1.0, -1.0), self.restitutions):
            if abs(x[0] - wall) < near and x[1] != 0.0:
                other, away = np.array(x, dtype=float), np.zeros(len(x))
                other[0], other[1] = wall, -x[1] * r if side * x[1] > 0.0 else -x[1] / r
                away[0] = -side
                return (other, away) if np.all(np.isfinite(other)) else None
        return None

    def _first(self, u: np.ndarray) -> np.ndarray:
        """The state right after the first event."""
        node = np.asarray(u)[: len(self.unit)] * self.unit
        return state_of(self.engine, self.params, self.code, self.mode, node)

    def _after(self, state: np.ndarray, until: float) -> np.ndarray:
        status = skip(self.engine, state, self.params, until, EVENTS * self.periods, self.scratch)
        if status == FAILED or not abs(state[TURNS] + state[PSI] / (2.0 * np.pi) - until) < 1e-9:
            return np.full(len(self.places), np.nan)
        return state[self.places]
