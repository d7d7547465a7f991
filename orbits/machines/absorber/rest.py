"""The absorber at rest in a level cavity."""

from __future__ import annotations

import numpy as np

from orbits.machines.cavity.shaken_rest import ShakenRest

AMPLITUDE, FRICTION, GRAVITY, MASS_RATIO, FREQUENCY = 0, 2, 3, 4, 5


class LevelRest(ShakenRest):
    """The same resistance in both directions."""

    amplitude, frequency = AMPLITUDE, FREQUENCY

    def reserve(self, params: np.ndarray, u: np.ndarray) -> float:
        """a - C Omega^2."""
        a = (1.0 + float(params[MASS_RATIO])) * float(params[FRICTION]) * float(params[GRAVITY])
        return a - self.shaking(params)
