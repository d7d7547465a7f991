"""Corrector: Newton's method on the bordered system, and single calls of the kernels.

Runs compiled and interpreted: see :mod:`contvines.continuation.march`.
"""

# what `solve` does
LINEARISE, ELIMINATE, EVERYTHING = 0, 1, 2

ROUNDOFF = 1e-13  # predicted error at which a point counts as exact, relative to 1 + abs(unknown)
STALLED = 1e-6  # corrections below this that do not shrink any more are roundoff
HUGE = 1e6  # larger corrections are a divergence


def linearise(data, u, p, work):
    """Placeholder for the problem's kernel."""
    raise TypeError("kernels are put in by contvines.continuation.binding")


def bordered(data, work, border, n, step, tangent):
    """Placeholder for the problem's kernel."""
    raise TypeError("kernels are put in by contvines.continuation.binding")


def inspect(data, u, p, work, row):
    """Placeholder for the problem's kernel."""
    raise TypeError("kernels are put in by contvines.continuation.binding")


def correct(data, work, u, p, border, target, tolerance, max_sweeps, step, tangent):
    """Newton's method for F(u, p) = 0, border.(u, p) = target; u is updated in place.

    Each sweep is one linearisation and one elimination, which gives the correction and the tangent.

    Returns
    -------
    p : float
    sweeps : int
        Number of sweeps; -1: no convergence; -2: not evaluable.
    residual : float
        Largest absolute residual at the last linearisation, before the last correction.
    sign : float
        Sign of the bordered determinant there.
    size : float
        Last correction, relative to 1 + abs(unknown).
    """
    n = u.shape[0]
    before = 0.0
    size = 0.0
    residual = 0.0
    sign = 0.0
    for sweep in range(max_sweeps):
        residual = linearise(data, u, p, work)
        if not residual < 1e300:
            return p, -2, residual, sign, size
        gap = target - border[n] * p
        for i in range(n):
            gap -= border[i] * u[i]
        sign = bordered(data, work, border, gap, step, tangent)
        size = abs(step[n]) / (1.0 + abs(p))
        finite = step[n] - step[n]
        for i in range(n):
            finite += step[i] - step[i]
            change = abs(step[i]) / (1.0 + abs(u[i]))
            if change > size:
                size = change
        if not (finite == 0.0 and size < HUGE):
            return p, -1, residual, sign, size
        if sweep > 1 and size > 2.0 * before and size > STALLED:
            return p, -1, residual, sign, size
        for i in range(n):
            u[i] += step[i]
        p += step[n]
        if size <= 1e-11:
            return p, sweep + 1, residual, sign, size
        if sweep > 0:
            ratio = size / before
            # quadratic convergence: the next correction would be about ratio^2 size
            if size <= tolerance and ratio * ratio * size <= ROUNDOFF:
                return p, sweep + 1, residual, sign, size
            if size <= STALLED and ratio > 0.3 and residual < 1e-9:
                return p, sweep + 1, residual, sign, size
        before = size
    return p, -1, residual, sign, size


def solve(data, work, u, p, border, target, step, tangent, row, what):
    """One call of the kernels: LINEARISE only, ELIMINATE only (with the linearisation at hand), or EVERYTHING.

    Returns
    -------
    residual : float
        0 if there was no linearisation.
    sign : float
        Of the bordered determinant; 0 if there was no elimination.
    """
    residual = 0.0
    sign = 0.0
    if what != ELIMINATE:
        residual = linearise(data, u, p, work)
        if what == LINEARISE or not residual < 1e300:
            return residual, sign
        target -= border[u.shape[0]] * p
        for i in range(u.shape[0]):
            target -= border[i] * u[i]
    sign = bordered(data, work, border, target, step, tangent)
    if what == EVERYTHING:
        inspect(data, u, p, work, row)
    return residual, sign
