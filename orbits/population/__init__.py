"""Attractors of a machine from many starts at one parameter value, each solved once, with the starts that reach it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from contvines.shared.motions import Motion, low_discrepancy
from contvines.shared.near_names import no_parameter
from orbits.flows import flow_of, simulator_of
from orbits.flows.protocol import SimulationError, Simulator
from orbits.machines.base import Model
from orbits.machines.measures import STARTS
from orbits.orbit import Orbit
from orbits.population.fleet import SOLVED, Fleet, Problem, distinct
from orbits.problem import rebuild

if TYPE_CHECKING:
    from orbits.machines.varying import Varying


DRAWS = 64  # starts drawn at most per start wanted, to find those outside the walls


class Population:
    """Starts of a machine and the attractors they reach, with one parameter that varies.

    Parameters
    ----------
    model : Model or Machine
    parameter : str
        Name of the parameter that varies.
    parameters : mapping
        Values of further parameters, in place of the machine's own.
    workers : int, optional
        Threads; all cores by default. The results do not depend on it.

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
        if parameter not in model.amount_names:
            names = model.amount_names
            raise SimulationError(no_parameter(repr(parameter), f"the model {model.name!r}", names))
        self.model, self.parameter = model, parameter
        self.parameters = {k: v for k, v in dict(parameters or {}).items() if k != parameter}
        self.workers = workers
        self.across, self.brief, self.price, self._longest, self._embedded = flow_of(model).census(model)
        own = model.in_cavity  # states of a declared machine are labelled by their own names
        self.notation = STARTS if own else {"phase": STARTS["phase"]}
        self.leftward = "w" if own else ""  # the left wall is at w = +1: this axis is drawn reversed
        self._boxes: dict[float, np.ndarray] = {}
        self.work = 0.0
        """Forcing periods simulated so far, with an equivalent for each solved cycle; of a self-excited machine its time over 2 pi."""

    @property
    def about(self) -> dict[str, Any]:
        """The machine's name and settings, or its machine file."""
        return self.model.settings()

    @property
    def names(self) -> tuple[str, ...]:
        """Coordinates of a start: the phase of a forced machine, then positions and velocities."""
        return (*(["phase"] if self.model.forced else []), *flow_of(self.model).coordinates(self.model))

    @property
    def units(self) -> dict[str, str]:
        """Units of parameters and measures by name; empty if all are dimensionless."""
        return self.model.units

    def gauges(self, names: Sequence[str], p: float) -> dict[str, tuple[float, str]]:
        """Factor from computed to displayed numbers, and the unit's name, of each coordinate that has a unit."""
        return self.model.gauges([name for name in names if name != "phase"], self.vector(p))

    def vector(self, p: float) -> np.ndarray:
        """All parameters, with the varying one at `p`; shape (P,)."""
        return self.model.vector_at(self.parameter, float(p), self.parameters)

    def box(self, p: float) -> np.ndarray:
        """Smallest and largest value of each coordinate of the starts, shape (n, 2).

        For a built-in machine: the cavity, and the velocities that its walls can give. For a declared machine: its ``starts=``, else twice the extent of
        the motion from rest in sixty periods.
        """
        if p not in self._boxes:
            self._boxes[p] = self._simulator(p).box()
        return self._boxes[p]

    def starts(self, count: int, seed: int, p: float) -> np.ndarray:
        """Draw low-discrepancy starts in the box and outside the walls, shape (count, n).

        Raises
        ------
        ValueError
            If the walls leave nearly none of the box.
        """
        box, simulator = self.box(p), self._simulator(p)
        accepted: list[np.ndarray] = []
        drawn = 0
        while sum(map(len, accepted)) < count:
            if drawn > DRAWS * max(count, 2):
                raise ValueError(
                    f"the walls of {self.model.name!r} leave nearly none of the box of starts at {self.parameter} = {p:g}; "
                    "say in the machine file where starts are drawn: Machine(..., starts={'x': (low, high)})"
                )
            points = box[:, 0] + low_discrepancy(len(box), count, seed, drawn + 1) * (box[:, 1] - box[:, 0])
            drawn += len(points)
            accepted.append(points[simulator.free(points)])
        return np.concatenate(accepted)[:count]

    def settle(self, starts: np.ndarray, p: float) -> tuple[list[Motion[Problem]], np.ndarray, np.ndarray]:
        """Simulate all starts and identify the attractors they reach.

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
        fleet = Fleet(self._simulator(p), starts, self._longest, self.workers, self.parameter, p)
        try:
            return fleet.sorted()
        finally:
            self.work += fleet.work

    def embedded(self, state: np.ndarray, p: float) -> list[tuple[Problem, np.ndarray]]:
        """Find unstable cycles near the chaotic motion through a state, each once, as problems with their unknowns.

        Parameters
        ----------
        state : float array (S,)
            `Motion.state` of a chaotic motion.
        p : float
        """
        from orbits.population.cycles import embedded_cycles

        simulator = self._simulator(p, state)
        start_time = simulator.time
        cycles = list(embedded_cycles(simulator, self._embedded))
        self.work += simulator.time - start_time + SOLVED * len(cycles)
        return distinct(cycles, self.parameter, p)

    def returning(self, starts: np.ndarray, p: float) -> list[tuple[Problem, np.ndarray]]:
        """Find cycles, stable or not, by Newton's method on the return map from starts, and those known in closed form, each once.

        Rest and sliding between the walls come from closed forms: their mean position is free, so that Newton's method does not converge to them.
        Empty for a self-excited machine.

        Parameters
        ----------
        starts : float array (m, n)
        p : float
        """
        from orbits.population.cycles import returning_cycles

        simulator = self._simulator(p)
        if not simulator.forced:
            return []
        starts = np.asarray(starts, dtype=float)
        cycles = list(returning_cycles(simulator, starts, self.box(p), self._embedded))
        self.work += SOLVED * (len(starts) + len(cycles))
        return distinct((*self._closed(p), *cycles), self.parameter, p)

    def closed(self, p: float) -> list[tuple[Problem, np.ndarray]]:
        """Real motions known in closed form, stable or not: for built-in machines rest, sliding between the walls and symmetric impacts."""
        return distinct(self._closed(p), self.parameter, p)

    def _closed(self, p: float) -> Iterable[Orbit]:
        from orbits.starts.find import closed_orbits

        model = self.model
        return closed_orbits(model, self.vector(p), Orbit) if isinstance(model, Model) else ()

    def restored(self, description: Mapping[str, Any], u: np.ndarray, p: float) -> Problem | None:
        """Rebuild the problem of a motion from a journal; None if that is not possible."""
        return rebuild(description)

    def observed(self, state: np.ndarray | None, p: float, periods: float = 0.0) -> dict[str, float]:
        """Measures of a sweep, in the machine's units, for the motion through a state; if it is not periodic, over at least `periods`."""
        from orbits.attractors.attractor import described
        from orbits.attractors.search import goes_on

        if state is None:
            return {}
        return described(goes_on(self._simulator(p, state), 0.0, self._longest), periods)[1]

    def _simulator(self, p: float, state: np.ndarray | None = None) -> Simulator:
        """A simulator of this machine, at a state if one is given."""
        simulator = simulator_of(self.model, self.vector(p))
        if state is not None:
            simulator.go_on(state)
        return simulator
