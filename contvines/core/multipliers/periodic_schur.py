"""Eigenvalues of a long product of small matrices, without trusting the product.

A cycle of L maps has the linearised factors M_i = -D_i^{-1} A_i (A_i = dg_i/dx_i, D_i = dg_i/dx_{i+1}); its
multipliers are the eigenvalues of S M_{L-1} ... M_0, with S = diag(1, twist, twist, ...) the closure.

Two levels. The product is formed in scaled form together with a bound on its rounding error, the trace of
sum_j |M_{L-1} .. M_{j+1}| |M_j| |M_{j-1} .. M_0| (entry by entry, so that badly scaled nodes do no harm). Where
that is small, or hardly more than what rounding the factors alone does, sum_j |M_j| |M_{j-1} .. M_0 M_{L-1} ..
M_{j+1}|, the product is the answer. Otherwise the periodic QR algorithm works on the factors. Both cost O(L) time and memory.

The periodic QR algorithm is that of Bojanczyk, Golub and Van Dooren, Proc. SPIE 1770 (1992) 31: orthogonal changes of basis between the
factors bring all but one to upper triangular form and the last to upper Hessenberg form; implicit QR steps then
chase the rotation round the cycle until the last is triangular too. Complex arithmetic with single shifts keeps
it short; pairs are made exactly conjugate at the end. Scales are carried as (mantissa, exponent): no overflow.

`reference` here defines what is right. The native core (native/multipliers.hpp) does the same; for 2 x 2 factors it takes the smaller
multiplier from the product of the determinants, which keeps its relative accuracy however small it is.
"""

from __future__ import annotations

import math

import numpy as np

from ..library import NUMBER, POINTER, WHOLE, address, function, native

UNIT_ROUNDOFF = 2.0**-53
LARGE, SMALL = 2.0**200, 2.0**-200  # a running product is rescaled outside this range
LARGEST, LEAST = 2.0**1023, 2.0**-1021  # multipliers beyond these are clamped (never to 0 or infinity)
CERTIFIED = 1e-10  # relative error of a multiplier up to which the scaled product is trusted; native/multipliers.hpp has the same


def multipliers(A: np.ndarray, D: np.ndarray, twist: float, re: np.ndarray, im: np.ndarray) -> bool:
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

    Returns
    -------
    converged : bool
    """
    return _called("core_multipliers", A, D, twist, re, im) if native() else reference(A, D, twist, re, im)


def periodic_multipliers(A: np.ndarray, D: np.ndarray, twist: float, re: np.ndarray, im: np.ndarray) -> bool:
    """The same by the periodic QR algorithm alone."""
    if native():
        return _called("core_periodic_multipliers", A, D, twist, re, im)
    return periodic_reference(A, D, twist, re, im)


def reference(A: np.ndarray, D: np.ndarray, twist: float, re: np.ndarray, im: np.ndarray) -> bool:
    """`multipliers` in plain Python and numpy."""
    with np.errstate(all="ignore"):
        return scaled_product(A, D, twist, re, im) or periodic_reference(A, D, twist, re, im)


def _called(name: str, A: np.ndarray, D: np.ndarray, twist: float, re: np.ndarray, im: np.ndarray) -> bool:
    length, n = A.shape[0], A.shape[1]
    A, D = np.ascontiguousarray(A, dtype=float), np.ascontiguousarray(D, dtype=float)
    scratch = np.empty(length * (3 * n * n + 4) + 8 * n * (n + 1))
    call = function(name, WHOLE, POINTER, POINTER, WHOLE, WHOLE, NUMBER, POINTER, POINTER, POINTER)
    places = address(re), address(im), address(scratch)
    return bool(call(address(A), address(D), length, n, twist, *places))


# ------------------------------------------------------------------ factors, and numbers with an exponent of their own
def in_range(size):
    """(factor, exponent): the power of two by which a number of this size is divided, where it is very large or small; 0 is left."""
    shift = 0 if size == 0.0 or SMALL < size < LARGE else math.frexp(size)[1]
    return math.ldexp(1.0, -shift), shift


def scaled(mantissa, exponent):
    """mantissa * 2**exponent, clamped away from 0 and infinity (an exact 0 stays 0)."""
    if mantissa == 0.0 or not math.isfinite(mantissa):
        return mantissa
    fraction, power = math.frexp(mantissa)
    total = power + exponent
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


# ------------------------------------------------------------------ the scaled product
def _matrix_in_range(matrix):
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
        ranged = _matrix_in_range(M[i] @ P)
        if ranged is None or not ranged[0].any():
            return False
        P, power = ranged[0], power + ranged[1]
    # from the other end: bound on the rounding of the product, in units of 2^power
    bound = np.zeros(n)
    after, back = np.eye(n), 0
    for i in range(length - 1, -1, -1):
        moved = (np.abs(M[i])[:, :, None] * np.abs(before[i])[None]).sum(axis=(1, 2))
        factor = math.ldexp(1.0, min(max(powers[i] + back - power, -1000), 900))
        bound += np.abs(after) @ moved * factor
        ranged = _matrix_in_range(after @ M[i])
        if ranged is None:
            return False
        after, back = ranged[0], back + ranged[1]
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


# ------------------------------------------------------------------ the periodic QR algorithm
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
            target, exponent = _shift(T, hi)
            if tries % 10 == 9:
                target *= 1.0 + 0.5j
            gap = min(exponent - power, 900)
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


def _difference(x, xp, y, yp):
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
                distance, width = _difference(value[k], int(power[k].real), value[j], int(power[j].real))
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


def periodic_reference(A, D, twist, re, im):
    """`periodic_multipliers` in plain Python and numpy."""
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
