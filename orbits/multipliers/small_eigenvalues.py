"""Eigenvalues of one small real matrix, compiled and without allocation: Hessenberg form, Francis' double shifts."""

from __future__ import annotations

import math

from orbits.compiling.decorators import kernel

ROUNDOFF = 2.0**-52


@kernel
def _reflect(H, first, count, x, y, z, begin, last):
    """Apply the Householder reflection that maps (x, y, z) to a multiple of e_1 to rows and columns first, .. of H.

    `count` is 2 or 3; rows from column `begin` on, columns down to row `last`.
    """
    n = H.shape[0]
    size = math.sqrt(x * x + y * y + z * z)
    if size == 0.0:
        return
    v = x + math.copysign(size, x)
    square = 2.0 / (v * v + y * y + z * z)
    for j in range(begin, n):
        dot = v * H[first, j] + y * H[first + 1, j]
        if count == 3:
            dot += z * H[first + 2, j]
        dot *= square
        H[first, j] -= dot * v
        H[first + 1, j] -= dot * y
        if count == 3:
            H[first + 2, j] -= dot * z
    for i in range(last + 1):
        dot = v * H[i, first] + y * H[i, first + 1]
        if count == 3:
            dot += z * H[i, first + 2]
        dot *= square
        H[i, first] -= dot * v
        H[i, first + 1] -= dot * y
        if count == 3:
            H[i, first + 2] -= dot * z


@kernel
def eigenvalues(H, re, im):
    """Fill `re`, `im` (n,) with the eigenvalues of H (n, n), which is destroyed; pairs are exactly conjugate.

    Returns
    -------
    converged : bool
    """
    n = H.shape[0]
    for j in range(n - 2):  # Hessenberg form, one entry at a time from below
        for i in range(n - 2, j, -1):
            _reflect(H, i, 2, H[i, j], H[i + 1, j], 0.0, j, n - 1)
            H[i + 1, j] = 0.0
    hi = n - 1
    tries = 0
    while hi >= 0:
        lo = hi
        while lo > 0:
            size = abs(H[lo - 1, lo - 1]) + abs(H[lo, lo])
            if size == 0.0:
                size = abs(H[lo - 1, hi]) + abs(H[0, lo])
            if abs(H[lo, lo - 1]) <= ROUNDOFF * size:
                H[lo, lo - 1] = 0.0
                break
            lo -= 1
        if lo == hi:
            re[hi] = H[hi, hi]
            im[hi] = 0.0
            hi -= 1
            tries = 0
            continue
        a, b, c, d = H[hi - 1, hi - 1], H[hi - 1, hi], H[hi, hi - 1], H[hi, hi]
        if lo == hi - 1:
            half = 0.5 * (a - d)
            disc = half * half + b * c
            if disc >= 0.0:
                root = half + math.copysign(math.sqrt(disc), half)
                re[hi - 1] = d + root
                re[hi] = d - b * c / root if root != 0.0 else d
                im[hi - 1] = im[hi] = 0.0
            else:
                re[hi - 1] = re[hi] = d + half
                im[hi - 1] = math.sqrt(-disc)
                im[hi] = -im[hi - 1]
            hi -= 2
            tries = 0
            continue
        tries += 1
        if tries > 60:
            return False
        trace, det = a + d, a * d - b * c
        if tries % 10 == 0:
            size = abs(H[hi, hi - 1]) + abs(H[hi - 1, hi - 2])
            trace, det = 1.5 * size, size * size
        p, q, r, s = H[lo, lo], H[lo, lo + 1], H[lo + 1, lo], H[lo + 1, lo + 1]
        x, y, z = p * p + q * r - trace * p + det, r * (p + s - trace), r * H[lo + 2, lo + 1]
        for k in range(lo, hi):
            count = 3 if k + 2 <= hi else 2
            if k > lo:
                x, y = H[k, k - 1], H[k + 1, k - 1]
                z = H[k + 2, k - 1] if count == 3 else 0.0
            elif count == 2:
                z = 0.0
            _reflect(H, k, count, x, y, z, max(k - 1, 0), min(k + 3, hi))
            if k > lo:
                H[k + 1, k - 1] = 0.0
                if count == 3:
                    H[k + 2, k - 1] = 0.0
    return True
