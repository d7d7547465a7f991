"""Block-cyclic systems: maps between consecutive events, closed into a cycle, solved in O(l) by orthogonal elimination.

A periodic orbit with nodes x_0 .. x_{L-1} solves g_i(x_i, x_{i+1}, p) = 0 with x_L the closure of x_0. Its Jacobian has
two blocks per row, A_i = dg_i/dx_i and D_i = dg_i/dx_{i+1}, and one column Q_i = dg_i/dp. `bordered` eliminates the
inner nodes by orthogonal factorisations (Wright's structured orthogonal factorisation, SIAM J. Sci. Stat. Comput. 13
(1992) 742), so that no product of matrices is formed and long, strongly unstable cycles lose nothing.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from orbits.numbers import SMALLEST

if TYPE_CHECKING:
    from orbits.arguments import CycleData, Workspace


def bordered(
    data: CycleData, work: Workspace, border: np.ndarray, target: float, step: np.ndarray, tangent: np.ndarray
) -> float:
    """Solve [[J, F_p], [border]] z = (-F, target) into `step` and = (0, 1) into `tangent`.

    Parameters
    ----------
    data : CycleData
    work : Workspace
        Of the problem; the last linearisation is read from `work`.
    border, step, tangent : float array (L n + 1,)
    target : float

    Returns
    -------
    float
        Sign of the determinant (up to a constant of the word), 0 if the matrix is singular.
    """
    with np.errstate(all="ignore"):
        particular, null, sign = solutions(work.F, work.A, work.D, work.Q, data.twist)
        along, across = float(border @ null), float(border @ particular)
        if along == 0.0:
            along, sign = SMALLEST, 0.0
        step[:] = particular + (target - across) / along * null
        tangent[:] = null / along
        return float(sign if along > 0.0 else -sign)


def solutions(
    F: np.ndarray, A: np.ndarray, D: np.ndarray, Q: np.ndarray, twist: float
) -> tuple[np.ndarray, np.ndarray, float]:
    """A particular and a null solution of J x + F_p p = -F, shape (L n + 1,) each, and a sign.

    While nodes are eliminated one after the other, ``V x_i + U x_0 + (w, r) . (p, -1) = 0`` ties the last one to the first.
    """
    length, n = F.shape
    if not all(np.isfinite(part).all() for part in (F, A, D, Q)):
        return np.full(length * n + 1, np.nan), np.full(length * n + 1, np.nan), 0.0
    sides = np.stack([Q, -F], axis=2)
    V, U, side = D[0], A[0], sides[0]
    nothing, sign, kept = np.zeros((n, n)), 1.0, []
    for i in range(1, length):
        rotation, triangle, own = factorised(np.vstack([V, A[i]]))
        sign *= own
        rest = rotation.T @ np.block([[U, nothing, side], [nothing, D[i], sides[i]]])
        kept.append((triangle[:n], rest[:n]))
        U, V, side = rest[n:, :n], rest[n:, n : 2 * n], rest[n:, 2 * n :]
    closure = np.r_[1.0, np.full(n - 1, twist)]
    matrix = np.column_stack([U + V * closure, side[:, :1]])
    rotation, triangle, own = factorised(
        matrix.T
    )  # matrix = triangle^T rotation^T; its null vector is the last column
    sign *= own
    found = np.column_stack([rotation[:, :n] @ solved(triangle[:n].T, side[:, 1]), rotation[:, n]])
    start, p = found[:n], found[n]
    nodes, ahead = [start], closure[:, None] * start
    for triangle, rest in kept[::-1]:
        known = rest[:, 2 * n + 1 :] * [1.0, 0.0] - rest[:, 2 * n : 2 * n + 1] * p
        ahead = solved(triangle, known - rest[:, :n] @ start - rest[:, n : 2 * n] @ ahead)
        nodes.insert(1, ahead)
    whole = np.vstack([*nodes, p])
    return whole[:, 0].copy(), whole[:, 1].copy(), sign


def factorised(matrix: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
    """Q, R of a tall matrix, complete, no diagonal entry of R zero; and the determinant's sign of Q and the diagonal together."""
    rotation, triangle = np.linalg.qr(matrix, mode="complete")
    diagonal = np.einsum("ii->i", triangle[: matrix.shape[1]])  # a view
    diagonal[np.abs(diagonal) < SMALLEST] = SMALLEST
    return rotation, triangle, float(np.linalg.slogdet(rotation)[0] * np.prod(np.sign(diagonal)))


def solved(triangle: np.ndarray, side: np.ndarray) -> np.ndarray:
    """The solution of a small system; not a number where it is singular."""
    try:
        return np.linalg.solve(triangle, side)
    except np.linalg.LinAlgError:
        return np.full(side.shape, np.nan)
