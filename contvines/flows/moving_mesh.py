"""Meshes that move along with a cycle: of all directions that change a curve alike, the one along which its nodes move least.

Where fast parts of a cycle come earlier or later as a parameter changes, values at places that stand still change by the whole height of a jump, although
the curve hardly changes at all. To first order a direction (dx, dw) of nodes and widths changes the curve as (dx + x' xi, dw + xi_(i+1) - xi_i) does,
for any displacements xi of the mesh points in time, linear in between. Those are taken that make least the sum of the squares of what nodes move in
units of the size of the cycle (beside what moves and stretches its whole range), and of STIFFNESS times the mean square of xi' for each of them. Every
mesh point shares terms with its neighbours only: a system with three entries in a row, closed to a ring.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.linalg.lapack import dptsv

from . import mesh

if TYPE_CHECKING:
    from .collocation import Rule

STIFFNESS = 0.3  # with less, meshes lose their shares of the error; with more, they stand still
FEWEST = 3  # intervals of a ring


def steered(
    rule: Rule,
    widths: np.ndarray,
    x: np.ndarray,
    dx: np.ndarray,
    *,
    copies: int = 1,
    pinned: bool = False,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A direction of nodes and widths that changes a curve as a direction of nodes alone does, and slopes of the curve.

    Parameters
    ----------
    rule : Rule
    widths : ndarray, shape (N,)
    x, dx : ndarray, shape (N, m, d)
        The curve, and how it changes where the mesh stands still, in units of the scale.
    copies : int
        The mesh consists of so many equal parts, one after the other, and goes on to do so.
    pinned : bool
        The first mesh point stays where it is, as where time is given.

    Returns
    -------
    dx, dw, slopes : ndarray, shapes (N, m, d), (N,), (N, m, d)
    """
    count, m, d = x.shape
    n, inside = count // copies, rule.nodes[:-1]
    slopes = np.matmul(rule.rates, mesh.closed(x)) / widths[:, None, None]
    if n < FEWEST:
        return dx, np.zeros(count), slopes
    squares, products = (slopes**2).sum(axis=2), (slopes * _of_shape(x, dx)).sum(axis=2)
    # by the displacements of the left and of the right mesh point of each interval
    weights = np.stack([(1.0 - inside) ** 2, inside * (1.0 - inside), inside**2], axis=1)
    sums = np.column_stack([squares @ weights, products @ (1.0 - inside), products @ inside])
    left, both, right, here, there = sums.reshape(copies, n, 5).sum(axis=0).T
    size = float(np.ptp(x.reshape(-1, d), axis=0).max())
    stiff = STIFFNESS * size**2 * count * m * d * (1.0 / widths.reshape(copies, n)).sum(axis=0)
    diagonal = left + stiff + np.roll(right + stiff, 1)
    beside, wanted = both - stiff, -here - np.roll(there, 1)
    # the others in terms of the first mesh point, which closes the ring
    sides = np.zeros((n - 1, 2))
    sides[:, 0], sides[0, 1], sides[-1, 1] = wanted[1:], -beside[0], -beside[-1]
    found, failed = dptsv(diagonal[1:], beside[1:-1], sides)[2:]
    if failed:
        return dx, np.zeros(count), slopes
    first = 0.0
    if not pinned:
        ends = beside[0] * found[0] + beside[-1] * found[-1]
        first = (wanted[0] - ends[0]) / (diagonal[0] + ends[1])
    xi = np.tile(np.append(first, found[:, 0] + first * found[:, 1]), copies)
    dw = np.roll(xi, -1) - xi
    return dx + slopes * (xi[:, None] + inside * dw[:, None])[:, :, None], dw, slopes


def _of_shape(x: np.ndarray, dx: np.ndarray) -> np.ndarray:
    """What is left of a direction without what moves and stretches the whole range of each coordinate: cycles that grow keep their mesh."""
    flat, change, each = x.reshape(-1, x.shape[2]), dx.reshape(-1, x.shape[2]), np.arange(x.shape[2])
    lowest, highest = flat.argmin(axis=0), flat.argmax(axis=0)
    low, moved = flat[lowest, each], change[lowest, each]
    ranges = flat[highest, each] - low
    stretch = np.divide(
        change[highest, each] - moved, ranges, out=np.zeros(len(ranges)), where=ranges > 0.0
    )
    return dx - moved - stretch * (x - low)
