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


class InclinedRest:
    """See `orbits.machines.rest.Rest`; the one unknown is the absorber's position, kept at w = 0."""

    unknowns = 1

    def equations(self, params: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return np.eye(1), np.zeros(1)

    def reserve(self, params: np.ndarray, u: np.ndarray) -> float:
        """Of the two directions the nearer to slipping."""
        return min(self.reserves(params))

    def reserves(self, params: np.ndarray) -> tuple[float, float]:
        """Of both directions: a_left + b - C Omega^2 and a_right - b - C Omega^2."""
        weight = (1.0 + float(params[MASS_RATIO])) * float(params[GRAVITY])
        normal, b = weight * math.cos(params[SLOPE]), weight * math.sin(params[SLOPE])
        shaking = float(params[AMPLITUDE]) * float(params[FREQUENCY]) ** 2
        left, right = normal * float(params[FRICTION_LEFT]), normal * float(params[FRICTION_RIGHT])
        return left + b - shaking, right - b - shaking

    def multipliers(self, params: np.ndarray) -> np.ndarray:
        return np.zeros(0, complex)

    def cavity_motion(
        self, params: np.ndarray, u: np.ndarray, phase: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        amplitude, omega = params[AMPLITUDE], params[FREQUENCY]
        return amplitude * np.sin(phase), amplitude * omega * np.cos(phase)

    def measure(self, name: str, params: np.ndarray, u: np.ndarray) -> float:
        return float(params[AMPLITUDE]) ** 2 if name == "C2" else np.nan
