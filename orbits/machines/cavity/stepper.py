"""Event-driven stepper of a cavity in plain Python: `orbits.machines.cavity.simulation` with a machine's numbers.

It is the reference of the native core (`native/shaken.hpp`). The signatures are those of :mod:`orbits.machines.stepping`.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from orbits.machines.cavity.law import Law
from orbits.machines.cavity.legs import launch_with
from orbits.machines.cavity.motion import energies_with, sample_with, works_with
from orbits.machines.cavity.numbers import law
from orbits.machines.cavity.simulation import advance_with
from orbits.machines.stepping import FAILED

STATE = 6
ROW = 5


class ShakenStepper:
    """The functions of the contract for a machine whose equations of motion are a cavity's.

    Parameters
    ----------
    law : callable
        The numbers of the equations of motion (`orbits.machines.cavity.law.Law`) from the parameters.
    """

    def __init__(self, law: Callable[[np.ndarray], Law]) -> None:
        self.law = law

    @np.errstate(all="ignore")
    def launch(self, state: np.ndarray, params: np.ndarray) -> None:
        """Set the mode of a start; contract, item 2."""
        launch_with(self.law(params), state)

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
            return advance_with(self.law(params), state, until, codes, modes, rows)
        except (OverflowError, ValueError):  # of a number that is no longer finite
            return 0, FAILED

    @np.errstate(all="ignore")
    def sample(self, states: np.ndarray, params: np.ndarray, ahead: np.ndarray, out: np.ndarray) -> None:
        """w, w', v, v' at given phases after given states; contract, item 4."""
        sample_with(self.law(params), states, ahead, out)

    @np.errstate(all="ignore")
    def works(self, states: np.ndarray, params: np.ndarray, ahead: np.ndarray, out: np.ndarray) -> None:
        """Work of the shaking, of the damper (none) and of friction inside pieces of segments; contract, item 5."""
        works_with(self.law(params), states, ahead, out)

    @np.errstate(all="ignore")
    def energies(self, states: np.ndarray, params: np.ndarray, out: np.ndarray) -> None:
        """Energy that these works change; contract, item 5."""
        energies_with(self.law(params), states, out)


stepper = ShakenStepper(law)
launch, advance, sample = stepper.launch, stepper.advance, stepper.sample
works, energies = stepper.works, stepper.energies
