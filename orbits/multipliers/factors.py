"""The factors of a cycle, M_i = -D_i^{-1} A_i, and numbers with an exponent of their own: common ground of
`orbits.multipliers.product_of_two`, `product_of_any` and `periodic_qr`."""

import math

from orbits.compiling.decorators import kernel

UNIT_ROUNDOFF = 2.0**-53
LARGE, SMALL = 2.0**200, 2.0**-200  # a running product is rescaled outside this range
LARGEST, LEAST = 2.0**1023, 2.0**-1021  # multipliers beyond these are clamped (never to 0 or infinity)


def scratch_size(length, n):
    """Number of floats of scratch for `length` factors of order `n`."""
    return length * (3 * n * n + 2) + 8 * n * n + 8 * n


@kernel
def scaled(mantissa, exponent):
    """mantissa * 2**exponent, clamped away from 0 and infinity (an exact 0 stays 0)."""
    if mantissa == 0.0 or not math.isfinite(mantissa):
        return mantissa
    fraction, own = math.frexp(mantissa)
    total = own + exponent
    if total > 1023:
        return math.copysign(LARGEST, mantissa)
    if total < -1020:
        return math.copysign(LEAST, mantissa)
    return math.ldexp(fraction, total)


@kernel
def sort_eigenvalues(re, im):
    """Descending modulus, then real part, then imaginary part (insertion sort in place)."""
    for i in range(1, re.size):
        x, y = re[i], im[i]
        r = math.hypot(x, y)
        j = i - 1
        while j >= 0:
            other = math.hypot(re[j], im[j])
            if other > r or (other == r and (re[j] > x or (re[j] == x and im[j] >= y))):
                break
            re[j + 1], im[j + 1] = re[j], im[j]
            j -= 1
        re[j + 1], im[j + 1] = x, y


@kernel
def factors(A, D, twist, M, lu):
    """Fill M[i] = -D_i^{-1} A_i (LU, partial pivoting), closure included; False if some D_i is singular."""
    length, n = A.shape[0], A.shape[1]
    for i in range(length):
        for r in range(n):
            for c in range(n):
                lu[r, c] = D[i, r, c]
                M[i, r, c] = -A[i, r, c]
        for k in range(n):
            pivot = k
            for r in range(k + 1, n):
                if abs(lu[r, k]) > abs(lu[pivot, k]):
                    pivot = r
            if not abs(lu[pivot, k]) > 0.0:
                return False
            if pivot != k:
                for c in range(n):
                    lu[k, c], lu[pivot, c] = lu[pivot, c], lu[k, c]
                    M[i, k, c], M[i, pivot, c] = M[i, pivot, c], M[i, k, c]
            for r in range(k + 1, n):
                factor = lu[r, k] / lu[k, k]
                if factor != 0.0:
                    for c in range(k + 1, n):
                        lu[r, c] -= factor * lu[k, c]
                    for c in range(n):
                        M[i, r, c] -= factor * M[i, k, c]
        for c in range(n):
            for r in range(n - 1, -1, -1):
                value = M[i, r, c]
                for k in range(r + 1, n):
                    value -= lu[r, k] * M[i, k, c]
                M[i, r, c] = value / lu[r, r]
    if twist != 1.0:
        for r in range(1, n):
            for c in range(n):
                M[length - 1, r, c] *= twist
    return True


@kernel
def deficiency(A):
    """Least number of multipliers that vanish exactly: a zero row of A_i forgets one direction (a stick)."""
    most = 0
    for i in range(A.shape[0]):
        rows = 0
        for r in range(A.shape[1]):
            empty = True
            for c in range(A.shape[2]):
                if A[i, r, c] != 0.0:
                    empty = False
                    break
            if empty:
                rows += 1
        most = max(most, rows)
    return most
