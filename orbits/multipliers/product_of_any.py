"""Multipliers from the scaled product of factors of any order: see `orbits.multipliers.periodic_schur`."""

import math

from orbits.compiling.decorators import kernel
from orbits.multipliers.factors import (
    LARGE,
    SMALL,
    UNIT_ROUNDOFF,
    deficiency,
    factors,
    scaled,
    sort_eigenvalues,
)
from orbits.multipliers.product_of_two import CERTAIN, CERTIFIED, UNCERTAIN, UNDEFINED
from orbits.multipliers.small_eigenvalues import eigenvalues


@kernel
def _rescaled(N, norm):
    """Divide a matrix by the power of two next to its norm; returns the exponent."""
    shift = math.frexp(norm)[1]
    factor = math.ldexp(1.0, -shift)
    for r in range(N.shape[0]):
        for c in range(N.shape[1]):
            N[r, c] *= factor
    return shift


@kernel
def product_of_any(A, D, twist, re, im, scratch):
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
            power += _rescaled(N, norm)
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
            back += _rescaled(N, norm)
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
