"""Corrector: Newton's method on the bordered system, along a branch and for single points.

For problems in Python; native/march.hpp has the same for compiled ones.
"""

import math

import numpy as np

from .aims import NOTHING, probe
from .arrays import add, correction_size, distance, hermite, orient, put, remainder
from .bracketing import begin, best, follow
from .layout import AT_END, ELIMINATE, EVERYTHING, JUMP, LINEARISE, NOWHERE, PASSED, PRECISION, X1
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


def points(
    kernels,
    frame,
    what,
    chord,
    stretch,
    places,
    border,
    along,
    max_sweeps,
    found,
    aim,
    noise,
):
    """Single solutions, and everything about them, or a part of that.

    EVERYTHING: at most ``max_sweeps`` sweeps of Newton's method from a place on a chord (none at its ends: they are good as they are), then
    linearisation, elimination and multipliers once more at the solution; tangents are unit vectors with <along, tangent> >= 0. With an aim
    the one solution is looked for at which a number passes zero between the chord's ends.
    LINEARISE: the residual only. ELIMINATE: with the linearisation at hand.

    Parameters
    ----------
    kernels
        Of the problem.
    frame : tuple
        The problem's data and workspace; of a search the final bracket (an array of `bracketing.SIZE` numbers); metric and `Scratch`.
    what : int
    chord : ndarray, shape (4, N + 1)
        Of cubic Hermite interpolation: the first end, its tangent times the arc's length, the second end, its tangent likewise.
    stretch : (float, float)
        start and length: border.(u, p) is to be start + s length. With length 0 the first end is a guess, and no more.
    places : ndarray, shape (k,)
        Each s; with an aim only the first ends are looked at, 0 and 1.
    border, along : ndarray, shape (N + 1,)
    max_sweeps : int
    found : Found
        Filled.
    aim : Aim
    noise : float

    Returns
    -------
    int
        With an aim: `PASSED` where the bracket holds a zero, `AT_END` where an end is taken for it, `NOWHERE` where there is none.
    """
    data, work, known, metric, scratch = frame
    start, length = stretch
    searching = aim.what != NOTHING
    step = scratch.step
    outcome = NOWHERE
    stage, place, s = 0, 0, places[0]
    first_value, first_p = 0.0, 0.0
    while True:
        u, tangent, row, numbers = (
            found.u[place],
            found.tangents[place],
            found.rows[place],
            found.numbers[place],
        )
        p = hermite(chord, s, u, scratch.guess)
        limit = 0 if length > 0.0 and (s == 0.0 or s == 1.0) else max_sweeps
        residual, sign, size, sweeps = 0.0, 0.0, 0.0, -1
        settled = limit == 0
        for sweep in range(limit + 1):
            gap = start + s * length
            if what != ELIMINATE:
                residual = kernels.linearise(data, u, p, work)
                if what == LINEARISE:
                    break
                if not math.isfinite(residual):
                    sweeps = -2
                    break
                gap = remainder(border, u, p, gap)
            sign = kernels.bordered(data, work, border, gap, step, tangent)
            if settled:
                sweeps = sweep
                break
            if sweep == limit:
                break
            p, size, verdict = improve(u, p, step, sweep, residual, size, SOLUTION.rounding, metric, noise)
            if verdict < 0:
                break
            settled = verdict > 0
        if sweeps >= 0 and what == EVERYTHING:
            kernels.inspect(data, u, p, work, row)
            norm, same, across = orient(tangent, along, border, metric)
            if math.isfinite(norm):
                if same < 0.0:
                    norm, across = -norm, -across
                put(tangent, tangent, norm)
                if across < 0.0:
                    sign = -sign
                if length > 0.0 and distance(u, p, scratch.guess, metric) > STRAY * length:
                    sweeps = -4
            else:
                sweeps = -3
        numbers[0], numbers[1], numbers[2], numbers[3], numbers[4] = p, sweeps, residual, sign, size
        if not searching:
            place += 1
            if place == places.shape[0]:
                return outcome
            s = places[place]
            continue
        if stage == 3:  # the best place once more
            return outcome
        value = probe(aim, row, tangent[u.shape[0]], sign) if sweeps >= 0 else np.nan
        if stage == 0:
            stage, first_value, first_p, s = 1, value, p, 1.0
            if not math.isfinite(value):
                return NOWHERE
            continue
        if stage == 1:
            if not math.isfinite(value):
                return NOWHERE
            smallest, largest = min(abs(first_value), abs(value)), max(abs(first_value), abs(value))
            if first_value * value > 0.0:
                # an end that is the zero itself may have either sign, by roundoff
                if aim.anyway == 0 and smallest > SOLUTION.solved * largest:
                    return NOWHERE
                outcome = AT_END
                known[X1] = 0.0 if abs(first_value) < abs(value) else 1.0
                if known[X1] == s:
                    return outcome
                stage, s = 3, 0.0
                continue
            stage, outcome = 2, PASSED
            ahead = begin(known, 0.0, 1.0, first_value, value, first_p, p, known[PRECISION], known[JUMP])
        else:
            ahead = follow(known, s, value, p)
        if ahead == ahead:
            s = ahead
            continue
        end = best(known)
        if end == s and sweeps >= 0:
            return outcome
        stage, s = 3, end
