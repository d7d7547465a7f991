"""The same block-cyclic system read in other ways: for perturbations that change sign over the period, and transposed.

Both are block-cyclic again, so that the elimination of `orbits.elimination.block_cyclic` solves them in O(l).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from orbits.compiling.decorators import inlined_kernel

unpin: Any = None  # filled in per machine by `orbits.cycles.kernels`


def flip(data, work, sign):
    """Turn the closure x_L = T x_0 of the linearisation into x_L = -T x_0 (sign = -1), and back (sign = 1).

    T is the closure's own twist. The shift of an impact-free motion is put back: turned round, the closure needs no pin.
    """
    unpin(data, work)
    D = work.D
    last = D.shape[0] - 1
    for i in range(D.shape[1]):
        for c in range(D.shape[1]):
            D[last, i, c] = -D[last, i, c]


@inlined_kernel
def transpose(data, work, column, other):
    """Write the transposed system into another workspace, with `column` (L n,) as its last column.

    Row k of J ties nodes k and k + 1 by A_k and D_k. Column k + 1 therefore ties the left unknowns of rows k and k + 1 by
    D_k^T and A_{k+1}^T: block k of the new system. The closure's twist, which scales columns of D_{L-1}, scales rows here;
    in the last block it is taken out of the place where the elimination puts it.
    """
    A, D, twist = work.A, work.D, data.twist
    new_A, new_D, Q = other.A, other.D, other.Q
    length, n = A.shape[0], A.shape[1]
    for k in range(length):
        following = k + 1 if k + 1 < length else 0
        for i in range(n):
            scale = twist if (following == 0 and i > 0) else 1.0
            Q[k, i] = column[following * n + i]
            for c in range(n):
                new_A[k, i, c] = scale * D[k, c, i]
                new_D[k, i, c] = A[following, c, i] * (twist if (following == 0 and c > 0) else 1.0)


def matrix(data, work) -> np.ndarray:
    """The whole Jacobian, shape (L n, L n), of the linearisation in a workspace."""
    A, D, twist = work.A, work.D, data.twist
    length, n = A.shape[0], A.shape[1]
    whole = np.zeros((length, n, length, n))
    np.einsum("kikj->kij", whole)[...] = A  # views: blocks on the diagonal, and beside it
    np.einsum("kikj->kij", whole[:-1, :, 1:])[...] = D[:-1]
    whole[-1, :, 0, 0] += D[-1, :, 0]
    whole[-1, :, 0, 1:] += twist * D[-1, :, 1:]
    return whole.reshape(length * n, length * n)
