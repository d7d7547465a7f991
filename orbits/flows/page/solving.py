"""Newton's method for single orbits of declared machines, and everything about one solution."""

from __future__ import annotations

from typing import Any

import numpy as np

from orbits.flows.page import flights

SOLVED = 1e-10  # residual of a solution


def newton(
    problem: Any,
    u: np.ndarray,
    p: float,
    border: np.ndarray | None = None,
    tolerance: float = 1e-13,
    limit: int = 40,
) -> tuple[np.ndarray, float, float, np.ndarray]:
    """Solve F(u, p) = 0 at fixed p, or in the hyperplane of `border` through the guess; steps that do not help are halved.

    Returns
    -------
    u : float array (N,)
    p : float
    residual : float
        Infinity where it does not converge.
    tangent : float array (N + 1,)
        Direction of the branch, not normalised.
    """
    size = problem.dimension
    work = problem.workspace()
    row = np.zeros(size + 1)
    row[-1] = 1.0
    if border is not None:
        row[:] = border
    step, tangent = np.empty(size + 1), np.empty(size + 1)
    u = np.array(u, dtype=float)
    residual = flights.linearise(problem, u, p, work)
    for _ in range(limit):
        if not np.isfinite(residual):
            return u, p, np.inf, tangent
        sign = flights.bordered(problem, work, row, 0.0, step, tangent)
        if sign == 0.0 or not np.all(np.isfinite(step)):
            return u, p, np.inf, tangent
        length = float(np.abs(step).max())
        share = 1.0
        while True:
            trial, q = u + share * step[:-1], p + share * float(step[-1])
            found = flights.linearise(problem, trial, q, work)
            if found < residual or length < 1e-7 or share < 0.02:
                break
            share *= 0.5
        u, p, residual = trial, q, found
        if length * share < tolerance or (residual < 1e-14 and length < 1e-9):
            return u, p, residual, tangent
    return u, p, residual if residual < SOLVED else np.inf, tangent


def examined(problem: Any, u: np.ndarray, p: float) -> tuple[float, np.ndarray, np.ndarray]:
    """Residual, multipliers of the closure map and margins of one solution."""
    work = problem.workspace()
    m = problem.n_multipliers
    row = np.full(2 * m + problem.n_margins, np.nan)
    residual = flights.linearise(problem, u, p, work)
    if np.isfinite(residual):
        problem.kernels.inspect(problem, u, p, work, row)
    return residual, row[: 2 * m : 2] + 1j * row[1 : 2 * m : 2], row[2 * m :]
