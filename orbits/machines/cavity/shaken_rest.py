"""The absorber at rest in a cavity that is shaken harmonically, whatever holds it there."""

from __future__ import annotations

from typing import ClassVar

import numpy as np


class ShakenRest:
    """See `orbits.machines.rest.Rest`; the one unknown is the absorber's position, kept at w = 0.

    Machines say where their amplitude and frequency stand among the parameters, and what friction has in reserve.
    """

    unknowns = 1
    amplitude: ClassVar[int]
    frequency: ClassVar[int]

    def equations(self, params: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return np.eye(1), np.zeros(1)

    def shaking(self, params: np.ndarray) -> float:
        """Largest acceleration of the cavity, C Omega^2."""
        return float(params[self.amplitude]) * float(params[self.frequency]) ** 2

    def reserve(self, params: np.ndarray, u: np.ndarray) -> float:
        """What friction holds beyond the shaking."""
        raise TypeError(f"{type(self).__name__} has no friction")

    def multipliers(self, params: np.ndarray) -> np.ndarray:
        return np.zeros(0, complex)

    def cavity_motion(
        self, params: np.ndarray, u: np.ndarray, phase: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        amplitude, omega = params[self.amplitude], params[self.frequency]
        return amplitude * np.sin(phase), amplitude * omega * np.cos(phase)

    def measure(self, name: str, params: np.ndarray, u: np.ndarray) -> float:
        return float(params[self.amplitude]) ** 2 if name == "C2" else np.nan
