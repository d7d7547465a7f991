"""Multipliers from the scaled product of 2 x 2 factors, with a bound on its error: see `contvines.core.multipliers.periodic_schur`."""

import math

from .factors import LARGE, SMALL, UNIT_ROUNDOFF, scaled
from .settings import CERTIFIED, EXCESS, PASSABLE, SETTLED, STILL

CERTAIN, UNCERTAIN, BROKEN, UNDEFINED = 1, 0, 2, -1


def _simple_bound(length, twist, scratch):
    """A bound on the error that is larger than that of `_bound`, and costs less: from sums of absolute entries.

    Infinite or NaN where products leave the range of numbers.
    """
    before = scratch[9 * length + 2 :]
    s00, s01, s10, s11 = 1.0, 0.0, 0.0, twist
    norm = 2.0
    bound = 0.0
    for i in range(length - 1, -1, -1):
        k = 9 * i
        m00, m01, m10, m11 = scratch[k], scratch[k + 1], scratch[k + 2], scratch[k + 3]
        bound += (abs(m00) + abs(m01) + abs(m10) + abs(m11)) * (before[i] * norm)
        s00, s01 = s00 * m00 + s01 * m10, s00 * m01 + s01 * m11
        s10, s11 = s10 * m00 + s11 * m10, s10 * m01 + s11 * m11
        norm = abs(s00) + abs(s01) + abs(s10) + abs(s11)
    return bound


def _bound(length, twist, power, scratch):
    """The error bound, and its part that comes from rounding the factors themselves."""
    # (s) is the product after factor i, (p) the product before it
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
                return math.inf, inherent
            if norm == 0.0:
                break
            shift = math.frexp(norm)[1]
            factor = math.ldexp(1.0, -shift)
            s00, s01, s10, s11 = s00 * factor, s01 * factor, s10 * factor, s11 * factor
            back += shift
    return bound, inherent


def product_of_two(A, D, twist, re, im, scratch):
    """Multipliers of 2 x 2 factors from the scaled product: CERTAIN; UNCERTAIN: the error bound is too large;
    BROKEN: the product vanished or left the range of numbers; UNDEFINED: a D_i is singular."""
    length = A.shape[0]
    before = scratch[9 * length + 2 :]  # sums of the absolute entries of the product before each factor
    p00, p01, p10, p11 = 1.0, 0.0, 0.0, 1.0
    norm = 2.0
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
        before[i] = norm
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
    trusted = CERTIFIED * modulus / UNIT_ROUNDOFF
    if power != 0 or not _simple_bound(length, twist, scratch) <= trusted:
        bound, inherent = _bound(length, twist, power, scratch)
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


def dominant_of_two(length, twist, re, im, scratch):
    """Two multipliers of different size: the larger one by carrying its eigenvector round the cycle until it settles.

    Takes the factors and the determinant from what `product_of_two` left in `scratch`. Rounding is not amplified: the
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
        if turned <= STILL or (turned <= SETTLED and turned >= 0.5 * before):
            value = math.copysign(value, x * x0 + y * y0)
            det = scratch[9 * length]
            re[0], re[1] = scaled(value, power), scaled(det / value, int(scratch[9 * length + 1]) - power)
            im[0] = im[1] = 0.0
            return CERTAIN if abs(re[1]) < abs(re[0]) else UNCERTAIN
        if sweep > 3 and turned > 0.5 * before:
            return UNCERTAIN
        before = turned
    return UNCERTAIN
