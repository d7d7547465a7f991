"""Bracketing: the root of a function of one variable, one evaluation at a time.

Chandrupatla's method (Adv. Eng. Software 28 (1997) 145): bisection with inverse quadratic steps where they are safe; the function need
not be continuous. Where these are not safe, as at a jump or a kink, secants on one side of the zero take the place of bisection: what is
beyond a jump says nothing of the zero, which is that of the secant on one side.

What is known is kept in a list of numbers, or an array: see the names below. native/march.hpp has the same functions.
"""

import math

from contvines.shared.floating_point import TINY

from .layout import (
    AGAIN,
    AIMED,
    BEYOND,
    COUNT,
    F1,
    F2,
    F3,
    JUMP,
    ON_A_SIDE,
    P1,
    P2,
    PRECISION,
    SIDES,
    SIZE,
    WAIT,
    WIDTH,
    X1,
    X2,
    X3,
)
from .settings import SOLUTION

BISECTIONS = 2  # before a function is taken for one with a jump or a kink at its zero
ENOUGH = 0.25  # part of a function's value that a secant may leave
SHORT = 0.02  # part of the way back that is gone where a secant has gone too far
MOST = 100  # evaluations


def begin(known, a, b, fa, fb, pa, pb, tolerance, jump):
    """Begin with a bracket; the next place to look at, NaN where one end is the root itself.

    Parameters
    ----------
    known : list or ndarray (SIZE,)
        Filled.
    a, b, fa, fb : float
        Bracket; fa and fb of opposite sign, or one of them zero.
    pa, pb : float
        What else is to be kept of both ends.
    tolerance : float
        Width of the final bracket relative to the first one.
    jump : float
        Give up where f still changes by more than this over a small part of the first bracket: f has a jump there.
    """
    for j in range(SIZE):
        known[j] = 0.0
    known[X1], known[F1], known[P1] = b, fb, pb
    known[X2], known[F2], known[P2] = a, fa, pa
    known[X3], known[F3] = b, fb
    known[WIDTH], known[PRECISION], known[JUMP] = abs(b - a), tolerance, jump
    known[WAIT], known[AIMED] = BISECTIONS, -1.0
    if fa == 0.0 or fb == 0.0:
        end = X2 if fa == 0.0 else X1
        other = X1 if fa == 0.0 else X2
        for j in range(3):
            known[other + j] = known[end + j]
        return math.nan
    return b + 0.5 * (a - b)


def follow(known, x, fx, px):
    """Take notice of f(x), and of what else is to be kept of x; the next place to look at, NaN where that is enough.

    Where f cannot be evaluated the place is replaced by one nearby, once.
    """
    x1, x2 = known[X1], known[X2]
    if not math.isfinite(fx):
        if known[AGAIN] > 0.0:
            return math.nan
        known[AGAIN] = 1.0
        return x1 + 0.37 * (x2 - x1)
    known[AGAIN] = 0.0
    known[COUNT] += 1.0
    _add(known, x, fx)
    if (fx > 0.0) == (known[F1] > 0.0):
        known[X3], known[F3] = x1, known[F1]
    else:
        known[X3], known[F3] = x2, known[F2]
        known[X2], known[F2], known[P2] = x1, known[F1], known[P1]
    known[X1], known[F1], known[P1] = x, fx, px
    x1, f1, x2, f2, x3, f3 = x, fx, known[X2], known[F2], known[X3], known[F3]
    if f1 == 0.0:
        known[X2], known[F2], known[P2] = x1, f1, px
        return math.nan
    width, tolerance = known[WIDTH], known[PRECISION]
    limit = 0.5 * tolerance * width / max(abs(x2 - x1), TINY)
    if abs(f1 - f2) > known[JUMP] and abs(x2 - x1) < SOLUTION.jump * width:
        return math.nan
    if limit > 0.5 or abs(x2 - x1) <= tolerance * width or known[COUNT] >= MOST:
        return math.nan
    xi = (x1 - x2) / (x3 - x2)
    phi = (f1 - f2) / (f3 - f2) if f3 != f2 else 2.0
    if phi * phi < xi and (1.0 - phi) ** 2 < 1.0 - xi:
        t = (f1 / (f2 - f1)) * (f3 / (f2 - f3)) + ((x3 - x1) / (x2 - x1)) * (f1 / (f3 - f1)) * (
            f2 / (f3 - f2)
        )
    else:
        t = (_ahead(known) - x1) / (x2 - x1)
    t = min(1.0 - limit, max(limit, t))
    return x1 + t * (x2 - x1)


def best(known):
    """The end of the bracket with the smaller value."""
    return known[X1] if abs(known[F1]) < abs(known[F2]) else known[X2]


def _add(known, x, fx):
    """Keep a point of one side; a secant that has ended beyond the zero, or has left too much, is not trusted again soon."""
    side = 1 if fx > 0.0 else 0
    place = SIDES + ON_A_SIDE * side
    aimed = known[AIMED]
    if aimed >= 0.0 and aimed != side:
        known[BEYOND] = 1.0
    elif aimed >= 0.0 and not abs(fx) < ENOUGH * abs(known[place + 4]):
        known[WAIT] = BISECTIONS  # it is not that smooth
    known[place] += 1.0
    known[place + 1], known[place + 2] = known[place + 3], known[place + 4]
    known[place + 3], known[place + 4] = x, fx
    known[AIMED] = -1.0


def _ahead(known):
    """Where to look next in the bracket, where inverse quadratic steps are not safe."""
    x1, x2 = known[X1], known[X2]
    beyond = known[BEYOND] > 0.0
    known[BEYOND] = 0.0
    if beyond:  # a secant ended beyond the zero, hardly: a little before its end
        known[WAIT] = 0.0
        return x1 + SHORT * (x2 - x1)
    if known[WAIT] > 0.0:
        known[WAIT] -= 1.0
        return 0.5 * (x1 + x2)
    nearest = math.inf
    where = 0.5 * (x1 + x2)
    for side in range(2):
        place = SIDES + ON_A_SIDE * side
        if known[place] < 2.0:
            continue
        xa, fa, xb, fb = known[place + 1], known[place + 2], known[place + 3], known[place + 4]
        if not abs(fb) < abs(fa):
            continue
        step = fb * (xb - xa) / (fa - fb)
        if abs(step) < nearest and min(x1, x2) < xb + step < max(x1, x2):
            nearest, where, known[AIMED] = abs(step), xb + step, float(side)
    return where
