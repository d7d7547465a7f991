"""Orthogonal elimination of collocation equations: condensation of the intervals, a block-cyclic system, and its multipliers.

All intervals are processed at once, as stacks of small matrices. First the unknowns inside each interval are eliminated by QR
factorisation. Then every other mesh point is eliminated, by QR factorisations of pairs of neighbouring block rows, until one block row
is left (S. J. Wright, SIAM J. Sci. Stat. Comput. 13, 1992; Gaussian elimination can be unstable here). A few further columns (period,
parameter) and rows (phase, border) take part.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from contvines.shared.numbers import LEAST

from ..core.block_cyclic import Eliminated, eliminate
from ..core.library import native
from ..core.multipliers.periodic_schur import multipliers


class Condensed(NamedTuple):
    """Equations between neighbouring mesh points: ``left[i] x_i + right[i] x_(i + 1) + columns[i] e = 0``, with shared unknowns e.

    The unknowns inside the intervals are ``-(maps @ (x_i, x_(i + 1), e))``; ``sign`` is the sign of the determinant of the eliminated part.
    """

    left: np.ndarray
    right: np.ndarray
    columns: np.ndarray
    maps: np.ndarray
    sign: float


def condense(blocks: np.ndarray, columns: np.ndarray, d: int) -> Condensed:
    """Eliminate the unknowns inside of each interval.

    Parameters
    ----------
    blocks : ndarray, shape (N, m d, (m + 1) d)
        Derivatives of the collocation equations by the values at the nodes of their interval.
    columns : ndarray, shape (N, m d, k)
        Columns of the shared unknowns, then right-hand sides with the opposite sign.
    d : int
    """
    coupled = np.concatenate([blocks[:, :, :d], blocks[:, :, -d:], columns], axis=2)
    maps, rest, sign = _eliminated(blocks[:, :, d:-d], coupled)
    return Condensed(rest[:, :, :d], rest[:, :, d : 2 * d], rest[:, :, 2 * d :], maps, sign)


def _eliminated(front: np.ndarray, whole: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
    """Eliminate y from ``front[i] y_i + whole[i] z_i = 0``.

    Returns the maps of ``y_i = -maps[i] z_i``, the remaining equations of z, and the sign of the determinant of the eliminated part.
    """
    k = front.shape[2]
    q, r = np.linalg.qr(front, mode="complete")
    turned = np.matmul(q.transpose(0, 2, 1), whole)
    return np.linalg.solve(r[:, :k], turned[:, :k]), turned[:, k:], _sign(q, r)


def _sign(q: np.ndarray, r: np.ndarray) -> float:
    """Sign of the product of the determinants of Q and of the triangular factor R."""
    odd = np.count_nonzero(np.diagonal(r, axis1=1, axis2=2) < 0.0) + np.count_nonzero(np.linalg.det(q) < 0.0)
    return -1.0 if odd % 2 else 1.0


class Solution(NamedTuple):
    """Mesh points x_0 ... x_N, shape (N + 1, d, s), the shared unknowns, (k, s), and the sign of the determinant."""

    mesh: np.ndarray
    shared: np.ndarray
    sign: float


def solve_cyclic(
    left: np.ndarray,
    right: np.ndarray,
    columns: np.ndarray,
    rows: np.ndarray,
    foot: np.ndarray,
    closure: float = 1.0,
) -> Solution:
    """Solve ``left[i] x_i + right[i] x_(i + 1) + columns[i] (e, -1) = 0``, ``sum rows[i] x_i + foot (e, -1) = 0``, x_N = closure x_0.

    Parameters
    ----------
    left, right : ndarray, shape (N, d, d)
    columns : ndarray, shape (N, d, k + s)
        Columns of the k shared unknowns, then s right-hand sides.
    rows : ndarray, shape (N + 1, k, d)
    foot : ndarray, shape (k, k + s)
    closure : float
    """
    d, k = left.shape[1], foot.shape[0]
    foot, sign, steps = foot.copy(), 1.0, []
    while len(left) > 1:
        n = len(left)
        pairs = n // 2
        one, two = slice(0, 2 * pairs, 2), slice(1, 2 * pairs, 2)
        zero = np.zeros((pairs, d, d))
        coupled = np.concatenate(
            [
                np.concatenate([left[one], zero, columns[one]], axis=2),
                np.concatenate([zero, right[two], columns[two]], axis=2),
            ],
            axis=1,
        )
        maps, rest, last_sign = _eliminated(np.concatenate([right[one], left[two]], axis=1), coupled)
        sign *= last_sign
        passed = np.matmul(rows[two], maps)
        foot -= passed[:, :, 2 * d :].sum(axis=0)
        rows = np.concatenate([rows[one], rows[2 * pairs :]])
        rows[:pairs] -= passed[:, :, :d]
        rows[1 : pairs + 1] -= passed[:, :, d : 2 * d]
        last = slice(2 * pairs, n)
        left = np.concatenate([rest[:, :, :d], left[last]])
        right = np.concatenate([rest[:, :, d : 2 * d], right[last]])
        columns = np.concatenate([rest[:, :, 2 * d :], columns[last]])
        steps.append(maps)
    matrix = np.empty((d + k, d + k))
    matrix[:d, :d], matrix[:d, d:] = left[0] + closure * right[0], columns[0][:, :k]
    matrix[d:, :d], matrix[d:, d:] = rows[0] + closure * rows[1], foot[:, :k]
    small, last_sign = _solve(matrix, np.concatenate([columns[0][:, k:], foot[:, k:]]))
    shared = small[d:]
    mesh = np.stack([small[:d], closure * small[:d]])
    weights = np.concatenate([shared, -np.eye(shared.shape[1])])
    for maps in reversed(steps):
        pairs = len(maps)
        middle = -(
            np.matmul(maps[:, :, :d], mesh[:pairs])
            + np.matmul(maps[:, :, d : 2 * d], mesh[1 : pairs + 1])
            + np.matmul(maps[:, :, 2 * d :], weights)
        )
        wider = np.empty((len(mesh) + pairs, *mesh.shape[1:]))
        wider[0 : 2 * pairs : 2], wider[1 : 2 * pairs : 2] = mesh[:pairs], middle
        wider[2 * pairs :] = mesh[pairs:]
        mesh = wider
    return Solution(mesh, shared, sign * last_sign)


def _solve(matrix: np.ndarray, sides: np.ndarray) -> tuple[np.ndarray, float]:
    """Solutions and the sign of the determinant; for a singular matrix 0, and solutions that are large along its null vectors."""
    if not np.isfinite(matrix).all():
        return np.full(sides.shape, np.nan), 0.0
    rows = np.abs(matrix).max(axis=1)
    rows[rows == 0.0] = 1.0
    matrix, sides = matrix / rows[:, None], sides / rows[:, None]
    sign = float(np.linalg.slogdet(matrix)[0])
    if sign != 0.0:
        return np.linalg.solve(matrix, sides), sign
    left, values, right = np.linalg.svd(matrix)
    values = np.maximum(values, LEAST * values[0])
    return right.T @ ((left.T @ sides) / values[:, None]), 0.0


def solve_collocation(
    blocks: np.ndarray,
    columns: np.ndarray,
    rows: np.ndarray,
    foot: np.ndarray,
    d: int,
    closure: float = 1.0,
) -> Eliminated:
    """Solve the bordered collocation equations by the native core (:func:`contvines.core.block_cyclic.eliminate`), or by :func:`reference`."""
    return (eliminate if native() else reference)(blocks, columns, rows, foot, d, closure)


def reference(
    blocks: np.ndarray, columns: np.ndarray, rows: np.ndarray, foot: np.ndarray, d: int, closure: float
) -> Eliminated:
    """Solve the bordered collocation equations in numpy, with the arguments and result of the native function."""
    count, k, s = len(blocks), len(foot), foot.shape[1] - len(foot)
    cond = condense(blocks, columns, d)
    passed = np.matmul(rows[:, :, d:], cond.maps)
    foot = foot - passed[:, :, 2 * d :].sum(axis=0)
    mesh = np.zeros((count + 1, k, d))
    mesh[:-1] = rows[:, :, :d] - passed[:, :, :d]
    mesh[1:] -= passed[:, :, d : 2 * d]
    solved = solve_cyclic(cond.left, cond.right, cond.columns, mesh, foot, closure)
    weights = np.broadcast_to(np.concatenate([solved.shared, -np.eye(s)]), (count, k + s, s))
    inside = -np.matmul(cond.maps, np.concatenate([solved.mesh[:-1], solved.mesh[1:], weights], axis=1))
    states = np.concatenate([solved.mesh[:-1], inside], axis=1)
    return Eliminated(states, solved.shared, cond.left, cond.right, solved.sign * cond.sign)


def multipliers_of(left: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Return the eigenvalues of the product of ``-right[i]^-1 left[i]``, the last factor leftmost; small ones, too, have full relative accuracy.

    Parameters
    ----------
    left, right : ndarray, shape (N, k, k)

    Raises
    ------
    LinAlgError
        If a factor is not finite, or the periodic QR algorithm does not converge.
    """
    k = left.shape[1]
    if k == 0:
        return np.zeros(0, dtype=complex)
    re, im = np.empty(k), np.empty(k)
    if not multipliers(left, right, 1.0, re, im):
        raise np.linalg.LinAlgError("the multipliers do not converge")
    return re + 1j * im
