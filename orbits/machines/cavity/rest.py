"""The absorber at rest in a cavity that may be inclined."""

from __future__ import annotations

import math

import numpy as np

from orbits.machines.cavity.numbers import (
    AMPLITUDE,
    FREQUENCY,
    FRICTION_LEFT,
    FRICTION_RIGHT,
    GRAVITY,
    MASS_RATIO,
    SLOPE,
)
from orbits.machines.cavity.shaken_rest import ShakenRest


class InclinedRest(ShakenRest):
    """Gravity along the cavity helps one direction and hinders the other."""

    amplitude, frequency = AMPLITUDE, FREQUENCY

    def reserve(self, params: np.ndarray, u: np.ndarray) -> float:
        """Of the two directions the nearer to slipping."""
        return min(self.reserves(params))

    def reserves(self, params: np.ndarray) -> tuple[float, float]:
        """Of both directions: a_left + b - C Omega^2 and a_right - b - C Omega^2."""
        weight = (1.0 + float(params[MASS_RATIO])) * float(params[GRAVITY])
        normal, b = weight * math.cos(params[SLOPE]), weight * math.sin(params[SLOPE])
        shaking = self.shaking(params)
        left, right = normal * float(params[FRICTION_LEFT]), normal * float(params[FRICTION_RIGHT])
        return left + b - shaking, right - b - shaking
