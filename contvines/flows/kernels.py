"""Kernels of cycles, and Newton's method for a single one."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from ..problems.dense import assign
from ..problems.functions import NotEvaluable
from ..problems.protocol import Kernels
from .work import workspace

if TYPE_CHECKING:
    from .cycle_mesh import CycleMesh
    from .work import CycleWork

    Cycles = TypeVar("Cycles", bound=CycleMesh)

SWEEPS = 40  # most steps of Newton's method
ROUNDS = 8  # most adaptations of the mesh


def linearise(data: CycleMesh, u: np.ndarray, p: float, work: CycleWork) -> float:
    """Evaluate the collocation equations and their derivatives into `work`; return the largest residual in units of the rows (inf: failed)."""
    work.begin()
    with np.errstate(all="ignore"):
        try:
            data.evaluate(u, p, work)
        except NotEvaluable as error:
            data.trouble = str(error)
            return math.inf
        except (ArithmeticError, ValueError, np.linalg.LinAlgError):
            return math.inf
    size = float(np.abs(work.residual / data.row_scale).max())
    return size if size < math.inf else math.inf


def bordered(
    data: CycleMesh, work: CycleWork, border: np.ndarray, n: float, step: np.ndarray, tangent: np.ndarray
) -> float:
    """See :meth:`CycleWork.bordered`."""
    return work.bordered(border, n, step, tangent)


def inspect(data: CycleMesh, u: np.ndarray, p: float, work: CycleWork, row: np.ndarray) -> None:
    """Write the multipliers, then the margins, into `row`."""
    with np.errstate(all="ignore"):
        try:
            values = work.spectrum()[0]
        except np.linalg.LinAlgError:
            values = np.full(data.n_multipliers, np.nan + 0j)
        row[: 2 * len(values)].view(np.complex128)[:] = values
        if data.n_margins:
            row[2 * len(values) :] = data.margins(u, work)


def matrix(data: CycleMesh, work: CycleWork) -> np.ndarray:
    """Return F_u as an array."""
    return work.matrix().toarray() * data.row_scale[:, None] / data.column_scale


def flip(data: CycleMesh, work: CycleWork, sign: float) -> None:
    """Change the closure of the cycle to x_N = -x_0 (sign = -1), or back (sign = 1); with -1 the phase condition and the period drop out."""
    work.closure, work.full = sign, None
    if not data.free_period:
        return
    if sign < 0.0:
        work.saved = work.by_period.copy(), work.phase.copy()
        work.by_period[:], work.phase[:] = 0.0, 0.0
    else:
        work.by_period[:], work.phase[:] = work.saved
    work.corner = 1.0 if sign < 0.0 else 0.0


def transpose(data: CycleMesh, work: CycleWork, column: np.ndarray, other: CycleWork) -> None:
    """Write the transposed F_u, and another last column, into another workspace."""
    from scipy.sparse import csc_array, diags_array

    # convert F_u to the user's units, transpose it, and convert it back to units of the scales
    sizes = data.row_scale * data.column_scale
    other.full = csc_array(diags_array(1.0 / sizes) @ work.matrix().T @ diags_array(sizes))
    other.derivative[:] = column


KERNELS = Kernels(
    linearise, bordered, inspect, compiled=False, assign=assign, flip=flip, transpose=transpose, column=1, matrix=matrix
)  # fmt: skip

SPARSE = Kernels(linearise, bordered, inspect, compiled=False, assign=assign, column=1)


# ------------------------------------------------------------------ Newton's method at a fixed parameter
def solved(problem: CycleMesh, u: np.ndarray, p: float) -> np.ndarray | None:
    """Solve for the cycle near a guess at a fixed parameter; None if Newton's method does not converge."""
    n, work = problem.dimension, workspace(problem)
    border, step, tangent = np.zeros((3, n + 1))
    border[n] = 1.0
    u, before, s = np.array(u, dtype=float), np.inf, problem.field.settings
    for _ in range(SWEEPS):
        if not linearise(problem, u, p, work) < np.inf:
            return None
        work.bordered(border, 0.0, step, tangent)
        size = float((np.abs(step[:n]) / (problem.column_scale + np.abs(u))).max())
        if not np.isfinite(size) or size > s.diverged:
            return None
        # far from a solution a damped step is better than a full one
        u += step[:n] * min(1.0, 0.5 / size if size > 0.0 else 1.0)
        if size < s.solved or (size < s.rounded and size > 0.3 * before):
            return u
        before = size
    return None


def settled(problem: Cycles, u: np.ndarray, p: float) -> tuple[Cycles, np.ndarray] | None:
    """Solve for the cycle near a guess, adapting and refining the mesh; return its problem and unknowns, or None if Newton's method fails."""
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
