"""Test functions of a locus at any point, and their derivatives along directions; see :mod:`contvines.loci.kernels`.

native/loci.hpp has the same for compiled problems.
"""

import math

import numpy as np
from numpy.typing import NDArray

from ..bifurcation.settings import LOCATING
from ..shared.floating_point import ROUNDED
from .layout import BRANCH, FLIP, FLIP_B, FLIP_C, FOLD, GROWTH, KNOWN, MARGIN, OWN, PERIOD, TESTED, B, C
from .settings import SCALING


def null_test(data, work, b, c):
    """Solve M (v, g) = (0, 1) with the linearisation in `trial`; returns g."""
    line, step, null = *work.lines, work.solutions[TESTED]
    work.trial_F[:], work.trial_Q[:], line[:-1], line[-1] = 0.0, b[:-1], c[:-1], 0.0
    data.calls.bordered(data.first, work.trial, line, 0.0, step, null)
    return null[-1]


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


def position_of(spectrum: NDArray[np.complex128], flow: bool, other: float = 0.0) -> float:
    """Position of the complex pair nearest to the stability boundary, see `pair_of`; `other` where there is none."""
    upper = spectrum[spectrum.imag > 0.0]
    if not len(upper):
        return other
    nearest = upper[np.argmin(np.abs(upper.real if flow else np.abs(upper) - 1.0))]
    return float(np.abs(nearest) ** 2 if flow else nearest.real)


def tests(data, work, u, p, q, values):
    """The tests g at any (u, p, q), into `values`; the linearisation in `trial` is used up."""
    first, trial, borders, calls, kind = data.first, work.trial, work.borders, data.calls, data.kind
    calls.assign(first, data.second, q)
    if not math.isfinite(calls.linearise(first, u, p, trial)):
        return
    if kind == FOLD:
        values[0] = null_test(data, work, borders[B], borders[C])
    elif kind == FLIP:  # the linearisation is left as it was
        calls.flip(first, trial, -1.0)
        values[0] = null_test(data, work, borders[FLIP_B], borders[FLIP_C])
        calls.flip(first, trial, 1.0)
    elif kind == BRANCH:
        line, step, null = *work.lines, work.solutions[TESTED]
        work.trial_F[:] = data.unit * work.trial_Q
        work.trial_Q[:], line[:-1], line[-1] = borders[B, :-1], borders[C, :-1], 0.0
        calls.bordered(first, trial, line, 0.0, step, null)
        values[:2] = null[-1], step[-1]
    elif kind == PERIOD:
        values[0] = u[data.which] / work.reference[0] - 1.0
    elif kind == OWN:
        values[0] = data.own(u, p, q, trial, work.row)
    else:
        row = work.row
        calls.inspect(first, u, p, trial, row)
        if kind == MARGIN:
            values[0] = row[2 * data.multipliers + data.which]
        elif kind == GROWTH:
            values[0] = math.log(abs(row[0])) if row[0] != 0.0 else -math.inf
        else:
            pair_of(row, data.multipliers, data.flow, work.reference[0], work.reference[1:])
            values[0] = work.reference[1]


def slopes_along(data, work, direction, slopes):
    """Derivatives of the tests along a direction in (U, q), by differences."""
    point, n = work.point, len(work.base_F)
    count = len(point) - 1 - n
    parts = np.abs(direction) / np.maximum(work.scales[: len(point)], np.abs(point))
    length = max(parts[-1], parts[: n + 1].max())
    if not length > ROUNDED:
        slopes[:count] = 0.0
        return
    h = SCALING.step / length
    moved = point + h * direction
    tests(data, work, moved[:n], data.unit * moved[n], moved[-1], slopes)
    slopes[:count] = (slopes[:count] - work.values[:count]) / h


def frozen(work, U, q):
    """Whether directions and slopes are those of the last call, because the point has hardly moved; keeps the point if not.

    Slopes are known to about the step; a point that has moved less than that has them to that accuracy.
    """
    kept, here = work.frozen, np.append(U, q)
    scales = work.scales[: len(here)]
    if (
        work.state[KNOWN] > 0.0
        and (np.abs(here - kept) < SCALING.step * np.maximum(scales, np.abs(here))).all()
    ):
        return True
    kept[:] = here
    return False
