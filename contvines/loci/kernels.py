"""Kernels of a locus: the special points of F(u, p) = 0 as solutions of a larger system, against a second parameter q.

Unknowns are U = (u, p), at branch points (u, p, e), p in units of data[UNIT]; q is the parameter in which the locus is continued. The
equations are

    F(u, p, q) + e b = 0,    g(u, p, q) = 0    (at branch points two of them),

minimally augmented (Griewank and Reddien, Math. Comp. 43 (1984) 511; Govaerts, Numerical Methods for Bifurcations of
Dynamical Equilibria, 2000, chapters 3 and 4). With borders b and c, M = [[F_u, b], [c, 0]] and M (v, g) = (0, 1):

    fold             g, which is zero where F_u is singular
    flip             g of F_u with its closure turned round: perturbations that change sign over the period
    branch point     g, and the last entry of M^-1 (F_p, 0): F_u and (F_u, F_p) lose rank together; e stays zero
    margin           one margin of admissibility
    period           the period, an unknown, has a given value: of cycles that stand for homoclinic orbits
    growth           the logarithm of the only multiplier, at folds of cycles in the plane
    pair             m1 m2 - 1 for the multipliers of a pair, l1 + l2 for eigenvalues of a flow

Every solve is one elimination of the problem's own kernel with another column in the place of F_p. What is left are two (at branch
points three) directions in which F = 0 holds to first order (:mod:`contvines.loci.spanning`) from the point at which the residuals of F are made up
for. There the tests are evaluated, so that a Newton step has a residual g of the second order; they are differentiated along these directions alone, by
differences. Directions and slopes are not worked out again where Newton's method has hardly moved: the residuals stay exact, so nothing of
the location is lost. The borders are renewed after a few accepted points, sooner
where the null vector turns: c becomes the null vector, b the left one.

native/loci.hpp has the same for compiled problems.
"""

import math

import numpy as np

from ..shared.floating_point import PIVOT
from .layout import (
    APART,
    BASE,
    BASE_F,
    BASE_Q,
    BORDERS,
    BRANCH,
    CALLS,
    COLUMNS,
    DIRECTIONS,
    FIRST,
    FLIP,
    FLIP_B,
    FLIP_C,
    FLOW,
    FOLD,
    KEPT,
    KIND,
    KNOWN,
    LEFT,
    LINES,
    LONGEST,
    MASKED,
    MULTIPLIERS,
    PAIR,
    PERIOD,
    POINT,
    REFERENCE,
    RESIDUAL,
    ROWS,
    SCALES,
    SECOND,
    SERVED,
    SIGN,
    SLOPES,
    SMALL,
    SOLUTIONS,
    STATE,
    STEEP,
    TESTED,
    TRIAL,
    TRIAL_F,
    TURNED,
    UNIT,
    VALUES,
    B,
    C,
)
from .probing import frozen, pair_of, slopes_along, tests
from .spanning import particular, span


def locus_linearise(data, U, q, work):
    """F, F_u, F_p, F_q and the tests at (U, q); see `linearise` in the protocol."""
    first, second, base = data[FIRST], data[SECOND], work[BASE]
    F, Q, point, columns, directions = (
        work[BASE_F],
        work[BASE_Q],
        work[POINT],
        work[COLUMNS],
        work[DIRECTIONS],
    )
    borders, values, residuals, kept = work[BORDERS], work[VALUES], work[RESIDUAL], work[KEPT]
    state = work[STATE]
    n, size = F.shape[0], U.shape[0]
    kind, calls = data[KIND], data[CALLS]
    u, p = U[:n], data[UNIT] * U[n]
    still = frozen(work, U, q)
    if not still:
        state[KNOWN] = min(state[KNOWN], 0.0)
        calls.assign(second, first, p)
        largest = calls.linearise(second, u, q, base)
        if not math.isfinite(largest):
            return math.inf
        columns[1] = Q
    calls.assign(first, second, q)
    largest = calls.linearise(first, u, p, base)
    if not math.isfinite(largest):
        return math.inf
    residuals[:n] = F + U[n + 1] * borders[B, :n] if kind == BRANCH else F
    if not still:
        columns[0] = data[UNIT] * Q
        span(data, work)
    state[SIGN] = particular(data, work)
    point[:size] = U + directions[0, :size]
    point[size] = q + directions[0, size]
    tests(data, work, point[:n], data[UNIT] * point[n], point[size], values)
    for k in range(size - n):
        residuals[n + k] = values[k]
        if not abs(values[k]) < math.inf:
            return math.inf
        largest = max(largest, abs(values[k]))
    kept[:size] = residuals[:size]
    return largest


def close(small, size):
    """Gauss elimination with row exchange of `size` equations with two right-hand sides; returns the determinant's sign."""
    sign = 1.0
    for j in range(size):
        best = j
        for i in range(j + 1, size):
            if abs(small[i, j]) > abs(small[best, j]):
                best = i
        if best != j:
            sign = -sign
            for c in range(5):
                small[j, c], small[best, c] = small[best, c], small[j, c]
        if small[j, j] == 0.0:
            small[j, j] = PIVOT
        if small[j, j] < 0.0:
            sign = -sign
        for i in range(j + 1, size):
            ratio = small[i, j] / small[j, j]
            for c in range(j, 5):
                small[i, c] -= ratio * small[j, c]
    for j in range(size - 1, -1, -1):
        for side in range(3, 5):
            for c in range(j + 1, size):
                small[j, side] -= small[j, c] * small[c, side]
            small[j, side] /= small[j, j]
    return sign


def locus_bordered(data, work, border, target, step, tangent):
    """Solve the bordered system of the locus; see `bordered` in the protocol."""
    directions, residuals, kept, state = work[DIRECTIONS], work[RESIDUAL], work[KEPT], work[STATE]
    small, steep, slopes = work[SMALL], work[STEEP], work[SLOPES]
    n, last = work[BASE_F].shape[0], work[POINT].shape[0] - 1
    count = last - n  # tests; there are as many directions, and the one along the locus
    total = count + 1
    slopes[:count] = 0.0
    # else the residuals are those of the point, for which the particular direction stands
    if (residuals[:last] != kept[:last]).any():
        state[SIGN] = particular(data, work)
        slopes_along(data, work, directions[0], slopes)
        kept[:last] = math.nan
    across = border @ directions[0]
    for k in range(count):
        small[k, 3] = -residuals[n + k] - slopes[k]
        small[k, 4] = 0.0
    small[count, 3] = target - across
    small[count, 4] = 1.0
    for column in range(total):
        if state[KNOWN] < 1.0:
            slopes_along(data, work, directions[1 + column], steep[column])
        small[:count, column] = steep[column, :count]
        small[count, column] = border @ directions[1 + column]
    state[KNOWN] = 1.0
    small[:total, total:3] = 0.0
    sign = state[SIGN] * close(small, total)
    step[: last + 1], tangent[: last + 1] = directions[0], 0.0
    for column in range(total):
        step[: last + 1] += small[column, 3] * directions[1 + column]
        tangent[: last + 1] += small[column, 4] * directions[1 + column]
    return sign


def renew(data, work, b, c, null):
    """Borders from the null vectors: c along `null`, b along the left one, in units of the scales; the linearisation is in BASE."""
    n = b.shape[0] - 1
    lines, left, scales, rows = work[LINES], work[SOLUTIONS][LEFT], work[SCALES], work[ROWS]
    size = float(np.linalg.norm(null[:n] / scales[:n]))
    if not 0.0 < size < math.inf:
        return
    c[:n] = null[:n] / scales[:n] / scales[:n] / size
    lines[0, :n], lines[0, n] = b[:n], 0.0
    data[CALLS].transpose(data[FIRST], work[BASE], c[:n], work[TRIAL])
    work[TRIAL_F][:] = 0.0
    data[CALLS].bordered(data[FIRST], work[TRIAL], lines[0], 0.0, lines[1], left)
    size = float(np.linalg.norm(left[:n] * rows[:n]))
    if not 0.0 < size < math.inf:
        return
    b[:n] = left[:n] * rows[:n] * rows[:n] / size


def worn(work, null):
    """Whether borders are due: the null vector has turned away from c, or they have served a few points."""
    state, scales = work[STATE], work[SCALES]
    n = null.shape[0] - 1
    state[SERVED] += 1.0
    if state[SERVED] < LONGEST and np.linalg.norm(null[:n] / scales[:n]) < TURNED:
        return False
    state[SERVED] = 0.0
    return True


def locus_inspect(data, U, q, work, row):
    """Multipliers and margins of the problem, then of the locus: p within its bounds, and the pair still a pair.

    The borders are renewed where they are due.
    """
    first, base = data[FIRST], work[BASE]
    borders, solutions, reference = work[BORDERS], work[SOLUTIONS], work[REFERENCE]
    kind, multipliers = data[KIND], data[MULTIPLIERS]
    n = work[BASE_F].shape[0]
    if kind in (FOLD, BRANCH, FLIP) and worn(work, solutions[TESTED]):
        work[STATE][KNOWN] = min(work[STATE][KNOWN], 0.0)  # slopes belong to the borders
        if kind != FLIP:
            renew(data, work, borders[B], borders[C], solutions[TESTED])
        else:
            data[CALLS].flip(first, base, -1.0)
            renew(data, work, borders[FLIP_B], borders[FLIP_C], solutions[TESTED])
            data[CALLS].flip(first, base, 1.0)
    own = row.shape[0] - 3
    data[CALLS].assign(first, data[SECOND], q)  # the tests have asked nearby
    data[CALLS].inspect(first, U[:n], data[UNIT] * U[n], base, row[:own])
    row[own] = U[n] - reference[3]
    row[own + 1] = reference[4] - U[n]
    row[own + 2] = math.inf
    if kind == PERIOD:  # a homoclinic orbit is near as long as the cycle comes near to an equilibrium
        row[2 * multipliers] = APART - row[2 * multipliers]
    for j in work[MASKED]:
        row[2 * multipliers + j] = math.inf
    if kind == PAIR:
        pair_of(row, multipliers, data[FLOW], reference[0], reference[1:])
        reference[0] = reference[2]
        row[own + 2] = reference[2] if data[FLOW] else 1.0 - reference[2] * reference[2]
