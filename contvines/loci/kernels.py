"""Kernels of a locus: the special points of F(u, p) = 0 as solutions of a larger system, against a second parameter q.

Unknowns are U = (u, p), at branch points (u, p, e), p in units of data.unit; q is the parameter in which the locus is continued. The
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
    BRANCH,
    FLIP,
    FLIP_B,
    FLIP_C,
    FOLD,
    KNOWN,
    LEFT,
    LONGEST,
    PAIR,
    PERIOD,
    SERVED,
    SIGN,
    TESTED,
    TURNED,
    B,
    C,
)
from .probing import frozen, pair_of, slopes_along, tests
from .spanning import particular, span


def locus_linearise(data, U, q, work):
    """F, F_u, F_p, F_q and the tests at (U, q); see `linearise` in the protocol."""
    first, second, base, state = data.first, data.second, work.base, work.state
    residuals, point, direction = work.residual, work.point, work.directions[0]
    n, size, calls = len(work.base_F), len(U), data.calls
    u, p = U[:n], data.unit * U[n]
    still = frozen(work, U, q)
    if not still:
        state[KNOWN] = min(state[KNOWN], 0.0)
        calls.assign(second, first, p)
        if not math.isfinite(calls.linearise(second, u, q, base)):
            return math.inf
        work.columns[1] = work.base_Q
    calls.assign(first, second, q)
    largest = calls.linearise(first, u, p, base)
    if not math.isfinite(largest):
        return math.inf
    residuals[:n] = work.base_F + U[n + 1] * work.borders[B, :n] if data.kind == BRANCH else work.base_F
    if not still:
        work.columns[0] = data.unit * work.base_Q
        span(data, work)
    state[SIGN] = particular(data, work)
    point[:size] = U + direction[:size]
    point[size] = q + direction[size]
    tests(data, work, point[:n], data.unit * point[n], point[size], work.values)
    residuals[n:] = work.values[: size - n]
    work.kept[:] = residuals
    return max(largest, *map(abs, residuals[n:].tolist())) if np.isfinite(residuals[n:]).all() else math.inf


def close(small, size):
    """Gauss elimination with row exchange of `size` equations with two right-hand sides; returns the determinant's sign."""
    sign = 1.0
    for j in range(size):
        best = j + int(np.abs(small[j:size, j]).argmax())
        if best != j:
            small[[j, best]], sign = small[[best, j]], -sign
        if small[j, j] == 0.0:
            small[j, j] = PIVOT
        if small[j, j] < 0.0:
            sign = -sign
        for i in range(j + 1, size):
            small[i, j:] -= small[i, j] / small[j, j] * small[j, j:]
    for j in reversed(range(size)):
        small[j, 3:] = (small[j, 3:] - small[j, j + 1 : size] @ small[j + 1 : size, 3:]) / small[j, j]
    return sign


def locus_bordered(data, work, border, target, step, tangent):
    """Solve the bordered system of the locus; see `bordered` in the protocol."""
    directions, residuals, kept, state = work.directions, work.residual, work.kept, work.state
    small, steep = work.small, work.steep
    n = len(work.base_F)
    count = len(residuals) - n  # tests; there are as many directions, and the one along the locus
    total = count + 1
    slopes = np.zeros(count)
    # else the residuals are those of the point, for which the particular direction stands
    if (residuals != kept).any():
        state[SIGN] = particular(data, work)
        slopes_along(data, work, directions[0], slopes)
        kept[:] = math.nan
    if state[KNOWN] < 1.0:
        for column in range(total):
            slopes_along(data, work, directions[1 + column], steep[column])
        state[KNOWN] = 1.0
    small[:count, :total] = steep[:total, :count].T
    small[count, :total] = directions[1 : 1 + total] @ border
    small[:total, total:3] = 0.0
    small[:count, 3], small[:count, 4] = -residuals[n:] - slopes, 0.0
    small[count, 3:] = target - border @ directions[0], 1.0
    sign = state[SIGN] * close(small, total)
    step[:] = directions[0] + small[:total, 3] @ directions[1 : 1 + total]
    tangent[:] = small[:total, 4] @ directions[1 : 1 + total]
    return sign


def renew(data, work, b, c, null):
    """Borders from the null vectors: c along `null`, b along the left one, in units of the scales; the linearisation is in `base`."""
    n = len(b) - 1
    lines, left, scales, rows = work.lines, work.solutions[LEFT], work.scales[:n], work.rows
    size = float(np.linalg.norm(null[:n] / scales))
    if not 0.0 < size < math.inf:
        return
    c[:n] = null[:n] / scales / scales / size
    lines[0, :n], lines[0, n] = b[:n], 0.0
    data.calls.transpose(data.first, work.base, c[:n], work.trial)
    work.trial_F[:] = 0.0
    data.calls.bordered(data.first, work.trial, lines[0], 0.0, lines[1], left)
    size = float(np.linalg.norm(left[:n] * rows))
    if not 0.0 < size < math.inf:
        return
    b[:n] = left[:n] * rows * rows / size


def worn(work, null):
    """Whether borders are due: the null vector has turned away from c, or they have served a few points."""
    state, n = work.state, len(null) - 1
    state[SERVED] += 1.0
    if state[SERVED] < LONGEST and np.linalg.norm(null[:n] / work.scales[:n]) < TURNED:
        return False
    state[SERVED] = 0.0
    return True


def locus_inspect(data, U, q, work, row):
    """Multipliers and margins of the problem, then of the locus: p within its bounds, and the pair still a pair.

    The borders are renewed where they are due.
    """
    first, base, borders, reference = data.first, work.base, work.borders, work.reference
    kind, null, margins = data.kind, work.solutions[TESTED], row[2 * data.multipliers :]
    n = len(work.base_F)
    if kind in (FOLD, BRANCH, FLIP) and worn(work, null):
        work.state[KNOWN] = min(work.state[KNOWN], 0.0)  # slopes belong to the borders
        if kind != FLIP:
            renew(data, work, borders[B], borders[C], null)
        else:
            data.calls.flip(first, base, -1.0)
            renew(data, work, borders[FLIP_B], borders[FLIP_C], null)
            data.calls.flip(first, base, 1.0)
    data.calls.assign(first, data.second, q)  # the tests have asked nearby
    data.calls.inspect(first, U[:n], data.unit * U[n], base, row[:-3])
    margins[-3:] = U[n] - reference[3], reference[4] - U[n], math.inf
    if kind == PERIOD:  # a homoclinic orbit is near as long as the cycle comes near to an equilibrium
        margins[0] = math.log10(APART / first.from_rest(U[:n], data.unit * U[n]))
    margins[work.masked] = math.inf
    if kind == PAIR:
        pair_of(row, data.multipliers, data.flow, reference[0], reference[1:])
        reference[0] = reference[2]
        margins[-1] = reference[2] if data.flow else 1.0 - reference[2] * reference[2]
