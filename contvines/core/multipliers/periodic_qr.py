"""The periodic QR algorithm: eigenvalues of a product of small matrices from its factors.

After Bojanczyk, Golub and Van Dooren, Proc. SPIE 1770 (1992) 31: orthogonal changes of basis between the
factors bring all but one to upper triangular form and the last to upper Hessenberg form; implicit QR steps then
chase the rotation round the cycle until the last is triangular too. Complex arithmetic with single shifts keeps
it short; pairs are made exactly conjugate at the end. Scales are carried as (mantissa, exponent): no overflow.
O(L) time and memory.
"""

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


def _rotation(f, g):
    """(c, s) with c real such that [[c, s], [-conj s, c]] maps (f, g) to (r, 0)."""
    size = abs(g)
    if size == 0.0:
        return 1.0, 0j
    other = abs(f)
    if max(size, other) < 2.0**-500:  # numbers below 2^-1022 have few bits
        return _rotation(2.0**400 * f, 2.0**400 * g)
    if other < 2.0**-560:
        return 0.0, g.conjugate() / size
    norm = math.hypot(other, size)
    return other / norm, (f / other) * (g.conjugate() / norm)


def _rows(X, k, c, s, first, last):
    """Rotate rows k, k+1 of X over columns first..last."""
    for j in range(first, last + 1):
        x, y = X[k, j], X[k + 1, j]
        X[k, j] = c * x + s * y
        X[k + 1, j] = c * y - s.conjugate() * x


def _columns(X, k, c, s, first, last):
    """Rotate columns k, k+1 of X (by the adjoint) over rows first..last."""
    for i in range(first, last + 1):
        x, y = X[i, k], X[i, k + 1]
        X[i, k] = c * x + s.conjugate() * y
        X[i, k + 1] = c * y - s * x


def _carry(T, k, c, s, lo, hi, top):
    """Carry a rotation of rows k, k+1 of the last factor round the cycle to its columns (rows lo..top)."""
    last = T.shape[0] - 1
    for i in range(last):
        _columns(T[i], k, c, s, lo, k + 1)
        c, s = _rotation(T[i, k, k], T[i, k + 1, k])
        _rows(T[i], k, c, s, k, hi)
        T[i, k + 1, k] = 0.0
    _columns(T[last], k, c, s, lo, top)


def _reduce(T):
    """Periodic Hessenberg-triangular form: T[0..L-2] upper triangular, T[L-1] upper Hessenberg."""
    length, n = T.shape[0], T.shape[1]
    for i in range(length - 1):
        for j in range(n - 1):
            for k in range(n - 2, j - 1, -1):
                c, s = _rotation(T[i, k, j], T[i, k + 1, j])
                _rows(T[i], k, c, s, j, n - 1)
                T[i, k + 1, j] = 0.0
                _columns(T[i + 1], k, c, s, 0, n - 1)
    H = T[length - 1]
    for j in range(n - 2):
        for k in range(n - 2, j, -1):
            c, s = _rotation(H[k, j], H[k + 1, j])
            _rows(H, k, c, s, j, n - 1)
            H[k + 1, j] = 0.0
            _carry(T, k, c, s, 0, n - 1, n - 1)


def _shift(T, hi):
    """Wilkinson's shift of the trailing 2 x 2 of the product over the leading scale: (mantissa, exponent)."""
    last = T.shape[0] - 1
    a, b, d = 1.0 + 0j, 0j, 1.0 + 0j
    power = 0
    for i in range(last):
        X = T[i]
        b = X[hi - 1, hi - 1] * b + X[hi - 1, hi] * d
        a *= X[hi - 1, hi - 1]
        d *= X[hi, hi]
        norm = abs(a) + abs(b) + abs(d)
        if norm == 0.0:
            return 0j, 0
        factor, shift = in_range(norm)
        a, b, d, power = a * factor, b * factor, d * factor, power + shift
    H = T[last]
    p00, p01 = H[hi - 1, hi - 1] * a, H[hi - 1, hi - 1] * b + H[hi - 1, hi] * d
    p10, p11 = H[hi, hi - 1] * a, H[hi, hi - 1] * b + H[hi, hi] * d
    half = 0.5 * (p00 - p11)
    root = (half * half + p01 * p10) ** 0.5
    if (half * root.conjugate()).real < 0.0:
        root = -root
    total = half + root
    if total == 0.0:
        return p11, power
    return p11 - p01 * p10 / total, power


def _iterate(T, turns):
    """Periodic QR iteration on a periodic Hessenberg-triangular form; False if it does not converge."""
    last = T.shape[0] - 1
    H = T[last]
    hi = T.shape[1] - 1
    tries = 0
    while hi > 0:
        lo = hi
        while lo > 0:
            size = abs(H[lo - 1, lo - 1]) + abs(H[lo, lo])
            if size == 0.0:
                size = np.abs(H[lo - 1, : hi + 1]).sum()
            if abs(H[lo, lo - 1]) <= UNIT_ROUNDOFF * size:
                H[lo, lo - 1] = 0.0
                break
            lo -= 1
        if lo == hi:
            hi -= 1
            tries = 0
            continue
        singular = False
        ratio, power = 1.0 + 0j, 0  # the scale of the product's first column
        for i in range(last):
            for k in range(lo, hi + 1):
                size = np.abs(T[i, k, k : hi + 1]).sum() + np.abs(T[i, lo:k, k]).sum()
                if abs(T[i, k, k]) <= UNIT_ROUNDOFF * size:
                    T[i, k, k] = 0.0
                    singular = True
            ratio *= T[i, lo, lo]
            factor, shift = in_range(abs(ratio))
            ratio, power = ratio * factor, power + shift
        if singular or tries < 2 or tries % 8 == 7:
            # a step without shift, explicit: it sorts the moduli and sweeps exact zeros down
            for k in range(lo, hi):
                c, s = _rotation(H[k, k], H[k + 1, k])
                _rows(H, k, c, s, k, hi)
                H[k + 1, k] = 0.0
                turns[2 * k], turns[2 * k + 1] = c, s
            for k in range(lo, hi):
                _carry(T, k, turns[2 * k].real, turns[2 * k + 1], lo, hi, k + 1)
        else:
            target, own = _shift(T, hi)
            if tries % 10 == 9:
                target *= 1.0 + 0.5j
            gap = min(own - power, 900)
            first = H[lo, lo] - (target / ratio * math.ldexp(1.0, gap) if gap >= -900 else 0.0)
            second = H[lo + 1, lo]
            c, s = _rotation(first, second)
            _rows(H, lo, c, s, lo, hi)
            _carry(T, lo, c, s, lo, hi, min(lo + 2, hi))
            for k in range(lo + 1, hi):
                c, s = _rotation(H[k, k - 1], H[k + 1, k - 1])
                _rows(H, k, c, s, k - 1, hi)
                H[k + 1, k - 1] = 0.0
                _carry(T, k, c, s, lo, hi, min(k + 2, hi))
        tries += 1
        if tries > 120:
            return False
    return True


def _apart(x, xp, y, yp):
    """|x 2^xp - conj(y) 2^yp| and |Im x| 2^xp + |Im y| 2^yp, both over 2^max(xp, yp)."""
    top = max(xp, yp)
    a = x * math.ldexp(1.0, max(xp - top, -1000))
    b = y * math.ldexp(1.0, max(yp - top, -1000))
    return abs(a - b.conjugate()), abs(a.imag) + abs(b.imag)


def _diagonal(T, re, im, value, power):
    """Eigenvalues from the converged form: real ones made real, pairs made exactly conjugate."""
    length, n = T.shape[0], T.shape[1]
    for k in range(n):
        product, raised = 1.0 + 0j, 0
        for i in range(length):
            product *= T[i, k, k]
            factor, shift = in_range(abs(product))
            product, raised = product * factor, raised + shift
        size = abs(product)
        if size > 0.0:
            shift = math.frexp(size)[1]
            product *= math.ldexp(1.0, -shift)
            raised += shift
            value[k], power[k] = product, raised
        else:
            value[k], power[k] = 0j, -2000000
    for k in range(n):
        if power[k].imag != 0.0:
            continue
        mate, closest = -1, 0.5
        for j in range(k + 1, n):
            if power[j].imag == 0.0:
                distance, width = _apart(value[k], int(power[k].real), value[j], int(power[j].real))
                if width > 0.0 and distance <= closest * width:
                    mate, closest = j, distance / width
        raised = int(power[k].real)
        if mate < 0:
            re[k], im[k] = scaled(value[k].real, raised), 0.0
        else:
            other = value[mate] * math.ldexp(1.0, int(power[mate].real) - raised)
            re[k] = re[mate] = scaled(0.5 * (value[k].real + other.real), raised)
            im[k] = scaled(0.5 * abs(value[k].imag - other.imag), raised)
            im[mate] = -im[k]
            power[mate] += 1j
    return True


def periodic_multipliers(A, D, twist, re, im):
    """Multipliers by the periodic QR algorithm alone: arguments and result as for `multipliers`."""
    n = A.shape[1]
    M = factors(A, D, twist)
    if M is None:
        re[:] = im[:] = math.nan
        return False
    T, small = M.astype(complex), np.zeros(4 * n, complex)
    with np.errstate(all="ignore"):
        _reduce(T)
        converged = _iterate(T, small)
        _diagonal(T, re, im, small[:n], small[n : 2 * n])
    sort_eigenvalues(re, im)
    lost = min(deficiency(A), n)
    re[n - lost :] = im[n - lost :] = 0.0
    return converged
