"""The continuation loop: predict, correct, judge the step, many points a call.

For problems in Python; native/march.hpp has the same for compiled ones. Nothing is known of events here.

Metric: <a, b> = a_u.b_u / N + a_p b_p / (hi - lo)^2, so that step lengths
depend neither on the number of repetitions of an orbit nor on the unit of the parameter. Unknowns of Python problems have
scales s: then a_u.b_u is the sum of a_j b_j / s_j^2 (the array ``weights``).
"""

import math

from .arrays import compare, extrapolate, fix_parameter, plane, put
from .corrector import correct
from .layout import BORDER, LEFT_INTERVAL, MARGIN, NOT_EVALUABLE, RUNNING, STEP_TOO_SMALL
from .settings import SOLUTION


def march(kernels, judge, frame, chunk, first, h, control):
    """Fill rows first, first + 1, ... of the chunk arrays with points of the branch.

    Row first - 1 holds the last known point, row first - 2 (if any) the one before it.

    Each step is judged, and the next one chosen, by ``judge`` (:mod:`contvines.continuation.step_rule`). At the ends of the
    interval the last point is corrected at the fixed parameter value, so it lies on the end exactly.

    Parameters
    ----------
    kernels
        Of the problem.
    judge : callable
        Of the step rule.
    frame : tuple
        The problem's data and workspace, metric and `Scratch`.
    chunk : Points
        Filled.
    first : int
        At least 1.
    h : float
        Step to try first.
    control : Control

    Returns
    -------
    filled : int
        Rows are filled up to, not including, this one.
    h : float
        Step to go on with.
    status : int
    """
    data, work, metric, scratch = frame
    points, values, tangents = chunk.points, chunk.values, chunk.tangents
    rows, signs, corrections = chunk.rows, chunk.signs, chunk.corrections
    u, border, step, tangent = scratch.u, scratch.border, scratch.step, scratch.tangent
    n, row_size = points.shape[1], rows.shape[1]
    angle, min_step, max_step, tolerance, lower, upper, stop_at_border, sweeps_allowed, row_margins, noise = (
        control
    )
    i = first
    trouble = 0
    while i < points.shape[0]:
        if h < min_step:
            return i, h, NOT_EVALUABLE if trouble == -2 else STEP_TOO_SMALL
        start = values[i - 1]
        p = extrapolate(points, values, tangents, i, h, metric, u)
        fixed = p > upper or p < lower
        length = h
        bound = upper if p > upper else lower
        if fixed:
            if start == bound:
                return i, h, LEFT_INTERVAL
            for _ in range(3):
                if p != start:
                    length *= min(max((bound - start) / (p - start), 0.0), 1.5)
                p = extrapolate(points, values, tangents, i, length, metric, u)
            p = bound
            fix_parameter(border)
            target = bound
        else:
            target = plane(tangents[i - 1], u, p, metric, border)
        put(points[i], u, 1.0)
        guess = p
        p, sweeps, sign, size = correct(
            kernels,
            data,
            work,
            u,
            p,
            border,
            target,
            tolerance,
            sweeps_allowed,
            step,
            tangent,
            metric,
            noise,
        )
        if sweeps < 0:
            trouble = sweeps
            h *= 0.5
            continue
        trouble = 0
        if metric.moving is not None:
            metric.moving.steer(u, tangent)
        norm, cosine, error = compare(tangent, tangents[i - 1], u, points[i], p, guess, metric)
        if fixed:
            p = bound
            if cosine < 0.0:
                cosine = -cosine
                norm = -norm
            if tangent[n] * norm < 0.0:
                sign = -sign
        turn = math.sqrt(max(0.0, 2.0 - 2.0 * cosine))
        factor = judge(turn, error, sweeps, length, angle, max(SOLUTION.rounding, noise))
        if not factor > 0.0:
            h = -factor * length
            continue
        if p > upper or p < lower:
            bound = upper if p > upper else lower
            h = length * max(0.5, (bound - start) / (p - start)) * 1.0000001
            if guess == p or start == bound:
                return i, h, LEFT_INTERVAL
            if h >= length:
                h = 0.9 * length
            continue
        put(points[i], u, 1.0)
        put(tangents[i], tangent, norm)
        values[i] = p
        signs[i] = sign
        corrections[i] = size
        kernels.inspect(data, u, p, work, rows[i])
        i += 1
        if fixed:
            return i, h, LEFT_INTERVAL
        h = min(h * factor, max_step)
        if stop_at_border:
            for j in range(row_margins, row_size):
                if rows[i - 1, j] < MARGIN:
                    return i, h, BORDER
    return i, h, RUNNING
