"""Corrector: Newton's method on the bordered system, along a branch and for single points.

Runs compiled and interpreted: see :mod:`contvines.continuation.loop`.
"""

from typing import NamedTuple

import numpy as np

from .lengths import add, correction_size, distance, hermite, orient, put, remainder

# what `point` does
LINEARISE, ELIMINATE, EVERYTHING = 0, 1, 2

TIGHT = 1e-12  # tolerance of single points
SMALL = 1e-11  # corrections below this, and the tolerance, end the iteration however they came about
ROUNDOFF = 1e-13  # predicted error at which a point counts as exact, relative to scale + abs(unknown)
STRAY = 0.3  # part of a chord by which a point may lie off the interpolation between its ends
STALLED = 1e-6  # corrections below this that do not shrink any more are roundoff
HUGE = 1e6  # larger corrections are a divergence


class Scratch(NamedTuple):
    """Work space of the loop: unknowns (N,), then a row of the bordered system, its solutions and a guess (N + 1,)."""

    u: np.ndarray
    border: np.ndarray
    step: np.ndarray
    tangent: np.ndarray
    guess: np.ndarray


def linearise(data, u, p, work):
    """Placeholder for the problem's kernel."""
    raise TypeError("kernels are put in by contvines.continuation.binding")


def bordered(data, work, border, n, step, tangent):
    """Placeholder for the problem's kernel."""
    raise TypeError("kernels are put in by contvines.continuation.binding")


def inspect(data, u, p, work, row):
    """Placeholder for the problem's kernel."""
    raise TypeError("kernels are put in by contvines.continuation.binding")


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
        Accuracy to which corrections can be had at all, because the equations are not smooth below it; 0 for roundoff.

    Returns
    -------
    p : float
    size : float
        Of the correction, relative to the scale + abs(unknown).
    verdict : int
        1 when converged, -1 when diverged, else 0.
    """
    size = correction_size(step, u, p, metric)
    if not size < HUGE:
        return p, size, -1
    if sweep > 1 and size > 2.0 * before and size > max(STALLED, 10.0 * noise):
        return p, size, -1
    add(u, step)
    p += float(step[u.shape[0]])
    if size <= max(min(SMALL, tolerance), noise):
        return p, size, 1
    if sweep > 0:
        ratio = size / before
        # quadratic convergence: the next correction would be about ratio^2 size
        if size <= tolerance and ratio * ratio * size <= max(ROUNDOFF, noise):
            return p, size, 1
        if size <= STALLED and ratio > 0.3 and residual < 1e-9:
            return p, size, 1
        # corrections that are noise do not shrink, whatever the tolerance
        if size <= 30.0 * noise and ratio > 0.1:
            return p, size, 1
    return p, size, 0


def correct(data, work, u, p, border, target, tolerance, max_sweeps, step, tangent, metric, noise):
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
        residual = linearise(data, u, p, work)
        if not residual < 1e300:
            return p, -2, sign, size
        gap = remainder(border, u, p, target)
        sign = bordered(data, work, border, gap, step, tangent)
        p, size, verdict = improve(u, p, step, sweep, residual, size, tolerance, metric, noise)
        if verdict != 0:
            return p, sweep + 1 if verdict > 0 else -1, sign, size
    return p, -1, sign, size


def point(data, work, what, chord, place, border, along, max_sweeps, u, tangent, row, metric, scratch, noise):
    """A single solution, and everything about it, or a part of that: one function, as each is compiled with all that it calls.

    EVERYTHING: at most ``max_sweeps`` sweeps of Newton's method from a place on a chord (none: it is good as it is), then
    linearisation, elimination and multipliers once more at the solution; `tangent` is a unit vector with <along, tangent> >= 0.
    LINEARISE: the residual only. ELIMINATE: with the linearisation at hand.

    Parameters
    ----------
    data, work
        Of the problem.
    what : int
    chord : ndarray, shape (4, N + 1)
        Of cubic Hermite interpolation: the first end, its tangent times the arc's length, the second end, its tangent likewise.
    place : (float, float, float)
        s, start and length: border.(u, p) is to be start + s length. With length 0 the first end is a guess, and no more.
    border, along : ndarray, shape (N + 1,)
    max_sweeps : int
    u, tangent, row : ndarray
        Filled.
    metric : Metric
    scratch : Scratch
    noise : float

    Returns
    -------
    p : float
    sweeps : int
        Number of sweeps; -1: no convergence; -2: not evaluable; -3: the tangent is not finite; -4: the point found belongs to another branch.
    residual : float
        0 if there was no linearisation.
    sign : float
        Of the bordered determinant, for the tangent; 0 if there was no elimination.
    size : float
        Of the last correction.
    """
    s, start, length = place
    step = scratch.step
    p = hermite(chord, s, u, scratch.guess)
    residual = 0.0
    sign = 0.0
    size = 0.0
    settled = max_sweeps == 0
    sweep = max_sweeps
    for sweep in range(max_sweeps + 1):
        gap = start + s * length
        if what != ELIMINATE:
            residual = linearise(data, u, p, work)
            if what == LINEARISE:
                return p, sweep, residual, sign, size
            if not residual < 1e300:
                return p, -2, residual, sign, size
            gap = remainder(border, u, p, gap)
        sign = bordered(data, work, border, gap, step, tangent)
        if settled:
            break
        if sweep == max_sweeps:
            return p, -1, residual, sign, size
        p, size, verdict = improve(u, p, step, sweep, residual, size, TIGHT, metric, noise)
        if verdict < 0:
            return p, -1, residual, sign, size
        settled = verdict > 0
    if what == ELIMINATE:
        return p, sweep, residual, sign, size
    inspect(data, u, p, work, row)
    norm, same, across = orient(tangent, along, border, metric)
    if not norm < 1e300:
        return p, -3, residual, sign, size
    if same < 0.0:
        norm, across = -norm, -across
    put(tangent, tangent, norm)
    if across < 0.0:
        sign = -sign
    if length > 0.0 and distance(u, p, scratch.guess, metric) > STRAY * length:
        sweep = -4
    return p, sweep, residual, sign, size
