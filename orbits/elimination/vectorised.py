"""Elimination of the inner nodes of long cycles with two unknowns per node, sixteen segments side by side.

The cycle is cut into sixteen segments of equal length; each eliminates its inner nodes by the same Householder
reflections as `orbits.elimination.two_unknowns` (this is the parallel form of Wright's structured orthogonal factorisation, SIAM J.
Sci. Stat. Comput. 13 (1992) 742, with the same stability), and leaves one block that ties its two ends. The segments
are independent, so the innermost loops run over them and the compiler turns them into vector instructions: arrays
are flat, the lane is their last index, and each place is a slice (indices are then known not to be negative).
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from orbits.compiling.decorators import kernel
from orbits.elimination.two_unknowns import FAST, reflect

LANES = 16
SHORTEST = 32  # cycles shorter than this are eliminated by `orbits.elimination.two_unknowns`
PACK, KEEP, STATE, ENDS = 12 * LANES, 16 * LANES, 13 * LANES, 14 * LANES


def lanes_size(length: int) -> int:
    """Number of floats of scratch for a cycle of `length` nodes."""
    return 0 if length < SHORTEST else length // LANES * (PACK + KEEP) + STATE + ENDS


@njit(**FAST)
def _pack(F, A, D, Q, m, pack):
    """Copy block s m + b to place b of lane s: A, D, Q, -F as twelve rows."""
    for b in range(m):
        for s in range(LANES):
            i = s * m + b
            at = b * PACK + s
            pack[at] = A[i, 0, 0]
            pack[at + 16] = A[i, 0, 1]
            pack[at + 32] = A[i, 1, 0]
            pack[at + 48] = A[i, 1, 1]
            pack[at + 64] = D[i, 0, 0]
            pack[at + 80] = D[i, 0, 1]
            pack[at + 96] = D[i, 1, 0]
            pack[at + 112] = D[i, 1, 1]
            pack[at + 128] = Q[i, 0]
            pack[at + 144] = Q[i, 1]
            pack[at + 160] = -F[i, 0]
            pack[at + 176] = -F[i, 1]


@njit(**FAST)
def _forward(m, pack, keep, state):
    """Eliminate the inner nodes of every segment.

    `state` holds per lane the two equations V x_b + U x_0 + w p = r (rows a, u, w, r) and the sign of the
    determinant; `keep` the rows of R, of x_0, of x_{b+1}, of p and the right-hand side for each inner node.
    """
    for s in range(LANES):
        state[s] = pack[s + 64]
        state[s + 16] = pack[s + 80]
        state[s + 32] = pack[s]
        state[s + 48] = pack[s + 16]
        state[s + 64] = pack[s + 128]
        state[s + 80] = pack[s + 160]
        state[s + 96] = pack[s + 96]
        state[s + 112] = pack[s + 112]
        state[s + 128] = pack[s + 32]
        state[s + 144] = pack[s + 48]
        state[s + 160] = pack[s + 144]
        state[s + 176] = pack[s + 176]
        state[s + 192] = 1.0
    for b in range(1, m):
        block = pack[b * PACK : (b + 1) * PACK]
        kept = keep[b * KEEP : (b + 1) * KEEP]
        for s in range(LANES):
            row = reflect(
                state[s],
                state[s + 16],
                state[s + 32],
                state[s + 48],
                state[s + 64],
                state[s + 80],
                state[s + 96],
                state[s + 112],
                state[s + 128],
                state[s + 144],
                state[s + 160],
                state[s + 176],
                block[s],
                block[s + 16],
                block[s + 32],
                block[s + 48],
                block[s + 64],
                block[s + 80],
                block[s + 96],
                block[s + 112],
                block[s + 128],
                block[s + 144],
                block[s + 160],
                block[s + 176],
            )
            kept[s + 0] = row[0]
            kept[s + 16] = row[1]
            kept[s + 32] = row[2]
            kept[s + 48] = row[3]
            kept[s + 64] = row[4]
            kept[s + 80] = row[5]
            kept[s + 96] = row[6]
            kept[s + 112] = row[7]
            kept[s + 128] = row[8]
            kept[s + 144] = row[9]
            kept[s + 160] = row[10]
            kept[s + 176] = row[11]
            kept[s + 192] = row[12]
            kept[s + 208] = row[13]
            kept[s + 224] = row[14]
            state[s + 0] = row[15]
            state[s + 16] = row[16]
            state[s + 32] = row[17]
            state[s + 48] = row[18]
            state[s + 64] = row[19]
            state[s + 80] = row[20]
            state[s + 96] = row[21]
            state[s + 112] = row[22]
            state[s + 128] = row[23]
            state[s + 144] = row[24]
            state[s + 160] = row[25]
            state[s + 176] = row[26]
            state[s + 192] *= math.copysign(1.0, row[0] * row[8])


@njit(**FAST)
def _backward(m, keep, ends, p, null):
    """Inner nodes of the particular and the null solution from the two ends of every segment.

    `ends` holds per lane x_0 and x_{b+1} of either solution: (particular 0, 1, null 0, 1) twice; each node that is
    found takes the place of x_{b+1} and its four numbers overwrite the first four rows of its place in `keep`.
    """
    for b in range(m - 1, 0, -1):
        kept = keep[b * KEEP : (b + 1) * KEEP]
        for s in range(LANES):
            x0, x1, y0, y1 = ends[s], ends[s + 16], ends[s + 32], ends[s + 48]
            n0, n1, z0, z1 = ends[s + 64], ends[s + 80], ends[s + 96], ends[s + 112]
            u10, u11, e10, e11 = (
                kept[s + 144],
                kept[s + 160],
                kept[s + 176],
                kept[s + 192],
            )
            w1 = kept[s + 208]
            by = kept[s + 128]
            second = (kept[s + 224] - w1 * p - u10 * x0 - u11 * x1 - e11 * n1 - e10 * n0) * by
            other = (-w1 * null - u10 * y0 - u11 * y1 - e10 * z0 - e11 * z1) * by
            u00, u01, e00, e01 = kept[s + 32], kept[s + 48], kept[s + 64], kept[s + 80]
            w0 = kept[s + 96]
            a01 = kept[s + 16]
            by = kept[s]
            first = (kept[s + 112] - w0 * p - u00 * x0 - u01 * x1 - e00 * n0 - e01 * n1 - a01 * second) * by
            one = (-w0 * null - u00 * y0 - u01 * y1 - e00 * z0 - e01 * z1 - a01 * other) * by
            ends[s + 64] = first
            ends[s + 80] = second
            ends[s + 96] = one
            ends[s + 112] = other
            kept[s] = first
            kept[s + 16] = second
            kept[s + 32] = one
            kept[s + 48] = other


@kernel
def condense(F, A, D, Q, scratch, short):
    """Eliminate the inner nodes of sixteen segments; `short` = (F, A, D, Q) of the shorter cycle is filled.

    Nodes of the shorter cycle: the sixteen starts of the segments, then the nodes that did not fit.

    Returns
    -------
    sign : float
        Sign of the determinant of what was eliminated.
    """
    length = F.shape[0]
    m = length // LANES
    pack = scratch[: m * PACK]
    keep = scratch[m * PACK : m * (PACK + KEEP)]
    state = scratch[m * (PACK + KEEP) : m * (PACK + KEEP) + STATE]
    _pack(F, A, D, Q, m, pack)
    _forward(m, pack, keep, state)
    F_, A_, D_, Q_ = short
    sign = 1.0
    for s in range(LANES):
        for r in range(2):
            at = 96 * r + s
            D_[s, r, 0] = state[at]
            D_[s, r, 1] = state[at + 16]
            A_[s, r, 0] = state[at + 32]
            A_[s, r, 1] = state[at + 48]
            Q_[s, r] = state[at + 64]
            F_[s, r] = -state[at + 80]
        sign *= state[192 + s]
    nodes = LANES
    for i in range(LANES * m, length):
        for r in range(2):
            for c in range(2):
                A_[nodes, r, c] = A[i, r, c]
                D_[nodes, r, c] = D[i, r, c]
            Q_[nodes, r] = Q[i, r]
            F_[nodes, r] = F[i, r]
        nodes += 1
    return sign


@kernel
def expand(length, scratch, found, twist, solution):
    """Fill `solution` (2, 2 L + 1), particular and null, from that of the shorter cycle, `found` (2, 2 nodes + 1)."""
    m = length // LANES
    keep = scratch[m * PACK : m * (PACK + KEEP)]
    ends = scratch[m * (PACK + KEEP) + STATE :]
    nodes = LANES + length - m * LANES
    p, null = found[0, 2 * nodes], found[1, 2 * nodes]
    for s in range(LANES):
        for r in range(2):
            for c in range(2):
                ends[16 * (2 * r + c) + s] = found[r, 2 * s + c]
                if s + 1 < nodes:
                    ahead = found[r, 2 * s + 2 + c]
                else:
                    ahead = found[r, c] if c == 0 else twist * found[r, c]
                ends[64 + 16 * (2 * r + c) + s] = ahead
    _backward(m, keep, ends, p, null)
    for r in range(2):
        for s in range(LANES):
            i = 2 * s * m
            solution[r, i] = found[r, 2 * s]
            solution[r, i + 1] = found[r, 2 * s + 1]
        for b in range(1, m):
            for s in range(LANES):
                i = 2 * (s * m + b)
                solution[r, i] = keep[b * KEEP + 32 * r + s]
                solution[r, i + 1] = keep[b * KEEP + 32 * r + 16 + s]
        for j in range(2 * LANES, 2 * nodes + 1):
            solution[r, 2 * LANES * m + j - 2 * LANES] = found[r, j]


def short_cycle(length: int) -> tuple[np.ndarray, ...]:
    """Arrays of the shorter cycle: F, A, D, Q, and its two solutions."""
    nodes = LANES + length % LANES if length >= SHORTEST else 0
    square = (nodes, 2, 2)
    return (
        np.zeros((nodes, 2)),
        np.zeros(square),
        np.zeros(square),
        np.zeros((nodes, 2)),
        np.zeros((2, 2 * nodes + 1)),
    )
