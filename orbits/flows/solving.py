"""Newton's method on the equations of a cycle."""

from __future__ import annotations

import numpy as np

from orbits.flows.protocol import Equations
from orbits.settings import SOLVING


def newton(
    system: Equations,
    guess: np.ndarray,
    p: float,
    border: np.ndarray | None = None,
    limit: int = 40,
) -> tuple[np.ndarray, float, float, np.ndarray]:
    """Solve F(u, p) = 0 at fixed p, or in the hyperplane of `border` through the guess.

    Returns
    -------
    u : float array (N,)
    p : float
    residual : float
        Infinity where it does not converge.
    tangent : float array (N + 1,)
        Direction of the branch, not normalised.
    """
    row = np.zeros(system.dimension + 1)
    row[-1] = 1.0
    if border is not None:
        row[:] = border
    step, tangent = np.empty_like(row), np.empty_like(row)
    u = np.array(guess, dtype=float)
    residual, _, p = system.kernels.newton(
        system.data, u, p, system.scratch, row, step, tangent, SOLVING.last_step, limit
    )
    return u, float(p), float(residual), tangent


def solved_nodes(
    system: Equations, nodes: np.ndarray, params: np.ndarray, limit: int = 40
) -> np.ndarray | None:
    """Nodes of the solution next to these, at these parameters; None if Newton's method does not converge to one."""
    value = system.value(params)
    u, residual = solved_at(system, system.reduce(nodes), value, limit)
    if not residual < SOLVING.scaled * max(1.0, float(np.abs(u).max(initial=0.0))):
        return None
    return system.expand(u, value)[: len(nodes)]


def solved_at(system: Equations, guess: np.ndarray, p: float, limit: int = 40) -> tuple[np.ndarray, float]:
    """Solution at a parameter value, and its residual (infinite if there is none)."""
    u, _, residual, _ = newton(system, guess, p, limit=limit)
    return u, residual
