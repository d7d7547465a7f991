"""Newton's method on the equations of a cycle, at fixed parameters."""

from __future__ import annotations

import numpy as np

from orbits.flows.protocol import Equations


def solved_at(
    system: Equations, guess: np.ndarray, p: float, tolerance: float = 1e-12, limit: int = 40
) -> tuple[np.ndarray, float]:
    """Solution at a parameter value by Newton's method, and its residual (infinite if there is none)."""
    border = np.zeros(system.dimension + 1)
    border[-1] = 1.0
    step, tangent = np.empty_like(border), np.empty_like(border)
    u = guess.copy()
    residual, _, _ = system.kernels.newton(
        system.data, u, p, system.scratch, border, step, tangent, tolerance, limit
    )
    return u, float(residual)
