"""The motion without events: while friction holds, the absorber rides with the cavity.

Its equations are linear, K u = f with few unknowns, and its only border is the slip, where the shaking first beats friction.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np


class Rest(Protocol):
    """What a machine knows of its absorber at rest; parameter vectors have shape (P,), unknowns (N,)."""

    unknowns: int
    """Number N of unknowns."""

    def equations(self, params: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Matrix K (N, N) and right-hand side f (N,)."""
        ...

    def reserve(self, params: np.ndarray, u: np.ndarray) -> float:
        """Friction acceleration left before the absorber slips."""
        ...

    def multipliers(self, params: np.ndarray) -> np.ndarray:
        """Multipliers over one forcing period, complex, shape (m,) with m the same for all parameters."""
        ...

    def cavity_motion(
        self, params: np.ndarray, u: np.ndarray, phase: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """v and v' at some phases."""
        ...

    def measure(self, name: str, params: np.ndarray, u: np.ndarray) -> float:
        """A measure that has a meaning without events; nan for any other."""
        ...
