"""The absorber at rest in a cavity that is shaken harmonically."""

from __future__ import annotations

import numpy as np

AMPLITUDE, FRICTION, GRAVITY, MASS_RATIO, FREQUENCY = 0, 2, 3, 4, 5


class ShakenRest:
    """See `orbits.machines.rest.Rest`; the one unknown is the absorber's position, kept in the middle."""

    unknowns = 1

    def equations(self, params: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return np.eye(1), np.zeros(1)

    def reserve(self, params: np.ndarray, u: np.ndarray) -> float:
        """a - C Omega^2."""
        a = (1.0 + float(params[MASS_RATIO])) * float(params[FRICTION]) * float(params[GRAVITY])
        return a - float(params[AMPLITUDE]) * float(params[FREQUENCY]) ** 2

    def multipliers(self, params: np.ndarray) -> np.ndarray:
        return np.zeros(0, complex)

    def cavity_motion(
        self, params: np.ndarray, u: np.ndarray, phase: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        amplitude, omega = params[AMPLITUDE], params[FREQUENCY]
        return amplitude * np.sin(phase), amplitude * omega * np.cos(phase)

    def measure(self, name: str, params: np.ndarray, u: np.ndarray) -> float:
        return float(params[AMPLITUDE]) ** 2 if name == "C2" else np.nan
