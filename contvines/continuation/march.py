"""The continuation loop: predict, correct, judge the step, many points a call.

This source runs compiled and interpreted: :mod:`contvines.continuation.binding` makes copies of these functions in which
``linearise``, ``bordered`` and ``inspect`` are the kernels of a problem. For compiled problems the copies are compiled as
well. Nothing is allocated here, and nothing is known of events.

Metric: <a, b> = metric_u a_u.b_u + metric_p a_p b_p with metric_u = 1/N and metric_p = 1/(hi - lo)^2, so that step lengths
depend neither on the number of repetitions of an orbit nor on the unit of the parameter.
"""

import math

# entries of the control vector
(
    METRIC_U,
    METRIC_P,
    ANGLE,
    MIN_STEP,
    MAX_STEP,
    TOLERANCE,
    LOWER,
    UPPER,
    STOP_AT_BORDER,
    SWEEPS,
    ROW_MARGINS,
) = range(11)
CONTROL_SIZE = 11

# what `solve` does
LINEARISE, ELIMINATE, EVERYTHING = 0, 1, 2

# status codes (contvines.continuation.status)
RUNNING, LEFT_INTERVAL, STEP_TOO_SMALL, NOT_EVALUABLE, BORDER = 0, 1, 2, 3, 4

ROUNDOFF = 1e-13  # predicted error at which a point counts as exact, relative to 1 + abs(unknown)
STALLED = 1e-6  # corrections below this that do not shrink any more are roundoff
HUGE = 1e6  # larger corrections are a divergence


def linearise(data, u, p, work):
    """Placeholder for the problem's kernel."""
    raise NotImplementedError


def bordered(data, work, border, n, step, tangent):
    """Placeholder for the problem's kernel."""
    raise NotImplementedError


def inspect(data, u, p, work, row):
    """Placeholder for the problem's kernel."""
    raise NotImplementedError


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


def predict(points, values, tangents, i, h, metric_u, metric_p, u):
    """Cubic Hermite extrapolation over a length h from point i - 1 (and i - 2); fills u, returns p.

    The length of the arc between the two points is their distance times 1 + angle^2/24 (exact to fourth order).
    """
    n = u.shape[0]
    if i < 2:
        for j in range(n):
            u[j] = points[i - 1, j] + h * tangents[i - 1, j]
        return values[i - 1] + h * tangents[i - 1, n]
    square = metric_p * (values[i - 1] - values[i - 2]) ** 2
    turn = metric_p * (tangents[i - 1, n] - tangents[i - 2, n]) ** 2
    chord = 0.0
    bend = 0.0
    for j in range(n):
        change = points[i - 1, j] - points[i - 2, j]
        chord += change * change
        change = tangents[i - 1, j] - tangents[i - 2, j]
        bend += change * change
    square += metric_u * chord
    turn += metric_u * bend
    d = math.sqrt(square) * (1.0 + turn / 24.0)
    if not (d > 0.0 and turn < 1.0 and h < 4.0 * d):
        for j in range(n):
            u[j] = points[i - 1, j] + h * tangents[i - 1, j]
        return values[i - 1] + h * tangents[i - 1, n]
    share = h / d
    for j in range(n):
        here = tangents[i - 1, j]
        there = tangents[i - 2, j]
        mean = (points[i - 1, j] - points[i - 2, j]) / d
        u[j] = points[i - 1, j] + h * (
            here + share * (2.0 * here + there - 3.0 * mean + share * (here + there - 2.0 * mean))
        )
    here = tangents[i - 1, n]
    there = tangents[i - 2, n]
    mean = (values[i - 1] - values[i - 2]) / d
    return values[i - 1] + h * (
        here + share * (2.0 * here + there - 3.0 * mean + share * (here + there - 2.0 * mean))
    )


def march(
    data,
    work,
    points,
    values,
    tangents,
    rows,
    signs,
    corrections,
    first,
    h,
    control,
    u,
    border,
    step,
    tangent,
):
    """Fill rows first, first + 1, ... of the chunk arrays with points of the branch.

    Row first - 1 holds the last known point, row first - 2 (if any) the one before it.

    Step rule (COCO): the next step aims at the set angle between tangents; an angle beyond twice of it, or a predictor
    error beyond the angle times the step, rejects the step. At the ends of the interval the last point is corrected at
    the fixed parameter value, so it lies on the end exactly.

    Parameters
    ----------
    data, work
        Of the problem.
    points, values, tangents, rows, signs, corrections : ndarray
        Chunk arrays of shapes (M, N), (M,), (M, N + 1), (M, row), (M,), (M,).
    first : int
        At least 1.
    h : float
        Step to try first.
    control : ndarray
        Settings; see the names at the top.
    u, border, step, tangent : ndarray
        Scratch of sizes N, N + 1, N + 1, N + 1.

    Returns
    -------
    filled : int
        Rows are filled up to, not including, this one.
    h : float
        Step to go on with.
    status : int
    """
    n = points.shape[1]
    metric_u = control[METRIC_U]
    metric_p = control[METRIC_P]
    angle = control[ANGLE]
    lower = control[LOWER]
    upper = control[UPPER]
    sweeps_allowed = int(control[SWEEPS])
    row_margins = int(control[ROW_MARGINS])
    row_size = rows.shape[1]
    i = first
    trouble = 0
    while i < points.shape[0]:
        if h < control[MIN_STEP]:
            return i, h, NOT_EVALUABLE if trouble == -2 else STEP_TOO_SMALL
        start = values[i - 1]
        p = predict(points, values, tangents, i, h, metric_u, metric_p, u)
        fixed = p > upper or p < lower
        length = h
        if fixed:
            bound = upper if p > upper else lower
            for _ in range(3):
                if p != start:
                    length *= min(max((bound - start) / (p - start), 0.0), 1.5)
                p = predict(points, values, tangents, i, length, metric_u, metric_p, u)
            p = bound
            for j in range(n):
                border[j] = 0.0
            border[n] = 1.0
            target = bound
        else:
            target = 0.0
            for j in range(n):
                border[j] = metric_u * tangents[i - 1, j]
                target += border[j] * u[j]
            border[n] = metric_p * tangents[i - 1, n]
            target += border[n] * p
        for j in range(n):
            points[i, j] = u[j]
        guess = p
        p, sweeps, _, sign, size = correct(
            data, work, u, p, border, target, control[TOLERANCE], sweeps_allowed, step, tangent
        )
        if sweeps < 0:
            trouble = sweeps
            h *= 0.5
            continue
        trouble = 0
        norm = metric_p * tangent[n] * tangent[n]
        cosine = metric_p * tangent[n] * tangents[i - 1, n]
        error = metric_p * (p - guess) ** 2
        part_norm = 0.0
        part_cosine = 0.0
        part_error = 0.0
        for j in range(n):
            part_norm += tangent[j] * tangent[j]
            part_cosine += tangent[j] * tangents[i - 1, j]
            part_error += (u[j] - points[i, j]) ** 2
        norm = math.sqrt(norm + metric_u * part_norm)
        cosine = (cosine + metric_u * part_cosine) / norm
        error = math.sqrt(error + metric_u * part_error)
        if fixed:
            p = bound
            if cosine < 0.0:
                cosine = -cosine
                norm = -norm
            if tangent[n] * norm < 0.0:
                sign = -sign
        turn = math.sqrt(max(0.0, 2.0 - 2.0 * cosine))
        if not (turn <= 2.0 * angle and error <= angle * length + 1e-12):
            h = 0.5 * length
            continue
        if p > upper or p < lower:
            bound = upper if p > upper else lower
            h = length * max(0.5, (bound - start) / (p - start)) * 1.0000001
            if guess == p or start == bound:
                return i, h, LEFT_INTERVAL
            if h >= length:
                h = 0.9 * length
            continue
        for j in range(n):
            points[i, j] = u[j]
            tangents[i, j] = tangent[j] / norm
        tangents[i, n] = tangent[n] / norm
        values[i] = p
        signs[i] = sign
        corrections[i] = size
        inspect(data, u, p, work, rows[i])
        i += 1
        if fixed:
            return i, h, LEFT_INTERVAL
        factor = 2.0
        if turn > 0.5 * angle:
            factor = max(0.5, angle / turn)
        if sweeps > 3:
            factor = min(factor, 0.8)
        h = min(h * factor, control[MAX_STEP])
        if control[STOP_AT_BORDER] > 0.0:
            for j in range(row_margins, row_size):
                if rows[i - 1, j] < 0.0:
                    return i, h, BORDER
    return i, h, RUNNING
