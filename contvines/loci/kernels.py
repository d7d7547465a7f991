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
    pair             m1 m2 - 1 for the multipliers of a pair, l1 + l2 for eigenvalues of a flow

Every solve is one elimination of the problem's own kernel with b in the place of F_p. What is left are two (at branch points
three) directions in which F = 0 holds to first order; the tests are differentiated along these alone, by differences, and not
again where Newton's method has hardly moved: the tests themselves stay exact, so nothing of the location is lost. The borders are renewed at each accepted point: c becomes the
null vector, b the left one.

This source runs compiled and interpreted; :mod:`contvines.loci.binding` puts the kernels of the problem in.
"""

import math
from typing import Any

from .layout import (
    AT_F,
    AT_P,
    AT_Q,
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
    KIND,
    LEFT,
    LINES,
    MASKED,
    MULTIPLIERS,
    NULL,
    PAIR,
    POINT,
    REFERENCE,
    RESIDUAL,
    ROWS,
    SCALES,
    SECOND,
    SLOPES,
    SMALL,
    SOLUTIONS,
    SPARE,
    STATE,
    STEEP,
    TRIAL,
    TRIAL_F,
    UNIT,
    VALUES,
    B,
    C,
)
from .probing import frozen, pair_of, slopes_along, tests

# the problem's kernels, put in by contvines.loci.binding; their first argument is `calls`
linearise: Any = None
bordered: Any = None
inspect: Any = None
assign: Any = None
flip: Any = None
transpose: Any = None


def locus_linearise(data, U, q, work):
    """F, F_u, F_p, F_q and the tests at (U, q); see `linearise` in the protocol."""
    first, second, base = data[FIRST], data[SECOND], work[BASE]
    F, Q, point, columns, solutions = work[BASE_F], work[BASE_Q], work[POINT], work[COLUMNS], work[SOLUTIONS]
    borders, lines, values, residuals = work[BORDERS], work[LINES], work[VALUES], work[RESIDUAL]
    n, size = F.shape[0], U.shape[0]
    kind, calls = data[KIND], data[CALLS]
    u, p = U[:n], data[UNIT] * U[n]
    for i in range(size):
        point[i] = U[i]
    point[size] = q
    assign(calls, second, first, p)
    largest = linearise(calls, second, u, q, base)
    if not largest < 1e300:
        return math.inf
    for i in range(n):
        columns[1, i] = Q[i]
    assign(calls, first, data[SECOND], q)
    largest = linearise(calls, first, u, p, base)
    if not largest < 1e300:
        return math.inf
    for i in range(n):
        columns[0, i] = data[UNIT] * Q[i]
        residuals[i] = F[i]
        if kind == BRANCH:
            residuals[i] += U[n + 1] * borders[B, i]
    for i in range(n):
        Q[i] = borders[B, i]
        lines[0, i] = borders[C, i]
    lines[0, n] = 0.0
    for column in range(2):
        for i in range(n):
            F[i] = columns[column, i]
        bordered(calls, first, base, lines[0], 0.0, solutions[AT_P + column], solutions[NULL])
    if kind == FOLD:
        values[0] = solutions[NULL, n]
    elif kind == BRANCH:
        values[0] = solutions[NULL, n]
        values[1] = solutions[AT_P, n]
    else:
        tests(data, work, u, p, q, values)
    for k in range(size - n):
        residuals[n + k] = values[k]
        if not abs(values[k]) < math.inf:
            return math.inf
        largest = max(largest, abs(values[k]))
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
            small[j, j] = 1e-300
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
    base = work[BASE]
    F, Q, solutions, directions = work[BASE_F], work[BASE_Q], work[SOLUTIONS], work[DIRECTIONS]
    borders, lines, residuals, slopes = work[BORDERS], work[LINES], work[RESIDUAL], work[SLOPES]
    small, scales, steep = work[SMALL], work[SCALES], work[STEEP]
    n, last = F.shape[0], work[POINT].shape[0] - 1
    count = last - n  # tests; there are as many directions, and the one along the locus
    for i in range(n):
        F[i] = residuals[i]
        Q[i] = borders[B, i]
        lines[0, i] = borders[C, i]
    lines[0, n] = 0.0
    sign = bordered(data[CALLS], data[FIRST], base, lines[0], 0.0, solutions[AT_F], solutions[NULL])
    # (u, p, e, q) = particular + dp first + dq second + a third, with one condition on (dp, dq, a)
    for i in range(n):
        for k in range(4):
            directions[k, i] = solutions[k, i]
    for k in range(4):
        for i in range(n, last + 1):
            directions[k, i] = 0.0
    directions[AT_P, n] = 1.0
    directions[AT_Q, last] = 1.0
    pivots = 0.0  # which direction is expressed by the others
    if data[KIND] == BRANCH:
        for k in range(4):
            directions[k, n + 1] = solutions[k, n]
    else:
        # the one with the largest part in the condition
        pivot, largest = 1, -1.0
        for k in range(1, 4):
            part = abs(solutions[k, n])
            if k == AT_P:
                part *= scales[n]
            elif k == AT_Q:
                part *= scales[last]
            if part > largest:
                pivot, largest = k, part
        by = solutions[pivot, n]
        if by == 0.0:
            by = 1e-300
        if (by < 0.0) != (pivot == 2):
            sign = -sign
        for k in range(4):
            if k == pivot:
                continue
            share = solutions[k, n] / by
            for i in range(last + 1):
                directions[k, i] -= share * directions[pivot, i]
        for k in range(pivot, 3):
            for i in range(last + 1):
                directions[k, i] = directions[k + 1, i]
        pivots = 1.0 * pivot
    total = count + 1
    known = frozen(work, pivots)
    slopes_along(data, work, directions[0], slopes)
    across = 0.0
    for i in range(last + 1):
        across += border[i] * directions[0, i]
    for k in range(count):
        small[k, 3] = -residuals[n + k] - slopes[k]
        small[k, 4] = 0.0
    small[count, 3] = target - across
    small[count, 4] = 1.0
    for column in range(total):
        if not known:
            slopes_along(data, work, directions[1 + column], steep[column])
        for k in range(count):
            small[k, column] = steep[column, k]
        along = 0.0
        for i in range(last + 1):
            along += border[i] * directions[1 + column, i]
        small[count, column] = along
    for i in range(total):
        for column in range(total, 3):
            small[i, column] = 0.0
    sign *= close(small, total)
    for i in range(last + 1):
        step[i] = directions[0, i]
        tangent[i] = 0.0
        for column in range(total):
            step[i] += small[column, 3] * directions[1 + column, i]
            tangent[i] += small[column, 4] * directions[1 + column, i]
    return sign


def renew(data, work, b, c, null):
    """Borders from the null vectors: c along `null`, b along the left one, in units of the scales; the linearisation is in BASE."""
    n = b.shape[0] - 1
    lines, left, scales, rows = work[LINES], work[SOLUTIONS][LEFT], work[SCALES], work[ROWS]
    size = 0.0
    for i in range(n):
        size += (null[i] / scales[i]) ** 2
    if not 0.0 < size < math.inf:
        return
    size = math.sqrt(size)
    for i in range(n):
        c[i] = null[i] / scales[i] / scales[i] / size
        lines[0, i] = b[i]
    lines[0, n] = 0.0
    transpose(data[CALLS], data[FIRST], work[BASE], c[:n], work[TRIAL])
    F = work[TRIAL_F]
    for i in range(n):
        F[i] = 0.0
    bordered(data[CALLS], data[FIRST], work[TRIAL], lines[0], 0.0, lines[1], left)
    size = 0.0
    for i in range(n):
        size += (left[i] * rows[i]) ** 2
    if not 0.0 < size < math.inf:
        return
    size = math.sqrt(size)
    for i in range(n):
        b[i] = left[i] * rows[i] * rows[i] / size


def locus_inspect(data, U, q, work, row):
    """Multipliers and margins of the problem, then of the locus: p within its bounds, and the pair still a pair.

    The borders are renewed.
    """
    first, base = data[FIRST], work[BASE]
    borders, solutions, reference = work[BORDERS], work[SOLUTIONS], work[REFERENCE]
    kind, multipliers = data[KIND], data[MULTIPLIERS]
    n = work[BASE_F].shape[0]
    work[STATE][0] = -1.0  # slopes belong to the borders
    if kind != BRANCH:  # there e is measured along b
        renew(data, work, borders[B], borders[C], solutions[NULL])
    if kind == FLIP:
        flip(data[CALLS], first, base, -1.0)
        renew(data, work, borders[FLIP_B], borders[FLIP_C], solutions[SPARE])
        flip(data[CALLS], first, base, 1.0)
    own = row.shape[0] - 3
    inspect(data[CALLS], first, U[:n], data[UNIT] * U[n], base, row[:own])
    row[own] = U[n] - reference[3]
    row[own + 1] = reference[4] - U[n]
    row[own + 2] = math.inf
    for j in work[MASKED]:
        row[2 * multipliers + j] = math.inf
    if kind == PAIR:
        pair_of(row, multipliers, data[FLOW], reference[0], reference[1:])
        reference[0] = reference[2]
        row[own + 2] = reference[2] if data[FLOW] else 1.0 - reference[2] * reference[2]
