"""Newton's method for a single cycle at fixed parameters, with a mesh that is adapted and refined until the error is small."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar

import numpy as np

from .kernels import bordered, linearise

if TYPE_CHECKING:
    from .cycle_mesh import CycleMesh

Cycles = TypeVar("Cycles", bound="CycleMesh")

SWEEPS = 40
ROUNDS = 8  # of a mesh that is adapted


def solved(problem: CycleMesh, u: np.ndarray, p: float) -> np.ndarray | None:
    """The cycle near a guess at a fixed parameter; None if Newton's method does not converge."""
    n, work = problem.dimension, problem.workspace()
    border, step, tangent = np.zeros(n + 1), np.zeros(n + 1), np.zeros(n + 1)
    border[n] = 1.0
    u, before, s = np.array(u, dtype=float), np.inf, problem.field.settings
    for _ in range(SWEEPS):
        if not linearise(problem, u, p, work) < np.inf:
            return None
        bordered(problem, work, border, 0.0, step, tangent)
        size = float((np.abs(step[:n]) / (problem.column_scale + np.abs(u))).max())
        if not np.isfinite(size) or size > s.diverged:
            return None
        # far from a solution a part of the step leads further than all of it
        u += step[:n] * min(1.0, 0.5 / size if size > 0.0 else 1.0)
        if size < s.solved or (size < s.rounded and size > 0.3 * before):
            return u
        before = size
    return None


def settled(problem: Cycles, u: np.ndarray, p: float) -> tuple[Cycles, np.ndarray] | None:
    """The cycle near a guess on a mesh that suits it, with its problem; None if Newton's method does not converge."""
    found = solved(problem, u, p)
    for _ in range(ROUNDS):
        if found is None:
            return None
        image = problem.adapted(found)
        if image is not None:
            found = solved(problem, image(found), p)
            continue
        if not problem.too_coarse(found, p):
            break
        finer = problem.halved(found)
        problem = problem.with_unknowns(finer, p, 2 * problem.intervals, problem.copies)
        found = solved(problem, finer, p)
    if found is None:
        return None
    problem.u0 = found
    return problem, found
