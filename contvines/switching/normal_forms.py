"""Normal forms: on which side a bifurcating branch lives, and how steeply.

At a period doubling or symmetry breaking with critical multiplier m(p) the bifurcating branch is p = p0 + p2 s^2 with s the
amplitude along the critical vector: the Lyapunov-Schmidt reduction, carried out numerically by solving at fixed small
amplitudes and extrapolating to zero (:mod:`contvines.switching.departures`). Comparing with the normal forms
(Kuznetsov, Elements of Applied Bifurcation Theory, 3rd ed., sections 4.5 and 7.4). The critical vector q has q.q = 1 over
the unknowns of an algebraic problem, over the first point of a cycle, of maps and of machines alike; the form is that of the return map:

    flip        xi -> m xi + c xi^3,  m near -1:   c = p2 d|m|/dp     supercritical for c > 0
    pitchfork   xi -> m xi + a xi^3,  m near +1:   a = -p2 dm/dp      supercritical for a < 0
    flow        xi' = m xi + a xi^3,  m near 0:    a = -p2 dm/dp      supercritical for a < 0

In words: supercritical when the bifurcating branch lives where the known one has lost the stability that it had.
A fold has p = p0 + a s^2 with s the amplitude along q; its coefficient is a.
"""

from __future__ import annotations

import numpy as np

from ..continuation.aims import aim_at_multiplier
from ..continuation.engine import Engine, Solved

STEP = 1e-3


def _beside(engine: Engine, point: Solved, step: float) -> Solved | None:
    border = engine.weights * point.tangent
    guess = engine.join(point.u, point.p) + step * point.tangent
    return engine.solve(guess[:-1], guess[-1], border, float(border @ guess), point.tangent)


def crossing_speed(engine: Engine, point: Solved, name: str, k: int) -> float | None:
    """d(log abs(m))/dp of the critical multiplier (dm/dp for flows) along the known branch; None if not to be had.

    Parameters
    ----------
    engine : Engine
    point : Solved
        The special point, with the tangent of the known branch.
    name, k
        Which multiplier; see :func:`contvines.continuation.aims.aim_at_multiplier`.
    """
    kind = engine.problem.spectrum
    if kind == "none" or abs(point.tangent[-1]) < 1e-9:
        return None
    aim = aim_at_multiplier(engine.m, kind, name, k)
    slopes = []
    for step in (STEP, 0.5 * STEP):
        ends = [_beside(engine, point, sign * step) for sign in (1.0, -1.0)]
        if ends[0] is None or ends[1] is None:
            return None
        tests = [aim(end) for end in ends if end is not None]
        slopes.append((tests[0] - tests[1]) / (ends[0].p - ends[1].p))
    return float((4.0 * slopes[1] - slopes[0]) / 3.0) * engine.rate


def criticality(curvature: float, speed: float | None, flip: bool) -> tuple[str | None, float | None]:
    """("supercritical" or "subcritical", normal-form coefficient).

    Parameters
    ----------
    curvature : float
        p2 of the bifurcating branch.
    speed : float or None
        d(log abs(m))/dp on the known branch.
    flip : bool
        Critical multiplier -1.
    """
    if speed is None or not np.isfinite(speed) or speed == 0.0 or curvature == 0.0:
        return None, None
    product = curvature * speed
    return ("supercritical" if product > 0.0 else "subcritical"), float(product if flip else -product)


def fold_coefficient(engine: Engine, point: Solved) -> float | None:
    """a in p = p0 + a s^2 along the branch through a fold, s the amplitude along the critical vector."""
    slopes = []
    for step in (STEP, 0.5 * STEP):
        ahead, back = _beside(engine, point, step), _beside(engine, point, -step)
        if ahead is None or back is None:
            return None
        slopes.append((ahead.p + back.p - 2.0 * point.p) / (2.0 * step**2))
    return float((4.0 * slopes[1] - slopes[0]) / 3.0) / engine.amplitude(point.tangent) ** 2
