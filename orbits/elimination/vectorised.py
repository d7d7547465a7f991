"""Elimination of the inner nodes of long cycles with two unknowns per node, eight segments side by side.

The cycle is cut into eight segments of equal length; each eliminates its inner nodes by the same Householder
reflections as `orbits.elimination.two_unknowns` (this is the parallel form of Wright's structured orthogonal factorisation, SIAM J.
Sci. Stat. Comput. 13 (1992) 742, with the same stability), and leaves one block that ties its two ends. The segments
are independent, so the innermost loops run over them and the compiler turns them into vector instructions: arrays
are flat, the lane is their last index, and each place is a slice (indices are then known not to be negative). How many lanes there
are is no constant to the compiler, which would unroll so short a loop rather than make vectors of it.
"""

from __future__ import annotations

import math

import numpy as np

from contvines_ground.parts import part
from orbits.compiling.decorators import kernel
from orbits.elimination.two_unknowns import FAST, reflect

LANES = 8
SHORTEST = 32  # cycles shorter than this are eliminated by `orbits.elimination.two_unknowns`
PACK, KEEP, STATE, ENDS = 12 * LANES, 16 * LANES, 13 * LANES, 14 * LANES


def room(length: int) -> tuple[np.ndarray, list[np.ndarray]]:
    """Room for a long cycle, and its parts: scratch, F, A, D, Q of the shorter cycle, and its two solutions."""
    nodes = LANES + length % LANES
    scratch = length // LANES * (PACK + KEEP) + STATE + ENDS
    ends = np.cumsum((scratch, 2 * nodes, 4 * nodes, 4 * nodes, 2 * nodes, 2 * (2 * nodes + 1)))
    whole = np.zeros(ends[-1])
    return whole, np.split(whole, ends[:-1])


@part(**FAST)
def _pack(F, A, D, Q, m, lanes, pack):
    """Copy block s m + b to place b of lane s: A, D, Q, -F as twelve rows."""
    for b in range(m):
        for s in range(lanes):
            i = s * m + b
            at = b * PACK + s
            pack[at] = A[i, 0, 0]
            pack[at + LANES] = A[i, 0, 1]
            pack[at + 2 * LANES] = A[i, 1, 0]
            pack[at + 3 * LANES] = A[i, 1, 1]
            pack[at + 4 * LANES] = D[i, 0, 0]
            pack[at + 5 * LANES] = D[i, 0, 1]
            pack[at + 6 * LANES] = D[i, 1, 0]
            pack[at + 7 * LANES] = D[i, 1, 1]
            pack[at + 8 * LANES] = Q[i, 0]
            pack[at + 9 * LANES] = Q[i, 1]
            pack[at + 10 * LANES] = -F[i, 0]
            pack[at + 11 * LANES] = -F[i, 1]


@part(**FAST)
def _forward(m, lanes, pack, keep, state):
    """Eliminate the inner nodes of every segment.

    `state` holds per lane the two equations V x_b + U x_0 + w p = r (rows a, u, w, r) and the sign of the
    determinant; `keep` the rows of R, of x_0, of x_{b+1}, of p and the right-hand side for each inner node.
    """
    for s in range(lanes):
        state[s] = pack[s + 4 * LANES]
        state[s + LANES] = pack[s + 5 * LANES]
        state[s + 2 * LANES] = pack[s]
        state[s + 3 * LANES] = pack[s + LANES]
        state[s + 4 * LANES] = pack[s + 8 * LANES]
        state[s + 5 * LANES] = pack[s + 10 * LANES]
        state[s + 6 * LANES] = pack[s + 6 * LANES]
        state[s + 7 * LANES] = pack[s + 7 * LANES]
        state[s + 8 * LANES] = pack[s + 2 * LANES]
        state[s + 9 * LANES] = pack[s + 3 * LANES]
        state[s + 10 * LANES] = pack[s + 9 * LANES]
        state[s + 11 * LANES] = pack[s + 11 * LANES]
        state[s + 12 * LANES] = 1.0
    for b in range(1, m):
        block = pack[b * PACK : (b + 1) * PACK]
        kept = keep[b * KEEP : (b + 1) * KEEP]
        for s in range(lanes):
            row = reflect(
                state[s],
                state[s + LANES],
                state[s + 2 * LANES],
                state[s + 3 * LANES],
                state[s + 4 * LANES],
                state[s + 5 * LANES],
                state[s + 6 * LANES],
                state[s + 7 * LANES],
                state[s + 8 * LANES],
                state[s + 9 * LANES],
                state[s + 10 * LANES],
                state[s + 11 * LANES],
                block[s],
                block[s + LANES],
                block[s + 2 * LANES],
                block[s + 3 * LANES],
                block[s + 4 * LANES],
                block[s + 5 * LANES],
                block[s + 6 * LANES],
                block[s + 7 * LANES],
                block[s + 8 * LANES],
                block[s + 9 * LANES],
                block[s + 10 * LANES],
                block[s + 11 * LANES],
            )
            kept[s] = row[0]
            kept[s + LANES] = row[1]
            kept[s + 2 * LANES] = row[2]
            kept[s + 3 * LANES] = row[3]
            kept[s + 4 * LANES] = row[4]
            kept[s + 5 * LANES] = row[5]
            kept[s + 6 * LANES] = row[6]
            kept[s + 7 * LANES] = row[7]
            kept[s + 8 * LANES] = row[8]
            kept[s + 9 * LANES] = row[9]
            kept[s + 10 * LANES] = row[10]
            kept[s + 11 * LANES] = row[11]
            kept[s + 12 * LANES] = row[12]
            kept[s + 13 * LANES] = row[13]
            kept[s + 14 * LANES] = row[14]
            state[s] = row[15]
            state[s + LANES] = row[16]
            state[s + 2 * LANES] = row[17]
            state[s + 3 * LANES] = row[18]
            state[s + 4 * LANES] = row[19]
            state[s + 5 * LANES] = row[20]
            state[s + 6 * LANES] = row[21]
            state[s + 7 * LANES] = row[22]
            state[s + 8 * LANES] = row[23]
            state[s + 9 * LANES] = row[24]
            state[s + 10 * LANES] = row[25]
            state[s + 11 * LANES] = row[26]
            state[s + 12 * LANES] *= math.copysign(1.0, row[0] * row[8])


@part(**FAST)
def _backward(m, lanes, keep, ends, p, null):
    """Inner nodes of the particular and the null solution from the two ends of every segment.

    `ends` holds per lane x_0 and x_{b+1} of either solution: (particular 0, 1, null 0, 1) twice; each node that is
    found takes the place of x_{b+1} and its four numbers overwrite the first four rows of its place in `keep`.
    """
    for b in range(m - 1, 0, -1):
        kept = keep[b * KEEP : (b + 1) * KEEP]
        for s in range(lanes):
            x0, x1, y0, y1 = ends[s], ends[s + LANES], ends[s + 2 * LANES], ends[s + 3 * LANES]
            n0, n1, z0, z1 = (
                ends[s + 4 * LANES],
                ends[s + 5 * LANES],
                ends[s + 6 * LANES],
                ends[s + 7 * LANES],
            )
            u10, u11, e10, e11 = (
                kept[s + 9 * LANES],
                kept[s + 10 * LANES],
                kept[s + 11 * LANES],
                kept[s + 12 * LANES],
            )
            w1 = kept[s + 13 * LANES]
            by = kept[s + 8 * LANES]
            second = (kept[s + 14 * LANES] - w1 * p - u10 * x0 - u11 * x1 - e11 * n1 - e10 * n0) * by
            other = (-w1 * null - u10 * y0 - u11 * y1 - e10 * z0 - e11 * z1) * by
            u00, u01, e00, e01 = (
                kept[s + 2 * LANES],
                kept[s + 3 * LANES],
                kept[s + 4 * LANES],
                kept[s + 5 * LANES],
            )
            w0 = kept[s + 6 * LANES]
            a01 = kept[s + LANES]
            by = kept[s]
            first = (
                kept[s + 7 * LANES] - w0 * p - u00 * x0 - u01 * x1 - e00 * n0 - e01 * n1 - a01 * second
            ) * by
            one = (-w0 * null - u00 * y0 - u01 * y1 - e00 * z0 - e01 * z1 - a01 * other) * by
            ends[s + 4 * LANES] = first
            ends[s + 5 * LANES] = second
            ends[s + 6 * LANES] = one
            ends[s + 7 * LANES] = other
            kept[s] = first
            kept[s + LANES] = second
            kept[s + 2 * LANES] = one
            kept[s + 3 * LANES] = other


@kernel
def condense(F, A, D, Q, scratch, short):
    """Eliminate the inner nodes of eight segments; `short` = (F, A, D, Q) of the shorter cycle is filled.

    Nodes of the shorter cycle: the eight starts of the segments, then the nodes that did not fit.

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
    lanes = short[0].shape[0] - length % LANES
    _pack(F, A, D, Q, m, lanes, pack)
    _forward(m, lanes, pack, keep, state)
    F_, A_, D_, Q_ = short
    sign = 1.0
    for s in range(LANES):
        for r in range(2):
            at = 6 * LANES * r + s
            D_[s, r, 0] = state[at]
            D_[s, r, 1] = state[at + LANES]
            A_[s, r, 0] = state[at + 2 * LANES]
            A_[s, r, 1] = state[at + 3 * LANES]
            Q_[s, r] = state[at + 4 * LANES]
            F_[s, r] = -state[at + 5 * LANES]
        sign *= state[12 * LANES + s]
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
                ends[(2 * r + c) * LANES + s] = found[r, 2 * s + c]
                if s + 1 < nodes:
                    ahead = found[r, 2 * s + 2 + c]
                else:
                    ahead = found[r, c] if c == 0 else twist * found[r, c]
                ends[(4 + 2 * r + c) * LANES + s] = ahead
    _backward(m, (found.shape[1] - 1) // 2 - length % LANES, keep, ends, p, null)
    for r in range(2):
        for s in range(LANES):
            i = 2 * s * m
            solution[r, i] = found[r, 2 * s]
            solution[r, i + 1] = found[r, 2 * s + 1]
        for b in range(1, m):
            for s in range(LANES):
                i = 2 * (s * m + b)
                solution[r, i] = keep[b * KEEP + 2 * r * LANES + s]
                solution[r, i + 1] = keep[b * KEEP + (2 * r + 1) * LANES + s]
        for j in range(2 * LANES, 2 * nodes + 1):
            solution[r, 2 * LANES * m + j - 2 * LANES] = found[r, j]
