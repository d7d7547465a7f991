"""Moving meshes: among all directions of the unknowns with the same change of the curve, the one with the smallest change of the nodes.

If a fast part of a cycle occurs earlier or later as a parameter changes, values at fixed places change by the whole height of a jump, although
the curve itself hardly changes. To first order, a direction (dx, dw) of nodes and widths has the same effect on the curve as
(dx + x' xi, dw + xi_(i+1) - xi_i), for any displacements xi of the mesh points in time, linear in between. The xi are chosen to minimise the
sum over the nodes of

- the squared change of a node in units of the size of the cycle, without the part that shifts or stretches the whole range of a coordinate, and
- STIFFNESS times the mean square of xi'.

Each mesh point is coupled only to its neighbours: a periodic tridiagonal system.
"""

from __future__ import annotations

import numpy as np

from ..core.library import NOTHING, POINTER, function, native
from ..core.table import pack, place
from . import mesh
from .mesh import Rule

STIFFNESS = 0.3  # weight of the mesh's deformation: a smaller one spoils the equidistribution, a larger one keeps the mesh fixed
FEWEST = 3  # fewest intervals of a mesh that moves


class MovingMesh:
    """Changes directions of the unknowns of cycles: nodes (N, m, d), the period if it is unknown, widths (N,), and the parameter.

    Parameters
    ----------
    rule : Rule
    count : int
        Number of intervals N.
    free : int
        1 if the period is an unknown; 0 for forced flows, whose first mesh point is fixed.
    copies : int
        Number of equal parts of the mesh; they remain equal.
    scale : ndarray, shape (d,)
    least : float
        Size of a cycle, in units of the scale, below which its mesh is fixed: a cycle almost at rest has no fast parts.
    """

    def __init__(
        self, rule: Rule, count: int, free: int, copies: int, scale: np.ndarray, least: float = 0.0
    ) -> None:
        self.rule, self.count, self.free, self.copies, self.least = rule, count, free, copies, least
        self.scale = np.array(scale, dtype=float)
        self.states = count * rule.degree * len(scale)
        self.record = None
        if native():
            self.room = np.empty(self.states + 9 * count + 3 * len(scale))
            sizes = count, rule.degree, len(scale), free, copies
            self.record = pack(*sizes, rule.rates, rule.nodes, self.scale, STIFFNESS, float(least), self.room)
            self._steer = function("core_cycle_steer", NOTHING, *[POINTER] * 4)

    def steer(self, u: np.ndarray, tangent: np.ndarray, row: np.ndarray | None = None) -> None:
        """Change a direction in place to the one with the smallest change of the nodes.

        Parameters
        ----------
        u : ndarray, shape (unknowns,)
        tangent : ndarray, shape (unknowns + 1,)
        row : ndarray, shape (N m d,), optional
            Row of the phase condition, in units of the scale; the direction is made orthogonal to it.
        """
        if self.count // self.copies < FEWEST:
            return
        if self.record is not None:
            u = np.ascontiguousarray(u)
            phase = None if row is None else place(row)
            self._steer(place(self.record), place(u), phase, place(tangent))
            return
        n, widths = self.states, u[self.states + self.free :]
        x = u[:n].reshape(self.count, self.rule.degree, -1) / self.scale
        if not np.ptp(x.reshape(-1, x.shape[2]), axis=0).max() > self.least:
            return
        dx, slopes = tangent[:n].reshape(x.shape) / self.scale, self._slopes(x, widths)
        xi = self._displacements(x, dx, slopes, widths)
        dw = np.roll(xi, -1) - xi
        dx += slopes * (xi[:, None] + self.rule.nodes[:-1] * dw[:, None])[:, :, None]
        if row is not None:
            self._in_phase(dx, slopes, row)
        tangent[:n] = (dx * self.scale).reshape(-1)
        tangent[n + self.free : -1] += dw

    def stand(self, u: np.ndarray, tangent: np.ndarray, row: np.ndarray | None = None) -> None:
        """Change a direction in place to the one with the same change of the curve on a fixed mesh; see :meth:`steer`."""
        n, widths = self.states, u[self.states + self.free :]
        x, dw = u[:n].reshape(self.count, self.rule.degree, -1) / self.scale, tangent[n + self.free : -1]
        moved = (np.cumsum(dw) - dw)[:, None] + self.rule.nodes[:-1] * dw[:, None]
        slopes = self._slopes(x, widths)
        dx = tangent[:n].reshape(x.shape) / self.scale - slopes * moved[:, :, None]
        if row is not None:
            self._in_phase(dx, slopes, row)
        tangent[:n] = (dx * self.scale).reshape(-1)
        dw[:] = 0.0

    @staticmethod
    def _in_phase(dx: np.ndarray, slopes: np.ndarray, row: np.ndarray) -> None:
        phase = row.reshape(dx.shape)
        dx -= (phase * dx).sum() / (phase * slopes).sum() * slopes

    def _slopes(self, x: np.ndarray, widths: np.ndarray) -> np.ndarray:
        return np.matmul(self.rule.rates, mesh.closed(x)) / widths[:, None, None]

    def _displacements(
        self, x: np.ndarray, dx: np.ndarray, slopes: np.ndarray, widths: np.ndarray
    ) -> np.ndarray:
        """Optimal displacements xi of the mesh points in time, shape (N,)."""
        from scipy.linalg import solveh_banded

        count, m, d = x.shape
        n, inside = count // self.copies, self.rule.nodes[:-1]
        squares, products = (slopes**2).sum(axis=2), (slopes * self._of_shape(x, dx, widths)).sum(axis=2)
        # quadratic form of each interval in the displacements of its left and right mesh points
        weights = np.stack([(1.0 - inside) ** 2, inside * (1.0 - inside), inside**2], axis=1)
        sums = np.column_stack([squares @ weights, products @ (1.0 - inside), products @ inside])
        left, mixed, right, linear_left, linear_right = sums.reshape(self.copies, n, 5).sum(axis=0).T
        size = float(np.ptp(x.reshape(-1, d), axis=0).max())
        stiff = STIFFNESS * size**2 * count * m * d * (1.0 / widths.reshape(self.copies, n)).sum(axis=0)
        diagonal = left + stiff + np.roll(right + stiff, 1)
        off_diagonal, wanted = mixed - stiff, -linear_left - np.roll(linear_right, 1)
        # express the others by the first mesh point, which closes the ring
        sides = np.zeros((n - 1, 2))
        sides[:, 0] = wanted[1:]
        sides[0, 1] -= off_diagonal[0]
        sides[-1, 1] -= off_diagonal[-1]
        try:
            found = solveh_banded(
                np.stack([diagonal[1:], np.append(off_diagonal[1:-1], 0.0)]), sides, lower=True
            )
        except (np.linalg.LinAlgError, ValueError):  # the cycle is at rest, or a number is not finite
            return np.zeros(count)
        first = 0.0
        if self.free:
            ends = off_diagonal[0] * found[0] + off_diagonal[-1] * found[-1]
            first = (wanted[0] - ends[0]) / (diagonal[0] + ends[1])
        return np.tile(np.append(first, found[:, 0] + first * found[:, 1]), self.copies)

    def _of_shape(self, x: np.ndarray, dx: np.ndarray, widths: np.ndarray) -> np.ndarray:
        """Remove from a direction the shift and stretch of the whole range of each coordinate, so that a growing cycle keeps its mesh."""
        flat, change, each = x.reshape(-1, x.shape[2]), dx.reshape(-1, x.shape[2]), np.arange(x.shape[2])
        gaps = (np.diff(self.rule.nodes) * widths[:, None]).reshape(-1)
        # means over the equal parts of the mesh, since the part that contains the outermost node may change
        parts = flat.reshape(self.copies, -1, x.shape[2])
        first = np.arange(self.copies)[:, None] * parts.shape[1]
        low, moved, high, raised = (
            mean
            for outermost in (parts.argmin(axis=1), parts.argmax(axis=1))
            for mean in np.mean([_at_extreme(flat, change, gaps, k, each) for k in first + outermost], axis=0)
        )
        ranges = high - low
        stretch = np.divide(raised - moved, ranges, out=np.zeros(len(ranges)), where=ranges > 0.0)
        return dx - moved - stretch * (x - low)


def _at_extreme(
    flat: np.ndarray, change: np.ndarray, gaps: np.ndarray, k: np.ndarray, each: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Extreme values and their changes, by parabolas through the outermost nodes k and their neighbours, so that they are continuous when another node becomes outermost."""
    before, after = (k - 1) % len(flat), (k + 1) % len(flat)
    left, right = gaps[before], gaps[k]

    def parabola(values: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        middle = values[k, each]
        falls, rises = (middle - values[before, each]) / left, (values[after, each] - middle) / right
        bend = (rises - falls) / (left + right)
        return middle, rises - bend * right, bend

    value, slope, bend = parabola(flat)
    place = np.divide(-0.5 * slope, bend, out=np.zeros(len(bend)), where=bend != 0.0)
    place = np.clip(place, -left, right)
    moved = parabola(change)
    return value + place * (slope + place * bend), moved[0] + place * (moved[1] + place * moved[2])
