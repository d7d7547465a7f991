"""The factors of a cycle, M_i = -D_i^{-1} A_i, and numbers with an exponent of their own: common ground of
`contvines.core.multipliers.scaled_product` and `periodic_qr`."""

import math

import numpy as np

UNIT_ROUNDOFF = 2.0**-53
LARGE, SMALL = 2.0**200, 2.0**-200  # a running product is rescaled outside this range
LARGEST, LEAST = 2.0**1023, 2.0**-1021  # multipliers beyond these are clamped (never to 0 or infinity)


def in_range(size):
    """(factor, exponent): the power of two by which a number of this size is divided, where it is very large or small; 0 is left."""
    shift = 0 if size == 0.0 or SMALL < size < LARGE else math.frexp(size)[1]
    return math.ldexp(1.0, -shift), shift


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


def factors(A, D, twist):
    """The factors M_i = -D_i^{-1} A_i, closure included, shape (L, n, n); None if some D_i is singular."""
    try:
        M = -np.linalg.solve(D, A)
    except np.linalg.LinAlgError:
        return None
    M[-1, 1:] *= twist
    return M


def deficiency(A):
    """Least number of multipliers that vanish exactly: a zero row of A_i forgets one direction (a stick)."""
    return int(np.all(A == 0.0, axis=2).sum(axis=1).max())
