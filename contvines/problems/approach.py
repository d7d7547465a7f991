"""Approach: from a rough guess to a solution, along the way that Newton's method would take with very small steps.

Full steps of Newton's method may jump over a fold to another solution, or away; damped ones end at the solution to which the guess
belongs, or nowhere. The step lengths are those of Deuflhard, Newton methods for nonlinear problems, Springer 2004, algorithm NLEQ-ERR (section
3.3.3): they depend on no scaling of the equations.
"""

from __future__ import annotations

import math
from typing import Protocol

import numpy as np

from .protocol import Equations, array_of
from .settings import SCALES

STEPS = 80


class RoughProblem(Equations, Protocol):
    """A problem whose equations can be evaluated without their derivatives, and bend over known lengths (`contvines.problems.abilities.Rough`)."""

    @property
    def lengths(self) -> np.ndarray: ...
    def residuals(self, u: np.ndarray, p: float) -> np.ndarray: ...


def approach(problem: RoughProblem, u: np.ndarray, p: float) -> np.ndarray | None:
    """A point near the solution at this parameter value to which damped Newton's method leads; None where it leads nowhere.

    Parameters
    ----------
    problem : RoughProblem
    u : ndarray, shape (N,)
    p : float

    Returns
    -------
    ndarray or None
        Of shape (N,), so near that full steps converge; `u` itself where they do from there.
    """
    work, kernels, n = problem.workspace(), problem.kernels, len(u)
    F = array_of(work)
    border, scale = np.zeros(n + 1), np.maximum(problem.lengths, SCALES.barely * np.abs(u))
    border[n] = 1.0

    def size(correction: np.ndarray) -> float:
        found = float((np.abs(correction) / (scale + np.abs(u))).max())
        return found if found == found else math.inf

    def correction() -> tuple[np.ndarray, float]:
        step, tangent = np.zeros(n + 1), np.zeros(n + 1)
        sign = kernels.bordered(problem.data, work, border, 0.0, step, tangent)
        return step[:n], sign

    def linearised(at: np.ndarray) -> bool:
        return bool(kernels.linearise(problem.data, at, p, work) < math.inf)

    u, damping = np.array(u, dtype=float), 1.0
    if not linearised(u):
        return None
    step, sign = correction()
    for _ in range(STEPS):
        length = size(step)
        if not length < math.inf:
            return None
        if length < SCALES.near:
            return u
        while True:
            if damping < SCALES.shortest:
                return None
            trial = u + damping * step
            F[:] = _value(problem, trial, p)
            simplified = correction()[0] if np.isfinite(F).all() else np.full(n, np.nan)
            if size(simplified) < (1.0 - 0.25 * damping) * length and linearised(trial):
                ahead, there = correction()
                if there * sign >= 0.0:
                    break
                linearised(
                    u
                )  # a singular Jacobian lies between: what is behind it belongs to another solution
            bend = size(simplified - (1.0 - damping) * step)
            shorter = 0.5 * length * damping**2 / bend if 0.0 < bend < math.inf else 0.0
            damping = min(max(shorter, 0.1 * damping), 0.5 * damping)
        gap = size(simplified - ahead) * size(ahead)
        damping = min(1.0, damping * length * size(simplified) / gap) if gap > 0.0 else 1.0
        u, step, sign = trial, ahead, there
    return None


def _value(problem: RoughProblem, u: np.ndarray, p: float) -> np.ndarray:
    """F, or not a number where it cannot be evaluated."""
    with np.errstate(all="ignore"):
        try:
            return problem.residuals(u, p)
        except ArithmeticError:
            return np.full(len(u), np.nan)
