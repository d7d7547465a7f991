"""What many starts settle on: a machine's attractors at one value, each solved once, with the starts that reach it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from orbits.attractors.motion import SOLVED, Motion, distinct
from orbits.population.native import NativeStarts
from orbits.population.sorting import Sorting, low_discrepancy
from orbits.problem import rebuild

if TYPE_CHECKING:
    from orbits.machines.varying import Varying

DRAWS = 64  # times as many starts are drawn at most to find those outside the walls


class Population:
    """Starts of a machine and what they settle on, against one of its parameters.

    Parameters
    ----------
    model : Model or Machine
    parameter : str
        The one that varies.
    parameters : mapping
        All that are no fields of the machine, or replace them.
    workers : int, optional
        Threads; all cores by default. Results do not depend on it.

    Raises
    ------
    ValueError
        If the machine has no such parameter.
    """

    def __init__(
        self,
        model: Varying,
        parameter: str,
        parameters: Mapping[str, float] | None = None,
        workers: int | None = None,
    ) -> None:
        self.model, self.parameter = model, parameter
        self.parameters = {k: v for k, v in dict(parameters or {}).items() if k != parameter}
        kind: type = NativeStarts
        if model.flow == "page":
            from orbits.population.page import PageStarts as kind
        self._sort = kind(model, parameter, self.parameters)
        self.workers = workers
        self.across, self.brief, self.price = self._sort.across, self._sort.brief, self._sort.price
        self.notation, self.leftward = self._sort.notation, self._sort.leftward
        self.work = 0.0
        """Forcing periods simulated so far, those that solve for cycles included; of a self-excited machine its time over 2 pi."""

    @property
    def about(self) -> dict[str, Any]:
        """The machine's name and settings, or its page."""
        return self.model.settings()

    @property
    def names(self) -> tuple[str, ...]:
        """Coordinates of a start: the phase of a forced machine, then positions and velocities."""
        return self._sort.names

    @property
    def units(self) -> dict[str, str]:
        """Units of parameters and measures by name; none where all are plain numbers."""
        return self.model.units

    def gauges(self, names: Sequence[str], p: float) -> dict[str, tuple[float, str]]:
        """What one of these coordinates is in the unit that is shown, and that unit; plain numbers have none."""
        return self._sort.gauges([name for name in names if name != "phase"], self.vector(p))

    def vector(self, p: float) -> np.ndarray:
        """All parameters at the value `p` of the one that varies, shape (P,)."""
        return self._sort.vector(p)

    def box(self, p: float) -> np.ndarray:
        """Smallest and largest coordinate of the starts, shape (n, 2).

        Of a built-in machine the cavity, and the velocities its walls can give; of a declared machine what it says (``starts=``), else twice what the motion
        from rest reaches in sixty periods.
        """
        return self._sort.box(p)

    def starts(self, count: int, seed: int, p: float) -> np.ndarray:
        """Low-discrepancy starts in the box and outside the walls, shape (count, n).

        Raises
        ------
        ValueError
            If the walls leave nearly none of the box.
        """
        box, params = self.box(p), self.vector(p)
        kept: list[np.ndarray] = []
        drawn = 0
        while sum(map(len, kept)) < count:
            if drawn > DRAWS * max(count, 2):
                raise ValueError(
                    f"the walls of {self.model.name!r} leave nearly none of the box of starts at {self.parameter} = {p:g}; "
                    "say in the machine file where starts are drawn: Machine(..., starts={'x': (low, high)})"
                )
            points = box[:, 0] + low_discrepancy(len(box), count, seed, drawn) * (box[:, 1] - box[:, 0])
            drawn += len(points)
            kept.append(points[self._sort.free(points, params)])
        return np.concatenate(kept)[:count]

    def settle(self, starts: np.ndarray, p: float) -> tuple[list[Motion], np.ndarray, np.ndarray]:
        """Simulate all starts and recognise what they settle on.

        Parameters
        ----------
        starts : float array (m, n)
        p : float

        Returns
        -------
        motions : list of Motion
            In the order of their first start. Starts inside a wall are ``impossible``.
        index : int array (m,)
            Which motion each start reaches.
        mirrored : bool array (m,)
            Whether it reaches the mirror image of that motion.
        """
        starts = np.asarray(starts, dtype=float)
        fleet = self._sort.fleet(starts, self.vector(p), self.workers)
        try:
            return Sorting(len(starts), self.parameter, p).sort(fleet)
        finally:
            self.work += fleet.work

    def embedded(self, state: np.ndarray, p: float) -> list[tuple[Any, np.ndarray]]:
        """Unstable cycles that the chaotic motion through a state passes near, each once, as problems with their unknowns.

        Parameters
        ----------
        state : float array (S,)
            `Motion.state` of a chaotic motion.
        p : float
        """
        from orbits.attractors.embedded import embedded_cycles

        params = self.vector(p)
        simulator = self._sort.simulator(params, state)
        cycles = list(embedded_cycles(simulator, self._sort.longest, self._sort.solver(params, wide=True)))
        self.work += simulator.time + SOLVED * len(cycles)
        return distinct(cycles, self.parameter, p)

    def returning(self, starts: np.ndarray, p: float) -> list[tuple[Any, np.ndarray]]:
        """Cycles, stable or not, that are known in closed form or to which Newton's method leads from starts, each once.

        Rest and sliding between the walls are in closed form: their mean position is free, so no start leads Newton's method to them. Of a
        self-excited machine none.

        Parameters
        ----------
        starts : float array (m, n)
        p : float
        """
        from orbits.attractors.returning import returning_cycles

        params = self.vector(p)
        simulator = self._sort.simulator(params)
        if not simulator.forced:
            return []
        starts, solver = np.asarray(starts, dtype=float), self._sort.solver(params)
        cycles = list(returning_cycles(simulator, starts, self.box(p), self._sort.longest, solver))
        self.work += SOLVED * (len(starts) + len(cycles))
        return distinct((*self._sort.closed(params), *cycles), self.parameter, p)

    def closed(self, p: float) -> list[tuple[Any, np.ndarray]]:
        """The real motions known in closed form, stable or not: of built-in machines rest, sliding between the walls, symmetric impacts."""
        return distinct(self._sort.closed(self.vector(p)), self.parameter, p)

    def restored(self, description: Mapping[str, Any], u: np.ndarray, p: float) -> Any:
        """The problem of a motion that a journal remembers, as `settle` had it; None where it cannot be rebuilt."""
        return rebuild(description)

    def observed(self, state: np.ndarray | None, p: float) -> dict[str, float]:
        """Measures, in the machine's units, of the motion through a state; those of a sweep."""
        return {} if state is None else self._sort.observed(state, p)
