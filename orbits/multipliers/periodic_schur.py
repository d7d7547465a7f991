"""Eigenvalues of a long product of small matrices, without trusting the product.

A cycle of L maps has the linearised factors M_i = -D_i^{-1} A_i (A_i = dg_i/dx_i, D_i = dg_i/dx_{i+1}); its
multipliers are the eigenvalues of S M_{L-1} ... M_0, with S = diag(1, twist, twist, ...) the closure.

Two levels. The product is formed in scaled form together with a bound on its rounding error, the trace of
sum_j |M_{L-1} .. M_{j+1}| |M_j| |M_{j-1} .. M_0| (entry by entry, so that badly scaled nodes do no harm). Where
that is small, or hardly more than what rounding the factors alone does, sum_j |M_j| |M_{j-1} .. M_0 M_{L-1} ..
M_{j+1}|, the product is the answer; for 2 x 2 factors the smaller multiplier comes from the product of the
determinants, so it keeps its relative accuracy however small it is. Otherwise the periodic QR algorithm
(`orbits.multipliers.periodic_qr`) works on the factors. Both cost O(L) time and memory, and neither allocates.
"""

import ctypes
import math

import numpy as np
from llvmlite.binding import add_symbol
from numba import types

from orbits.kernel import kernel
from orbits.multipliers.periodic_qr import (
    LARGE,
    SMALL,
    UNIT_ROUNDOFF,
    deficiency,
    factors,
    periodic_multipliers,
    scaled,
    scratch_size,
    sort_eigenvalues,
)
from orbits.multipliers.small_eigenvalues import eigenvalues

__all__ = ["multipliers", "multipliers_of_two", "periodic_multipliers", "scratch_size"]

CERTIFIED = 1e-10  # relative error of a multiplier up to which the scaled product is trusted
EXCESS = (
    50.0  # also trusted: a bound that exceeds the effect of rounding the factors themselves by less than this
)
PASSABLE = 1e-7
CERTAIN, UNCERTAIN, BROKEN, UNDEFINED = 1, 0, 2, -1


@kernel
def _fast_two(A, D, twist, re, im, scratch):
    """Multipliers of 2 x 2 factors from the scaled product: CERTAIN; UNCERTAIN: the error bound is too large;
    BROKEN: the product vanished or left the range of numbers; UNDEFINED: a D_i is singular."""
    length = A.shape[0]
    p00, p01, p10, p11 = 1.0, 0.0, 0.0, 1.0
    norm = 1.0
    power = 0
    det = 1.0
    det_power = 0
    for i in range(length):
        a, b, c, d = D[i, 0, 0], D[i, 0, 1], D[i, 1, 0], D[i, 1, 1]
        e, f, g, h = A[i, 0, 0], A[i, 0, 1], A[i, 1, 0], A[i, 1, 1]
        delta = a * d - b * c
        if not abs(delta) > 0.0:
            return UNDEFINED
        inverse = -1.0 / delta
        m00 = (d * e - b * g) * inverse
        m01 = (d * f - b * h) * inverse
        m10 = (a * g - c * e) * inverse
        m11 = (a * h - c * f) * inverse
        det *= (f * g - e * h) * inverse
        k = 9 * i
        scratch[k], scratch[k + 1], scratch[k + 2], scratch[k + 3] = m00, m01, m10, m11
        scratch[k + 4], scratch[k + 5], scratch[k + 6], scratch[k + 7] = p00, p01, p10, p11
        scratch[k + 8] = power
        p00, p10 = m00 * p00 + m01 * p10, m10 * p00 + m11 * p10
        p01, p11 = m00 * p01 + m01 * p11, m10 * p01 + m11 * p11
        norm = abs(p00) + abs(p01) + abs(p10) + abs(p11)
        if not SMALL < norm < LARGE:
            if norm == 0.0 or not norm < math.inf:
                return BROKEN
            shift = math.frexp(norm)[1]
            factor = math.ldexp(1.0, -shift)
            p00, p01, p10, p11 = p00 * factor, p01 * factor, p10 * factor, p11 * factor
            norm *= factor
            power += shift
        if not SMALL < abs(det) < LARGE and det != 0.0:
            shift = math.frexp(det)[1]
            det *= math.ldexp(1.0, -shift)
            det_power += shift
    trace = p00 + twist * p11
    half = 0.5 * trace
    det *= twist
    scratch[9 * length], scratch[9 * length + 1] = det, det_power
    lift = det_power - 2 * power
    if det == 0.0 or lift < -900:
        relative = 0.0
    elif lift > 900:
        return UNCERTAIN
    else:
        relative = det * math.ldexp(1.0, lift)
    disc = half * half - relative
    if disc >= 0.0:
        root = half + math.copysign(math.sqrt(disc), half)
        modulus = abs(root)
    else:
        root = half
        modulus = math.sqrt(relative)
    # the error bound; (s) is the product after factor i, (p) the product before it
    s00, s01, s10, s11 = 1.0, 0.0, 0.0, twist
    back = 0
    bound = 0.0
    inherent = 0.0
    for i in range(length - 1, -1, -1):
        k = 9 * i
        m00, m01, m10, m11 = scratch[k], scratch[k + 1], scratch[k + 2], scratch[k + 3]
        p00, p01, p10, p11 = scratch[k + 4], scratch[k + 5], scratch[k + 6], scratch[k + 7]
        a00, a01, a10, a11 = abs(m00), abs(m01), abs(m10), abs(m11)
        weight = a00 * (abs(p00 * s00) + abs(p01 * s10)) + a01 * (abs(p10 * s00) + abs(p11 * s10))
        weight += a10 * (abs(p00 * s01) + abs(p01 * s11)) + a11 * (abs(p10 * s01) + abs(p11 * s11))
        least = a00 * abs(p00 * s00 + p01 * s10) + a01 * abs(p10 * s00 + p11 * s10)
        least += a10 * abs(p00 * s01 + p01 * s11) + a11 * abs(p10 * s01 + p11 * s11)
        raised = int(scratch[k + 8]) + back - power
        if raised != 0:
            factor = math.ldexp(1.0, min(max(raised, -1000), 900))
            weight *= factor
            least *= factor
        bound += weight
        inherent += least
        s00, s01 = s00 * m00 + s01 * m10, s00 * m01 + s01 * m11
        s10, s11 = s10 * m00 + s11 * m10, s10 * m01 + s11 * m11
        norm = abs(s00) + abs(s01) + abs(s10) + abs(s11)
        if not SMALL < norm < LARGE:
            if not norm < math.inf:
                return UNCERTAIN
            if norm == 0.0:
                break
            shift = math.frexp(norm)[1]
            factor = math.ldexp(1.0, -shift)
            s00, s01, s10, s11 = s00 * factor, s01 * factor, s10 * factor, s11 * factor
            back += shift
    error = bound * UNIT_ROUNDOFF
    if not (error <= CERTIFIED * modulus or (bound <= EXCESS * inherent and error <= PASSABLE * modulus)):
        return UNCERTAIN
    if disc >= 0.0:
        first = scaled(root, power)
        second = scaled(det / root, det_power - power) if root != 0.0 else 0.0
        if abs(second) > abs(first) or (abs(second) == abs(first) and second > first):
            first, second = second, first
        re[0], re[1], im[0], im[1] = first, second, 0.0, 0.0
    else:
        re[0] = re[1] = scaled(half, power)
        im[0] = scaled(math.sqrt(-disc), power)
        im[1] = -im[0]
    return CERTAIN


@kernel
def _dominant_two(length, twist, re, im, scratch):
    """Two multipliers of different size: the larger one by carrying its eigenvector round the cycle until it settles.

    Takes the factors and the determinant from what `_fast_two` left in `scratch`. Rounding is not amplified: the
    direction of fastest growth attracts. UNCERTAIN where the two are too close for that.
    """
    x, y = 0.8, 0.6
    before = 2.0
    for sweep in range(40):
        x0, y0 = x, y
        value, power = 1.0, 0
        for i in range(length):
            k = 9 * i
            x, y = scratch[k] * x + scratch[k + 1] * y, scratch[k + 2] * x + scratch[k + 3] * y
            size = math.sqrt(x * x + y * y)
            if not 0.0 < size < math.inf:
                return UNCERTAIN
            by = 1.0 / size
            x *= by
            y *= by
            value *= size
            if not SMALL < value < LARGE:
                shift = math.frexp(value)[1]
                value *= math.ldexp(1.0, -shift)
                power += shift
        y *= twist
        turned = abs(x * y0 - y * x0)
        if turned <= 1e-15 or (turned <= 1e-13 and turned >= 0.5 * before):
            value = math.copysign(value, x * x0 + y * y0)
            det = scratch[9 * length]
            re[0], re[1] = scaled(value, power), scaled(det / value, int(scratch[9 * length + 1]) - power)
            im[0] = im[1] = 0.0
            return CERTAIN if abs(re[1]) < abs(re[0]) else UNCERTAIN
        if sweep > 3 and turned > 0.5 * before:
            return UNCERTAIN
        before = turned
    return UNCERTAIN


@ctypes.CFUNCTYPE(
    ctypes.c_int32, *[ctypes.c_void_p] * 2, *[ctypes.c_int64] * 2, ctypes.c_double, *[ctypes.c_void_p] * 3
)
def _late(A, D, length, n, twist, re, im, scratch):
    """`periodic_multipliers`, called by address from compiled code: most runs never need it, nor wait for it."""

    def array(address, *shape):
        return np.ctypeslib.as_array((ctypes.c_double * math.prod(shape)).from_address(address)).reshape(
            shape
        )

    return periodic_multipliers(
        array(A, length, n, n),
        array(D, length, n, n),
        twist,
        array(re, n),
        array(im, n),
        array(scratch, scratch_size(length, n)),
    )


add_symbol("contvines_periodic_multipliers", ctypes.cast(_late, ctypes.c_void_p).value)
_periodic = types.ExternalFunction(
    "contvines_periodic_multipliers",
    types.int32(
        types.uintp,
        types.uintp,
        types.int64,
        types.int64,
        types.float64,
        types.uintp,
        types.uintp,
        types.uintp,
    ),
)


@kernel
def _fast_any(A, D, twist, re, im, scratch):
    """The scaled product for factors of any order; the bound is the largest row sum of the matrix of bounds."""
    length, n = A.shape[0], A.shape[1]
    size = length * n * n
    M = scratch[:size].reshape((length, n, n))
    before = scratch[size : 2 * size].reshape((length, n, n))
    powers = scratch[2 * size : 2 * size + length]
    rest = scratch[2 * size + length :]
    P = rest[: n * n].reshape((n, n))
    N = rest[n * n : 2 * n * n].reshape((n, n))
    x, y = rest[2 * n * n : 2 * n * n + n], rest[2 * n * n + n : 2 * n * n + 2 * n]
    if not factors(A, D, twist, M, P):
        return UNDEFINED
    for r in range(n):
        for c in range(n):
            P[r, c] = 1.0 if r == c else 0.0
    power = 0
    for i in range(length):
        norm = 0.0
        for r in range(n):
            for c in range(n):
                before[i, r, c] = P[r, c]
                value = 0.0
                for k in range(n):
                    value += M[i, r, k] * P[k, c]
                N[r, c] = value
                norm += abs(value)
        powers[i] = power
        if not SMALL < norm < LARGE:
            if norm == 0.0 or not norm < math.inf:
                return UNCERTAIN
            shift = math.frexp(norm)[1]
            factor = math.ldexp(1.0, -shift)
            for r in range(n):
                for c in range(n):
                    N[r, c] *= factor
            power += shift
        P, N = N, P
    # from the other end: bound on the rounding of the product, in units of 2^power
    own = 0.0
    for r in range(n):
        row = 0.0
        for c in range(n):
            row += abs(P[r, c])
        own = max(own, row)
        y[r] = 0.0
    for r in range(n):
        for c in range(n):
            re[c] = P[r, c]
        for c in range(n):
            before[0, r, c] = re[c]  # the product itself: before[0] was the identity
    for r in range(n):
        for c in range(n):
            P[r, c] = 1.0 if r == c else 0.0
    back = 0
    for i in range(length - 1, -1, -1):
        for r in range(n):
            x[r] = 0.0
            for c in range(n):
                if i > 0:
                    for k in range(n):
                        x[r] += abs(M[i, r, k] * before[i, k, c])
                else:
                    x[r] += abs(M[i, r, c])
        raised = int(powers[i]) + back - power
        factor = math.ldexp(1.0, min(max(raised, -1000), 900))
        for r in range(n):
            for c in range(n):
                y[r] += abs(P[r, c]) * x[c] * factor
        norm = 0.0
        for r in range(n):
            for c in range(n):
                value = 0.0
                for k in range(n):
                    value += P[r, k] * M[i, k, c]
                N[r, c] = value
                norm += abs(value)
        if not SMALL < norm < LARGE:
            if not norm < math.inf:
                return UNCERTAIN
            if norm == 0.0:
                break
            shift = math.frexp(norm)[1]
            factor = math.ldexp(1.0, -shift)
            for r in range(n):
                for c in range(n):
                    N[r, c] *= factor
            back += shift
        P, N = N, P
    error = own
    for r in range(n):
        error = max(error, y[r])
    error *= n * UNIT_ROUNDOFF
    if not eigenvalues(before[0], re, im):
        return UNCERTAIN
    sort_eigenvalues(re, im)
    lost = min(deficiency(A), n)
    if lost < n and not error <= CERTIFIED * math.hypot(re[n - 1 - lost], im[n - 1 - lost]):
        return UNCERTAIN
    for k in range(n):
        re[k], im[k] = scaled(re[k], power), scaled(im[k], power)
        if k >= n - lost:
            re[k] = im[k] = 0.0
    return CERTAIN


@kernel
def _otherwise(found, A, D, twist, re, im, scratch):
    """What is left to do after the scaled product."""
    length, n = A.shape[0], A.shape[1]
    if found == CERTAIN:
        return True
    if found == UNDEFINED:
        for j in range(n):
            re[j] = im[j] = math.nan
        return False
    converged = _periodic(
        A.ctypes.data, D.ctypes.data, length, n, twist, re.ctypes.data, im.ctypes.data, scratch.ctypes.data
    )
    return converged != 0


@kernel
def multipliers_of_two(A, D, twist, re, im, scratch):
    """`multipliers` for nodes of two unknowns."""
    found = _fast_two(A, D, twist, re, im, scratch)
    if found == UNCERTAIN:
        found = _dominant_two(A.shape[0], twist, re, im, scratch)
    return _otherwise(found, A, D, twist, re, im, scratch)


@kernel
def multipliers(A, D, twist, re, im, scratch):
    """Multipliers of a cycle: eigenvalues of diag(1, twist, ..) M_{L-1} .. M_0, M_i = -D_i^{-1} A_i.

    Parameters
    ----------
    A, D : ndarray (L, n, n)
        Derivatives of the i-th map with respect to its first and its second node.
    twist : float
        +1 for a full period, -1 for half a period followed by the mirror.
    re, im : ndarray (n,)
        Filled: descending modulus, then real part; pairs exactly conjugate; exact zeros where a stick
        forgets. Beyond the range of floats they are clamped to 2**1023 or 2**-1021 in size. NaN if a D_i is
        singular.
    scratch : ndarray (scratch_size(L, n),)

    Returns
    -------
    converged : bool
    """
    if A.shape[1] == 2:
        return multipliers_of_two(A, D, twist, re, im, scratch)
    return _otherwise(_fast_any(A, D, twist, re, im, scratch), A, D, twist, re, im, scratch)
