"""Multipliers from the scaled product of factors: see `contvines.core.multipliers.periodic_schur`."""

from __future__ import annotations

import math

import numpy as np

from .factors import (
    UNIT_ROUNDOFF,
    deficiency,
    factors,
    in_range,
    scaled,
    sort_eigenvalues,
)
from .settings import CERTIFIED


def _in_range(matrix):
    """The matrix divided by a power of two where its entries are very large or small, and the exponent; None if it is not finite."""
    norm = float(np.abs(matrix).sum())
    if not norm < math.inf:
        return None
    factor, shift = in_range(norm)
    return matrix * factor, shift


def scaled_product(A, D, twist, re, im):
    """Fill in the eigenvalues of the scaled product; whether they are certain. The bound is the largest row sum of the matrix of bounds."""
    length, n = A.shape[0], A.shape[1]
    M = factors(A, D, twist)
    if M is None:
        return False
    before, powers = np.empty((length, n, n)), []
    P, power = np.eye(n), 0
    for i in range(length):
        before[i] = P
        powers.append(power)
        known = _in_range(M[i] @ P)
        if known is None or not known[0].any():
            return False
        P, power = known[0], power + known[1]
    # from the other end: bound on the rounding of the product, in units of 2^power
    bound = np.zeros(n)
    after, back = np.eye(n), 0
    for i in range(length - 1, -1, -1):
        moved = (np.abs(M[i])[:, :, None] * np.abs(before[i])[None]).sum(axis=(1, 2))
        factor = math.ldexp(1.0, min(max(powers[i] + back - power, -1000), 900))
        bound += np.abs(after) @ moved * factor
        known = _in_range(after @ M[i])
        if known is None:
            return False
        after, back = known[0], back + known[1]
        if not after.any():
            break
    error = n * UNIT_ROUNDOFF * max(float(np.abs(P).sum(axis=1).max()), float(bound.max()))
    try:
        found = np.linalg.eigvals(P)
    except np.linalg.LinAlgError:
        return False
    re[:], im[:] = found.real, found.imag
    sort_eigenvalues(re, im)
    lost = min(deficiency(A), n)
    if lost < n and not error <= CERTIFIED * math.hypot(re[n - 1 - lost], im[n - 1 - lost]):
        return False
    for k in range(n):
        re[k], im[k] = scaled(re[k], power), scaled(im[k], power)
    re[n - lost :] = im[n - lost :] = 0.0
    return True
