"""The kernels of one built-in machine in Python and numpy: maps of its cycles, and the stepper (:mod:`orbits.machines.stepping`)."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from orbits.machines.reference import (
    driven_margins,
    driven_motion,
    driven_stepper,
    legs,
    maps,
    shaken_margins,
    shaken_motion,
    shaken_stepper,
)
from orbits.machines.reference.law import DRIVEN, LAWS, Law
from orbits.machines.stepping import FAILED

if TYPE_CHECKING:
    from types import ModuleType

    from orbits.arguments import CycleData, Workspace


class Reference:
    """Maps, margins and stepper of the machine called `name`."""

    def __init__(self, name: str) -> None:
        self.name, self.law_of = name, LAWS[name]
        shaken = name not in DRIVEN
        self._margins = shaken_margins.margins if shaken else driven_margins.margins
        self._motion: ModuleType = shaken_motion if shaken else driven_motion
        self._launch = legs.launch if shaken else driven_stepper.launch
        self._advance = shaken_stepper.advance if shaken else driven_stepper.advance

    def law(self, params: np.ndarray) -> Law[float]:
        """The numbers of the equations of motion."""
        with np.errstate(all="ignore"):
            return self.law_of([*np.asarray(params, dtype=float)])

    # ------------------------------------------------------------------ cycles
    def linearise(self, data: CycleData, u: np.ndarray, p: float, work: Workspace) -> float:
        """Residuals and derivatives at the cycle `u`; see `orbits.machines.reference.maps.linearise`."""
        return maps.linearise(self.law_of, data, u, p, work)

    def margins(self, data: CycleData, u: np.ndarray, p: float, work: Workspace, out: np.ndarray) -> None:
        """Margins of admissibility, four numbers per node, from the last `linearise`."""
        self._margins(self.law(work.numbers), data, u, work, out)

    def unpin(self, data: CycleData, work: Workspace) -> None:
        """Put the displacement equation back, for the multipliers."""
        maps.unpin(data, work)

    # ------------------------------------------------------------------ simulation
    @np.errstate(all="ignore")
    def launch(self, state: np.ndarray, params: np.ndarray) -> None:
        """Reduce the phase and set the mode of a start; contract, item 2."""
        self._launch(self.law(params), state)

    @np.errstate(all="ignore")
    def advance(
        self,
        state: np.ndarray,
        params: np.ndarray,
        until: float,
        codes: np.ndarray,
        modes: np.ndarray,
        rows: np.ndarray,
    ) -> tuple[int, int]:
        """Run from event to event; contract, item 3."""
        try:
            return self._advance(self.law(params), state, until, codes, modes, rows)
        except (OverflowError, ValueError):  # of a number that is no longer finite
            return 0, FAILED

    @np.errstate(all="ignore")
    def sample(self, states: np.ndarray, params: np.ndarray, ahead: np.ndarray, out: np.ndarray) -> None:
        """w, w', v, v' at given phases after given states; contract, item 4."""
        self._motion.sample(self.law(params), states, ahead, out)

    @np.errstate(all="ignore")
    def works(self, states: np.ndarray, params: np.ndarray, ahead: np.ndarray, out: np.ndarray) -> None:
        """Works inside pieces of segments; contract, item 5."""
        self._motion.works(self.law(params), states, ahead, out)

    def energies(self, states: np.ndarray, params: np.ndarray, out: np.ndarray) -> None:
        """Energies of states; contract, item 5."""
        self._motion.energies(self.law(params), states, out)

    @np.errstate(all="ignore")
    def shapes(self, states: np.ndarray, params: np.ndarray, lengths: np.ndarray, out: np.ndarray) -> None:
        """See `orbits.machines.reference.driven_motion.shapes`."""
        driven_motion.shapes(self.law(params), states, lengths, out)


@cache
def reference(name: str) -> Reference:
    """The reference of the machine called `name`, made once."""
    return Reference(name)
