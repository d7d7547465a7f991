"""Elimination of the inner nodes of cycles with two unknowns per node: Householder reflections, in registers.

One reflection step needs the one before it, and most of its time is waiting for a square root and a division. The
cycle is therefore cut in two halves that are eliminated side by side, from node 1 and from the middle on; the
middle node comes last. (Two segments of Wright's structured orthogonal factorisation, SIAM J. Sci. Stat. Comput. 13
(1992) 742; `orbits.elimination.vectorised` has eight.) Sums are written with what is known last at their end.
"""

from __future__ import annotations

import math
from typing import Any

from contvines_ground.parts import part
from orbits.compiling.decorators import OPTIONS, kernel
from orbits.elimination.closure import closing

close = closing(2)
NEVER_ZERO = 1e-290
FAST: dict[str, Any] = {**OPTIONS, "forceinline": True, "fastmath": {"contract", "nsz", "arcp"}}


@part(**FAST)
def reflect(a00, a01, u00, u01, w0, r0, a10, a11, u10, u11, w1, r1, b00, b01, b10, b11, d00, d01, d10, d11, q0, q1, f0, f1):  # fmt: skip
    """Two Householder reflections that clear the first two columns of the lower rows of

        a00 a01  u00 u01   0   0   w0 r0
        a10 a11  u10 u11   0   0   w1 r1
        b00 b01   0   0   d00 d01  q0 f0
        b10 b11   0   0   d10 d11  q1 f1

    Returns the upper rows, without the zero and with the inverses of the diagonal (fifteen numbers), then the lower
    rows (twelve).
    """
    # first reflection, on the column (a00, a10, b00, b10)
    square = b00 * b00 + b10 * b10 + NEVER_ZERO + a00 * a00 + a10 * a10
    n = -math.copysign(math.sqrt(square), a00)
    v = a00 - n
    t = 1.0 / (n * a00 - square)  # 1 / (n v), a sum of two negative numbers
    k = (b00 * b01 + b10 * b11 + a10 * a11 + v * a01) * t
    a01 += k * v
    a11 += k * a10
    b01 += k * b00
    b11 += k * b10
    k = (a10 * u10 + v * u00) * t
    u00 += k * v
    u10 += k * a10
    g00 = k * b00
    g10 = k * b10
    k = (a10 * u11 + v * u01) * t
    u01 += k * v
    u11 += k * a10
    g01 = k * b00
    g11 = k * b10
    k = (b00 * d00 + b10 * d10) * t
    e00 = k * v
    e10 = k * a10
    d00 += k * b00
    d10 += k * b10
    k = (b00 * d01 + b10 * d11) * t
    e01 = k * v
    e11 = k * a10
    d01 += k * b00
    d11 += k * b10
    k = (b00 * q0 + b10 * q1 + a10 * w1 + v * w0) * t
    w0 += k * v
    w1 += k * a10
    q0 += k * b00
    q1 += k * b10
    k = (b00 * f0 + b10 * f1 + a10 * r1 + v * r0) * t
    r0 += k * v
    r1 += k * a10
    f0 += k * b00
    f1 += k * b10
    # second reflection, on the column (a11, b01, b11)
    square = a11 * a11 + b01 * b01 + b11 * b11 + NEVER_ZERO
    n2 = -math.copysign(math.sqrt(square), a11)
    v = a11 - n2
    t = 1.0 / (n2 * a11 - square)
    k = (b01 * g00 + b11 * g10 + v * u10) * t
    u10 += k * v
    g00 += k * b01
    g10 += k * b11
    k = (b01 * g01 + b11 * g11 + v * u11) * t
    u11 += k * v
    g01 += k * b01
    g11 += k * b11
    k = (b01 * d00 + b11 * d10 + v * e10) * t
    e10 += k * v
    d00 += k * b01
    d10 += k * b11
    k = (b01 * d01 + b11 * d11 + v * e11) * t
    e11 += k * v
    d01 += k * b01
    d11 += k * b11
    k = (b01 * q0 + b11 * q1 + v * w1) * t
    w1 += k * v
    q0 += k * b01
    q1 += k * b11
    k = (b01 * f0 + b11 * f1 + v * r1) * t
    r1 += k * v
    f0 += k * b01
    f1 += k * b11
    upper = (1.0 / n, a01, u00, u01, e00, e01, w0, r0, 1.0 / n2, u10, u11, e10, e11, w1, r1)
    return (*upper, d00, d01, g00, g01, q0, f0, d10, d11, g10, g11, q1, f1)


@kernel
def _first(F, A, D, Q, i):
    """Block i as the condensed equation V x_{i+1} + U x_i + w p = r: the state (V, U, w, r) of its two rows."""
    return (
        D[i, 0, 0], D[i, 0, 1], A[i, 0, 0], A[i, 0, 1], Q[i, 0], -F[i, 0],
        D[i, 1, 0], D[i, 1, 1], A[i, 1, 0], A[i, 1, 1], Q[i, 1], -F[i, 1],
    )  # fmt: skip


@kernel
def _keep(row, top, bottom):
    """Store the upper rows; the state that goes on is returned, with the sign of the diagonal."""
    top[0], top[1], top[2], top[3], top[4], top[5], top[6], top[7] = row[:8]
    bottom[1], bottom[2], bottom[3], bottom[4], bottom[5], bottom[6], bottom[7] = row[8:15]
    return row[15:], math.copysign(1.0, row[0] * row[8])


@kernel
def _further(state, F, A, D, Q, i, stored):
    """Eliminate node i between the state and block i."""
    a00, a01, u00, u01, w0, r0, a10, a11, u10, u11, w1, r1 = state
    row = reflect(
        a00, a01, u00, u01, w0, r0, a10, a11, u10, u11, w1, r1,
        A[i, 0, 0], A[i, 0, 1], A[i, 1, 0], A[i, 1, 1], D[i, 0, 0], D[i, 0, 1], D[i, 1, 0], D[i, 1, 1],
        Q[i, 0], Q[i, 1], -F[i, 0], -F[i, 1],
    )  # fmt: skip
    return _keep(row, stored[i, 0], stored[i, 1])


@kernel
def _meet(state, other, stored):
    """Eliminate the middle node between the condensed blocks of both halves."""
    a00, a01, u00, u01, w0, r0, a10, a11, u10, u11, w1, r1 = state
    d00, d01, b00, b01, q0, f0, d10, d11, b10, b11, q1, f1 = other
    row = reflect(
        a00, a01, u00, u01, w0, r0, a10, a11, u10, u11, w1, r1,
        b00, b01, b10, b11, d00, d01, d10, d11, q0, q1, f0, f1,
    )  # fmt: skip
    return _keep(row, stored[0], stored[1])


@kernel
def forward(F, A, D, Q, stored):
    """Eliminate nodes 1 .. L - 1; returns the state (V, U, w, r) of V x_L + U x_0 + w p = r, and a sign.

    Row i of `stored` ties node i to the first node of its half and to the node after it; the middle node to x_0 and x_L.
    """
    length = F.shape[0]
    middle = length // 2
    state = _first(F, A, D, Q, 0)
    if length == 1:
        return state, 1.0
    sign = 1.0
    other = _first(F, A, D, Q, middle)
    for i in range(1, middle):
        state, one = _further(state, F, A, D, Q, i, stored)
        other, two = _further(other, F, A, D, Q, middle + i, stored)
        sign *= one * two
    if length % 2 == 1:
        other, two = _further(other, F, A, D, Q, length - 1, stored)
        sign *= two
    state, two = _meet(state, other, stored[middle])
    return state, sign * two


@part(**FAST)
def _back(top, bottom, p, x0, x1, n0, n1):
    """A node from the first node x of its half and the node n after it, for the right-hand side as it is."""
    second = (
        bottom[7] - bottom[6] * p - bottom[2] * x0 - bottom[3] * x1 - bottom[5] * n1 - bottom[4] * n0
    ) * bottom[1]
    first = top[7] - top[6] * p - top[2] * x0 - top[3] * x1 - top[5] * n1 - top[4] * n0
    return (first - top[1] * second) * top[0], second


@part(**FAST)
def _back_null(top, bottom, p, x0, x1, n0, n1):
    """The same for no right-hand side."""
    second = (-bottom[6] * p - bottom[2] * x0 - bottom[3] * x1 - bottom[5] * n1 - bottom[4] * n0) * bottom[1]
    first = -top[6] * p - top[2] * x0 - top[3] * x1 - top[5] * n1 - top[4] * n0
    return (first - top[1] * second) * top[0], second


@kernel
def backward(length, stored, twist, solution):
    """Fill nodes 1 .. L - 1 of `solution` (2, 2 L + 1), particular and null, from x_0 and p in it."""
    if length == 1:
        return
    middle = length // 2
    x, y = solution[0], solution[1]
    p, null = x[2 * length], y[2 * length]
    x0, x1, y0, y1 = x[0], x[1], y[0], y[1]
    e0, e1, z0, z1 = x0, twist * x1, y0, twist * y1
    top, bottom = stored[middle, 0], stored[middle, 1]
    m0, m1 = _back(top, bottom, p, x0, x1, e0, e1)
    n0, n1 = _back_null(top, bottom, null, y0, y1, z0, z1)
    x[2 * middle], x[2 * middle + 1] = m0, m1
    y[2 * middle], y[2 * middle + 1] = n0, n1
    a0, a1, b0, b1 = m0, m1, n0, n1  # the node after, in the first half
    if length % 2 == 1:
        last = length - 1
        top, bottom = stored[last, 0], stored[last, 1]
        e0, e1 = _back(top, bottom, p, m0, m1, e0, e1)
        z0, z1 = _back_null(top, bottom, null, n0, n1, z0, z1)
        x[2 * last], x[2 * last + 1] = e0, e1
        y[2 * last], y[2 * last + 1] = z0, z1
    for i in range(middle - 1, 0, -1):
        top, bottom = stored[i, 0], stored[i, 1]
        a0, a1 = _back(top, bottom, p, x0, x1, a0, a1)
        b0, b1 = _back_null(top, bottom, null, y0, y1, b0, b1)
        x[2 * i], x[2 * i + 1] = a0, a1
        y[2 * i], y[2 * i + 1] = b0, b1
        j = middle + i
        top, bottom = stored[j, 0], stored[j, 1]
        e0, e1 = _back(top, bottom, p, m0, m1, e0, e1)
        z0, z1 = _back_null(top, bottom, null, n0, n1, z0, z1)
        x[2 * j], x[2 * j + 1] = e0, e1
        y[2 * j], y[2 * j + 1] = z0, z1


@kernel
def eliminate(F, A, D, Q, twist, stored, small, order, solution):
    """Particular and null solution of J x + F_p p = -F, two halves side by side; returns a sign."""
    state, sign = forward(F, A, D, Q, stored)
    v00, v01, u00, u01, w0, r0, v10, v11, u10, u11, w1, r1 = state
    small[0, 0], small[0, 1], small[0, 2], small[0, 3] = u00 + v00, u01 + twist * v01, w0, r0
    small[1, 0], small[1, 1], small[1, 2], small[1, 3] = u10 + v10, u11 + twist * v11, w1, r1
    sign *= close(small, solution, order)
    backward(F.shape[0], stored, twist, solution)
    return sign
