"""Test functions of a locus at any point, and their derivatives along directions; see :mod:`contvines.loci.kernels`.

native/loci.hpp has the same for compiled problems.
"""

import math

import numpy as np

from ..bifurcation.settings import LOCATING
from ..shared.floating_point import ROUNDED
from .layout import (
    BASE_F,
    BORDERS,
    BRANCH,
    CALLS,
    FIRST,
    FLIP,
    FLIP_B,
    FLIP_C,
    FLOW,
    FOLD,
    FROZEN,
    GROWTH,
    KIND,
    KNOWN,
    LINES,
    MARGIN,
    MULTIPLIERS,
    PERIOD,
    POINT,
    REFERENCE,
    ROW,
    SCALES,
    SECOND,
    SHIFTED,
    SOLUTIONS,
    STATE,
    TESTED,
    TRIAL,
    TRIAL_F,
    TRIAL_Q,
    UNIT,
    VALUES,
    WHICH,
    B,
    C,
)
from .settings import SCALING


def null_test(calls, data, linear, F, Q, b, c, line, step, tangent):
    """Solve M (v, g) = (0, 1) with the linearisation at hand, into `tangent`; returns g."""
    n = F.shape[0]
    F[:], Q[:], line[:n], line[n] = 0.0, b[:n], c[:n], 0.0
    calls.bordered(data, linear, line, 0.0, step, tangent)
    return tangent[n]


def flipped_test(calls, data, linear, F, Q, b, c, line, step, tangent):
    """The same for perturbations that change sign over the period; the linearisation is left as it was."""
    calls.flip(data, linear, -1.0)
    value = null_test(calls, data, linear, F, Q, b, c, line, step, tangent)
    calls.flip(data, linear, 1.0)
    return value


def pair_of(row, multipliers, flow, reference, found):
    """(test, position) of the pair nearest to the stability boundary and to the reference, into `found`.

    Maps: m1 m2 - 1 and (m1 + m2)/2, the cosine of the angle; flows: l1 + l2 and l1 l2, the square of the frequency.
    """
    best = math.inf
    found[0] = math.nan
    found[1] = math.nan
    for i in range(multipliers):
        a, b = row[2 * i], row[2 * i + 1]
        for j in range(i + 1, multipliers):
            c, d = row[2 * j], row[2 * j + 1]
            if abs(b + d) > LOCATING.rounding * (1.0 + abs(b)) or (
                b != 0.0 and abs(a - c) > LOCATING.rounding * (1.0 + abs(a))
            ):
                continue  # neither two real ones nor a conjugate pair
            total, product = a + c, a * c - b * d
            if flow:
                test, place = total, product
                distance = abs(total) + 0.1 * abs(product - reference) / (1.0 + abs(reference))
            else:
                test, place = product - 1.0, 0.5 * total
                distance = abs(test) + 0.1 * abs(place - reference)
            if distance < best:
                best = distance
                found[0] = test
                found[1] = place


def tests(data, work, u, p, q, values):
    """The tests g at any (u, p, q), into `values`; the linearisation in TRIAL is used up. Returns the residual."""
    first, trial = data[FIRST], work[TRIAL]
    F, Q, lines, borders, solutions = (
        work[TRIAL_F],
        work[TRIAL_Q],
        work[LINES],
        work[BORDERS],
        work[SOLUTIONS],
    )
    n = F.shape[0]
    kind, calls = data[KIND], data[CALLS]
    calls.assign(first, data[SECOND], q)
    residual = calls.linearise(first, u, p, trial)
    if not math.isfinite(residual):
        return residual
    if kind == FOLD:
        values[0] = null_test(
            calls, first, trial, F, Q, borders[B], borders[C], lines[0], lines[1], solutions[TESTED]
        )
    elif kind == FLIP:
        values[0] = flipped_test(
            calls, first, trial, F, Q, borders[FLIP_B], borders[FLIP_C], lines[0], lines[1], solutions[TESTED]
        )
    elif kind == BRANCH:
        F[:] = data[UNIT] * Q
        Q[:], lines[0, :n], lines[0, n] = borders[B, :n], borders[C, :n], 0.0
        calls.bordered(first, trial, lines[0], 0.0, lines[1], solutions[TESTED])
        values[0] = solutions[TESTED, n]
        values[1] = lines[1, n]
    elif kind == PERIOD:
        values[0] = u[data[WHICH]] / work[REFERENCE][0] - 1.0
    else:
        row = work[ROW]
        calls.inspect(first, u, p, trial, row)
        if kind == MARGIN:
            values[0] = row[2 * data[MULTIPLIERS] + data[WHICH]]
        elif kind == GROWTH:
            values[0] = math.log(abs(row[0])) if row[0] != 0.0 else -math.inf
        else:
            pair_of(row, data[MULTIPLIERS], data[FLOW], work[REFERENCE][0], work[REFERENCE][1:])
            values[0] = work[REFERENCE][1]
    return residual


def slopes_along(data, work, direction, slopes):
    """Derivatives of the tests along a direction in (U, q), by differences."""
    point, scales, shifted, values = work[POINT], work[SCALES], work[SHIFTED], work[VALUES]
    n, last = work[BASE_F].shape[0], point.shape[0] - 1
    count = last - n
    parts = np.abs(direction) / np.maximum(scales[: last + 1], np.abs(point))
    length = max(parts[last], parts[: n + 1].max())
    if not length > ROUNDED:
        slopes[:count] = 0.0
        return
    h = SCALING.step / length
    shifted[: n + 1] = point[: n + 1] + h * direction[: n + 1]
    q = point[last] + h * direction[last]
    tests(data, work, shifted[:n], data[UNIT] * shifted[n], q, slopes)
    slopes[:count] = (slopes[:count] - values[:count]) / h


def frozen(work, U, q):
    """Whether directions and slopes are those of the last call, because the point has hardly moved; keeps the point if not.

    Slopes are known to about the step; a point that has moved less than that has them to that accuracy.
    """
    kept, scales, state = work[FROZEN], work[SCALES], work[STATE]
    last = U.shape[0]
    near = state[KNOWN] > 0.0 and abs(q - kept[last]) < SCALING.step * max(scales[last], abs(q))
    if near and (np.abs(U - kept[:last]) < SCALING.step * np.maximum(scales[:last], np.abs(U))).all():
        return True
    kept[:last], kept[last] = U, q
    return False
