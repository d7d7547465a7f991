"""Corrector: Newton's method on the bordered system, along a branch and for single points.

For problems in Python; native/march.hpp has the same for compiled ones.
"""

import math

from .aims import probe
from .arrays import add, correction_size, distance, hermite, orient, put, remainder
from .bracketing import Bracket
from .layout import AT_END, ENDS, JUMP, NOWHERE, PASSED, PRECISION
from .settings import SOLUTION

STRAY = 0.3  # part of a chord by which a point may lie off the interpolation between its ends


def improve(u, p, step, sweep, residual, before, tolerance, metric, noise):
    """Add a Newton correction to u and p, unless Newton's method diverges.

    Parameters
    ----------
    u, p, step
        Unknowns (changed in place), parameter, correction of both.
    sweep : int
        Number of corrections before this one.
    residual : float
        Largest residual before this correction.
    before : float
        Size of the correction before this one.
    tolerance : float
    metric : Metric
    noise : float
        Accuracy to which corrections can be obtained at all, because the equations are not smooth below it; 0 for roundoff.

    Returns
    -------
    p : float
    size : float
        Of the correction, relative to the scale + abs(unknown).
    verdict : int
        1 when converged, -1 when diverged, else 0.
    """
    size = correction_size(step, u, p, metric)
    if not size < SOLUTION.huge:
        return p, size, -1
    if sweep > 1 and size > 2.0 * before and size > max(SOLUTION.stalled, 10.0 * noise):
        return p, size, -1
    add(u, step)
    p += float(step[u.shape[0]])
    if size <= max(min(SOLUTION.small, tolerance), noise):
        return p, size, 1
    if sweep > 0:
        ratio = size / before
        # quadratic convergence: the next correction would be about ratio^2 size
        if size <= tolerance and ratio * ratio * size <= max(SOLUTION.predicted, noise):
            return p, size, 1
        if size <= SOLUTION.stalled and ratio > 0.3 and residual < SOLUTION.solved:
            return p, size, 1
        # corrections that are noise do not shrink, whatever the tolerance
        if size <= 30.0 * noise and ratio > 0.1:
            return p, size, 1
    return p, size, 0


def correct(kernels, data, work, u, p, border, target, tolerance, max_sweeps, step, tangent, metric, noise):
    """Newton's method for F(u, p) = 0, border.(u, p) = target; u is updated in place.

    Each sweep is one linearisation and one elimination, which gives the correction and the tangent.

    Returns
    -------
    p : float
    sweeps : int
        Number of sweeps; -1: no convergence; -2: not evaluable.
    sign : float
        Sign of the bordered determinant at the last linearisation, before the last correction.
    size : float
        Last correction, relative to the scale + abs(unknown).
    """
    size = 0.0
    sign = 0.0
    for sweep in range(max_sweeps):
        residual = kernels.linearise(data, u, p, work)
        if not math.isfinite(residual):
            return p, -2, sign, size
        gap = remainder(border, u, p, target)
        sign = kernels.bordered(data, work, border, gap, step, tangent)
        p, size, verdict = improve(u, p, step, sweep, residual, size, tolerance, metric, noise)
        if verdict != 0:
            return p, sweep + 1 if verdict > 0 else -1, sign, size
    return p, -1, sign, size


def point(kernels, frame, way, s, found, i, noise):
    """The solution at a place on a chord, and everything about it, into entry i of what is found.

    Parameters
    ----------
    kernels
        Of the problem.
    frame : tuple
        The problem's data and workspace, metric and `Scratch`.
    way : Way
    s : float
    found : Found
    i : int
    noise : float
    """
    data, work, metric, scratch = frame
    border, u, tangent = way.border, found.u[i], found.tangents[i]
    p = hermite(way.chord, s, u, scratch.guess)
    limit = 0 if way.length > 0.0 and (s == 0.0 or s == 1.0) else way.sweeps
    target = way.start + s * way.length
    residual, sign, size, sweeps, settled = 0.0, 0.0, 0.0, -1, limit == 0
    for sweep in range(limit + 1):
        residual = kernels.linearise(data, u, p, work)
        if not math.isfinite(residual):
            sweeps = -2
            break
        sign = kernels.bordered(data, work, border, remainder(border, u, p, target), scratch.step, tangent)
        if settled:
            sweeps = sweep
            break
        if sweep == limit:
            break
        p, size, verdict = improve(
            u, p, scratch.step, sweep, residual, size, SOLUTION.rounding, metric, noise
        )
        if verdict < 0:
            break
        settled = verdict > 0
    if sweeps >= 0:
        kernels.inspect(data, u, p, work, found.rows[i])
        norm, same, across = orient(tangent, way.along, border, metric)
        if not math.isfinite(norm):
            sweeps = -3
        else:
            if same < 0.0:
                norm, across = -norm, -across
            put(tangent, tangent, norm)
            if across < 0.0:
                sign = -sign
            if way.length > 0.0 and distance(u, p, scratch.guess, metric) > STRAY * way.length:
                sweeps = -4
    found.numbers[i] = p, sweeps, residual, sign, size


def search(kernels, frame, way, found, known, aim, noise):
    """The solution at which a number passes zero between a chord's ends.

    Parameters
    ----------
    kernels, frame, way, found, noise
        See :func:`point`; the solution is the first one of what is found.
    known : ndarray
        Has tolerance and jump of :class:`contvines.continuation.bracketing.Bracket`; the final bracket is left there.
    aim : Aim

    Returns
    -------
    int
        `PASSED` where the bracket holds a zero, `AT_END` where an end is taken for it, `NOWHERE` where there is none.
    """

    def value(s):
        point(kernels, frame, way, s, found, 0, noise)
        p, sweeps, _, sign, _ = found.numbers[0].tolist()
        return probe(aim, found.rows[0], found.tangents[0, -1], sign) if sweeps >= 0 else math.nan, p

    first, first_p = value(0.0)
    if not math.isfinite(first):
        return NOWHERE
    last, last_p = value(1.0)
    if not math.isfinite(last):
        return NOWHERE
    smallest, largest = sorted((abs(first), abs(last)))
    if first * last > 0.0:
        # an end that is the zero itself may have either sign, by roundoff
        if aim.anyway == 0 and smallest > SOLUTION.solved * largest:
            return NOWHERE
        outcome, seen, end = AT_END, 1.0, 0.0 if abs(first) < abs(last) else 1.0
        known[0] = end
    else:
        bracket = Bracket(1.0, last, last_p, 0.0, first, first_p, *known[[PRECISION, JUMP]].tolist())
        seen, outcome, end = bracket.narrow(value), PASSED, bracket.best
        known[ENDS] = bracket.x1, bracket.f1, bracket.p1, bracket.x2, bracket.f2, bracket.p2
    if end != seen or found.numbers[0, 1] < 0.0:  # the best place once more
        value(end)
    return outcome
