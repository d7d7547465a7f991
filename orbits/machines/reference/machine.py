"""The kernels of one built-in machine in Python and numpy: maps of its cycles, and the stepper (:mod:`orbits.machines.stepping`)."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from orbits.machines.reference import maps, margins, motion, stepper
from orbits.machines.reference.law import LAWS, Law
from orbits.machines.stepping import FAILED

if TYPE_CHECKING:
    from orbits.arguments import CycleData, Workspace


class Reference:
    """Maps, margins and stepper of the machine called `name`."""

    def __init__(self, name: str) -> None:
        self.name, self.law_of = name, LAWS[name]

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
        margins.margins(self.law(work.numbers), data, u, work, out)

    def unpin(self, data: CycleData, work: Workspace) -> None:
        """Put the displacement equation back, for the multipliers."""
        maps.unpin(data, work)

    # ------------------------------------------------------------------ simulation
    @np.errstate(all="ignore")
    def launch(self, state: np.ndarray, params: np.ndarray) -> None:
        """Reduce the phase and set the mode of a start; contract, item 2."""
        stepper.launch(self.law(params), state)

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
            return stepper.advance(self.law(params), state, until, codes, modes, rows)
        except (OverflowError, ValueError):  # of a number that is no longer finite
            return 0, FAILED

    @np.errstate(all="ignore")
    def sample(self, states: np.ndarray, params: np.ndarray, ahead: np.ndarray, out: np.ndarray) -> None:
        """w, w', v, v' at given phases after given states; contract, item 4."""
        motion.sample(self.law(params), states, ahead, out)

    @np.errstate(all="ignore")
    def works(self, states: np.ndarray, params: np.ndarray, ahead: np.ndarray, out: np.ndarray) -> None:
        """Works inside pieces of segments; contract, item 5."""
        motion.works(self.law(params), states, ahead, out)

    def energies(self, states: np.ndarray, params: np.ndarray, out: np.ndarray) -> None:
        """Energies of states; contract, item 5."""
        motion.energies(self.law(params), states, out)

    @np.errstate(all="ignore")
    def shapes(self, states: np.ndarray, params: np.ndarray, lengths: np.ndarray, out: np.ndarray) -> None:
        """See `orbits.machines.reference.motion.shapes`."""
        motion.shapes(self.law(params), states, lengths, out)


@cache
def reference(name: str) -> Reference:
    """The reference of the machine called `name`, made once."""
    return Reference(name)
