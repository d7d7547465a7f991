"""The same block-cyclic system read in other ways: for perturbations that change sign over the period, and transposed.

Both are block-cyclic again, so that the elimination of the native core solves them in O(l).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from orbits.arguments import CycleData, Workspace


def flip(data: CycleData, work: Workspace, sign: float) -> None:
    """Turn the closure x_L = T x_0 of the linearisation into x_L = -T x_0 (sign = -1), and back (sign = 1).

    T is the closure's own twist. The shift of an impact-free motion has to be put back before (`unpin` of its machine): turned round, the
    closure needs no pin.
    """
    np.negative(work.D[-1], out=work.D[-1])


def transpose(data: CycleData, work: Workspace, column: np.ndarray, other: Workspace) -> None:
    """Write the transposed system into another workspace, with `column` (L n,) as its last column.

    Row k of J ties nodes k and k + 1 by A_k and D_k. Column k + 1 therefore ties the left unknowns of rows k and k + 1 by
    D_k^T and A_{k+1}^T: block k of the new system. The closure's twist, which scales columns of D_{L-1}, scales rows here;
    in the last block it is taken out of the place where the elimination puts it.
    """
    other.A[:] = work.D.transpose(0, 2, 1)
    other.A[-1, 1:] *= data.twist
    other.D[:] = np.roll(work.A, -1, axis=0).transpose(0, 2, 1)
    other.D[-1, :, 1:] *= data.twist
    other.Q[:] = np.roll(column.reshape(other.Q.shape), -1, axis=0)


def matrix(data: CycleData, work: Workspace) -> np.ndarray:
    """The whole Jacobian, shape (L n, L n), of the linearisation in a workspace."""
    A, D, twist = work.A, work.D, data.twist
    length, n = A.shape[0], A.shape[1]
    whole = np.zeros((length, n, length, n))
    np.einsum("kikj->kij", whole)[...] = A  # views: blocks on the diagonal, and beside it
    np.einsum("kikj->kij", whole[:-1, :, 1:])[...] = D[:-1]
    whole[-1, :, 0, 0] += D[-1, :, 0]
    whole[-1, :, 0, 1:] += twist * D[-1, :, 1:]
    return whole.reshape(length * n, length * n)
