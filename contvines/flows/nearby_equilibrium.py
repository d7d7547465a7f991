"""The equilibrium beside which a cycle passes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from contvines.shared.floating_point import ROUNDED

if TYPE_CHECKING:
    from .cycle_mesh import CycleMesh

FAR = 0.05  # sizes of a cycle: an equilibrium nearer than that to a point of least speed is the one at which it stays
SWEEPS = 20


def nearby_equilibrium(
    problem: CycleMesh, start: np.ndarray, p: float, sizes: np.ndarray
) -> np.ndarray | None:
    """The equilibrium to which Newton's method leads from a point of a cycle; None where that is far away, or none.

    Parameters
    ----------
    problem : CycleProblem
    start : ndarray, shape (d,)
    p : float
    sizes : ndarray, shape (d,)
        Of the cycle.
    """
    y, field = start.copy(), problem.field
    for _ in range(SWEEPS):
        matrix, rates = field.jacobian(y[None], p)[0], field(y[None], p)[0]
        step = np.linalg.lstsq(matrix, -rates, rcond=ROUNDED)[0]
        y = y + step
        if not (np.abs(y - start) <= FAR * sizes).all():
            return None
        if (np.abs(step) <= problem.flow.settings.rounded * sizes).all():
            return np.where(np.abs(y) > problem.flow.settings.rounded * sizes, y, 0.0)
    return None
