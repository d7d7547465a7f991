"""Eigenvalues of a long product of small matrices, without trusting the product.

A cycle of L maps has the linearised factors M_i = -D_i^{-1} A_i (A_i = dg_i/dx_i, D_i = dg_i/dx_{i+1}); its
multipliers are the eigenvalues of S M_{L-1} ... M_0, with S = diag(1, twist, twist, ...) the closure.

Two levels. The product is formed in scaled form together with a bound on its rounding error,
sum_j |M_{L-1} .. M_{j+1}| |M_j| |M_{j-1} .. M_0|; where the bound certifies every multiplier, that is the answer
(for 2 x 2 factors the smaller multiplier comes from the product of the determinants, so it keeps its relative
accuracy however small it is). Otherwise the periodic QR algorithm of Bojanczyk, Golub and Van Dooren (1992)
works on the factors: periodic Hessenberg-triangular reduction, then implicit QR steps in complex arithmetic.
Both cost O(L) time and memory, and neither allocates.
"""

import math

import numpy as np
from numba import njit

UNIT_ROUNDOFF = 2.0**-53
CERTIFIED = 1e-11  # relative error of a multiplier up to which the scaled product is trusted
LARGE, SMALL = 2.0**200, 2.0**-200  # a running product is rescaled outside this range
LARGEST, LEAST = 2.0**1023, 2.0**-1021  # multipliers beyond these are clamped (never to 0 or infinity)


def scratch_size(length, n):
    """Number of floats that `multipliers` and `periodic_multipliers` need for `length` factors of order `n`."""
    return length * (3 * n * n + 2) + 8 * n * n + 8 * n


@njit(cache=True)
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


@njit(cache=True)
def _sort(re, im):
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


# ---------------------------------------------------------------------------------------------- 2 x 2 factors
@njit(cache=True)
def _fast_two(A, D, twist, re, im, scratch):
    """Multipliers of 2 x 2 factors from the scaled product; False where the error bound is too large."""
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
        inverse = -1.0 / delta
        m00 = (d * e - b * g) * inverse
        m01 = (d * f - b * h) * inverse
        m10 = (a * g - c * e) * inverse
        m11 = (a * h - c * f) * inverse
        det *= (f * g - e * h) * inverse
        k = 6 * i
        scratch[k], scratch[k + 1], scratch[k + 2], scratch[k + 3] = m00, m01, m10, m11
        scratch[k + 4] = norm * (abs(m00) + abs(m01) + abs(m10) + abs(m11))
        scratch[k + 5] = power
        p00, p10 = m00 * p00 + m01 * p10, m10 * p00 + m11 * p10
        p01, p11 = m00 * p01 + m01 * p11, m10 * p01 + m11 * p11
        norm = abs(p00) + abs(p01) + abs(p10) + abs(p11)
        if not SMALL < norm < LARGE:
            if norm == 0.0 or not norm < math.inf:
                return False
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
    lift = det_power - 2 * power
    if det == 0.0 or lift < -900:
        relative = 0.0
    elif lift > 900:
        return False
    else:
        relative = det * math.ldexp(1.0, lift)
    disc = half * half - relative
    if disc >= 0.0:
        root = half + math.copysign(math.sqrt(disc), half)
        modulus = abs(root)
    else:
        root = half
        modulus = math.sqrt(relative)
    # the error bound: the product after factor i, from the other end
    s00, s01, s10, s11 = 1.0, 0.0, 0.0, 1.0
    norm = 1.0
    back = 0
    bound = 0.0
    for i in range(length - 1, -1, -1):
        k = 6 * i
        weight = scratch[k + 4] * norm
        raised = int(scratch[k + 5]) + back - power
        if raised != 0:
            weight *= math.ldexp(1.0, min(max(raised, -1000), 900))
        bound += weight
        m00, m01, m10, m11 = scratch[k], scratch[k + 1], scratch[k + 2], scratch[k + 3]
        s00, s01 = s00 * m00 + s01 * m10, s00 * m01 + s01 * m11
        s10, s11 = s10 * m00 + s11 * m10, s10 * m01 + s11 * m11
        norm = abs(s00) + abs(s01) + abs(s10) + abs(s11)
        if not SMALL < norm < LARGE:
            if norm == 0.0 or not norm < math.inf:
                return False
            shift = math.frexp(norm)[1]
            factor = math.ldexp(1.0, -shift)
            s00, s01, s10, s11 = s00 * factor, s01 * factor, s10 * factor, s11 * factor
            norm *= factor
            back += shift
    if not bound * UNIT_ROUNDOFF <= CERTIFIED * modulus:
        return False
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
    return True


# ---------------------------------------------------------------------------------------------- any order
@njit(cache=True)
def _factors(A, D, twist, M, lu):
    """Fill M[i] = -D_i^{-1} A_i (LU with partial pivoting), closure included; False if some D_i is singular."""
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


@njit(cache=True)
def _deficiency(A):
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


@njit(cache=True)
def _rotation(f, g):
    """(c, s) with c real such that [[c, s], [-conj s, c]] maps (f, g) to (r, 0)."""
    size = abs(g)
    if size == 0.0:
        return 1.0, 0j
    other = abs(f)
    if other == 0.0:
        return 0.0, g.conjugate() / size
    norm = math.hypot(other, size)
    return other / norm, (f / other) * (g.conjugate() / norm)


@njit(cache=True)
def _rows(X, k, c, s, first, last):
    """Rotate rows k, k+1 of X over columns first..last."""
    for j in range(first, last + 1):
        x, y = X[k, j], X[k + 1, j]
        X[k, j] = c * x + s * y
        X[k + 1, j] = c * y - s.conjugate() * x


@njit(cache=True)
def _columns(X, k, c, s, first, last):
    """Rotate columns k, k+1 of X (by the adjoint) over rows first..last."""
    for i in range(first, last + 1):
        x, y = X[i, k], X[i, k + 1]
        X[i, k] = c * x + s.conjugate() * y
        X[i, k + 1] = c * y - s * x


@njit(cache=True)
def _carry(T, k, c, s, lo, hi, top):
    """Carry a rotation of rows k, k+1 of the last factor round the cycle, back to its columns (rows lo..top)."""
    last = T.shape[0] - 1
    for i in range(last):
        _columns(T[i], k, c, s, lo, k + 1)
        c, s = _rotation(T[i, k, k], T[i, k + 1, k])
        _rows(T[i], k, c, s, k, hi)
        T[i, k + 1, k] = 0.0
    _columns(T[last], k, c, s, lo, top)


@njit(cache=True)
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


@njit(cache=True)
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
        if not SMALL < norm < LARGE:
            shift = math.frexp(norm)[1]
            factor = math.ldexp(1.0, -shift)
            a, b, d = a * factor, b * factor, d * factor
            power += shift
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


@njit(cache=True)
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
                for j in range(hi + 1):
                    size += abs(H[lo - 1, j])
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
                size = 0.0
                for j in range(k, hi + 1):
                    size += abs(T[i, k, j])
                for j in range(lo, k):
                    size += abs(T[i, j, k])
                if abs(T[i, k, k]) <= UNIT_ROUNDOFF * size:
                    T[i, k, k] = 0.0
                    singular = True
            ratio *= T[i, lo, lo]
            size = abs(ratio)
            if not SMALL < size < LARGE and size != 0.0:
                shift = math.frexp(size)[1]
                ratio *= math.ldexp(1.0, -shift)
                power += shift
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
            gap = own - power
            if gap > 900:
                gap = 900
            if gap < -900:
                target, gap = 0j, 0
            first = H[lo, lo] - target / ratio * math.ldexp(1.0, gap)
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


@njit(cache=True)
def _apart(x, xp, y, yp):
    """|x 2^xp - conj(y) 2^yp| and |Im x| 2^xp + |Im y| 2^yp, both over 2^max(xp, yp)."""
    top = max(xp, yp)
    a = x * math.ldexp(1.0, max(xp - top, -1000))
    b = y * math.ldexp(1.0, max(yp - top, -1000))
    return abs(a - b.conjugate()), abs(a.imag) + abs(b.imag)


@njit(cache=True)
def _diagonal(T, re, im, value, power):
    """Eigenvalues from the converged form: real ones made real, pairs made exactly conjugate."""
    length, n = T.shape[0], T.shape[1]
    for k in range(n):
        product, raised = 1.0 + 0j, 0
        for i in range(length):
            product *= T[i, k, k]
            size = abs(product)
            if size == 0.0:
                break
            if not SMALL < size < LARGE:
                shift = math.frexp(size)[1]
                product *= math.ldexp(1.0, -shift)
                raised += shift
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


@njit(cache=True)
def periodic_multipliers(A, D, twist, re, im, scratch):
    """Multipliers by the periodic QR algorithm alone; same arguments as `multipliers`, True if it converged."""
    length, n = A.shape[0], A.shape[1]
    size = length * n * n
    M = scratch[:size].reshape((length, n, n))
    room = scratch[size : size + n * n].reshape((n, n))
    if not _factors(A, D, twist, M, room):
        re[:] = math.nan
        im[:] = math.nan
        return False
    start = size + n * n + (size + n * n) % 2
    T = scratch[start : start + 2 * size].view(np.complex128).reshape((length, n, n))
    small = scratch[start + 2 * size : start + 2 * size + 8 * n].view(np.complex128)
    for i in range(length):
        for r in range(n):
            for c in range(n):
                T[i, r, c] = M[i, r, c]
    _reduce(T)
    converged = _iterate(T, small)
    _diagonal(T, re, im, small[:n], small[n : 2 * n])
    _sort(re, im)
    lost = min(_deficiency(A), n)
    for k in range(n - lost, n):
        re[k] = im[k] = 0.0
    return converged


@njit(cache=True)
def multipliers(A, D, twist, re, im, scratch):
    """Multipliers of a cycle: eigenvalues of diag(1, twist, ..) M_{L-1} .. M_0, M_i = -D_i^{-1} A_i.

    Parameters
    ----------
    A, D : ndarray (L, n, n)
        Derivatives of the i-th map with respect to its first and its second node.
    twist : float
        +1 for a full period, -1 for half a period followed by the mirror.
    re, im : ndarray (n,)
        Filled: descending modulus, then real part; pairs exactly conjugate; exact zeros where a stick forgets.
        Values beyond the range of floats are clamped to 2**1023 or 2**-1021 in size. NaN if a D_i is singular.
    scratch : ndarray (scratch_size(L, n),)

    Returns
    -------
    converged : bool
    """
    if A.shape[1] == 2 and _fast_two(A, D, twist, re, im, scratch):
        return True
    return periodic_multipliers(A, D, twist, re, im, scratch)
