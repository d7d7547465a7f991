"""Blur: how far rounding of the Jacobian moves the place at which an eigenvalue passes the axis, or a matrix is singular."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from ..continuation.engine import Engine, Solved
from ..problems.abilities import Blurred, Doubtful
from .located import Located
from .segment import Segment

ENTRY = 2.0**-50  # relative error of an entry: of several roundings, half a unit in the last place each
ALONG = 1e-4  # way along the tangent (in the metric) over which the change of a matrix is looked at


def blurred(segment: Segment, event: Located, test: Callable[[Solved], float]) -> Located:
    """The event with an error that covers the rounding of what its eigenvalue was computed from.

    Parameters
    ----------
    segment : Segment
    event : Located
    test : callable
        The eigenvalue's test function, in units of the raw spectrum.
    """
    engine, a, b = segment.engine, segment.a, segment.b
    if engine.detection != "flow" or not isinstance(engine.problem, Blurred):
        return event
    engine.residual(event.point.u, event.point.p)
    change = abs(test(b) - test(a))
    if not change > 0.0:
        return event
    error = engine.problem.blur(engine.work) * abs(b.p - a.p) / change
    return event._replace(error=max(event.error, error)) if math.isfinite(error) else event


def singular_within(engine: Engine, u: np.ndarray, p: float, tangent: np.ndarray) -> float:
    """How far rounding of (F_u, F_p), and what differences are known to, may move the value at which a branch point lies.

    With the null vectors of M = [[F_u, F_p], [tangent]], M x = 0 = y M, errors E of the entries change y M x by up to |y| E |x|; it
    grows along the branch with the slope y M' x (perturbation of a simple singular value: Stewart and Sun, Matrix Perturbation Theory
    (1990), theorem IV.2.3). Zero where it cannot be told.
    """
    problem = engine.problem
    if not isinstance(problem, Doubtful):
        return 0.0
    engine.residual(u, p)
    doubts = problem.doubts(engine.work, ENTRY)
    if doubts is None:
        return 0.0
    n, border = engine.n, engine.weights * tangent
    side = np.append(engine.row_sizes * np.random.default_rng(4).standard_normal(n), 0.0)
    right = engine.apply_inverse(border, side)
    other, left, unused = problem.workspace(), np.empty(n + 1), np.empty(n + 1)
    engine.residual(u, p)
    problem.kernels.transpose(problem.data, engine.work, border[:-1], other)
    other.residual[:] = -side[:-1] / engine.row_sizes
    turned = np.append(engine.work.derivative, border[-1])
    with np.errstate(all="ignore"):
        problem.kernels.bordered(problem.data, other, turned, 0.0, left, unused)
        right, left = right / np.abs(right).max(), left[:-1] / np.abs(left[:-1]).max()
        error = float(np.abs(left) @ (doubts @ np.abs(right)))
        values = []
        for way in (-ALONG, ALONG):
            engine.residual(u + way * tangent[:-1], p + way * float(tangent[-1]))
            image = engine.work.jacobian @ right[:-1] + engine.work.derivative * right[-1]
            values.append(float(left @ image))
    change = abs(values[1] - values[0])
    found = error * 2.0 * ALONG * abs(float(tangent[-1])) / change if change > 0.0 else 0.0
    return found if math.isfinite(found) else 0.0
