"""Criticality: on which side of a special point the bifurcating branch exists, and the normal-form coefficient; strong resonances near Neimark-Sacker points.

At a period doubling or symmetry breaking with critical multiplier m(p) the bifurcating branch is p = p0 + p2 s^2 with s the
amplitude along the critical vector: the Lyapunov-Schmidt reduction, carried out numerically by solving at fixed small
amplitudes and extrapolating to zero (:mod:`contvines.bifurcation.switching`). Comparing with the normal forms
(Kuznetsov, Elements of Applied Bifurcation Theory, 3rd ed., sections 4.5 and 7.4). The critical vector q has q.q = 1 over
the unknowns of an algebraic problem, over the first point of a cycle, of maps and of machines alike; the form is that of the return map:

    flip        xi -> m xi + c xi^3,  m near -1:   c = p2 d|m|/dp     supercritical for c > 0
    pitchfork   xi -> m xi + a xi^3,  m near +1:   a = -p2 dm/dp      supercritical for a < 0
    flow        xi' = m xi + a xi^3,  m near 0:    a = -p2 dm/dp      supercritical for a < 0

In words: supercritical if the bifurcating branch exists on the side where the known branch has lost its stability.
A fold has p = p0 + a s^2 with s the amplitude along q; its coefficient is a. Neimark-Sacker and Hopf points have the first Lyapunov coefficient.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ...continuation.engine import Engine, Solved
from ...continuation.layout import Way, aim_at_multiplier, solved_points
from ...problems.protocol import Problem
from ..kind import Classified
from ..settings import NORMAL_FORMS
from .coefficients import Forms

STRONG = {"1:1": 0.0, "1:2": np.pi, "1:3": 2.0 * np.pi / 3.0, "1:4": 0.5 * np.pi}
# points beside a special point are placed on a chord along the tangent, much longer than the step, so that none of them is an end of the chord
CHORD = 16.0  # length of this chord, in steps
PLACES = np.array([1.0, -1.0, 0.5, -0.5]) / CHORD  # positions of the points on it
STEP_RATIO = 0.25  # ratio of successive steps, if the result has not converged


def strong_resonance(multiplier: complex) -> str:
    """Return the strong resonance near which a multiplier of the full period is, for example "1:3"; "" for none."""
    angle = abs(float(np.angle(multiplier)))
    return next((n for n, place in STRONG.items() if abs(angle - place) < NORMAL_FORMS.resonant), "")


def near_resonance(multiplier: complex) -> tuple[str, ...]:
    """Return remarks on a multiplier of the full period: none, or one that names a nearby strong resonance."""
    resonance = strong_resonance(multiplier)
    return (f"near the strong resonance {resonance}",) if resonance else ()


def pair_form(problem: Problem, u: np.ndarray, p: float, spectrum: np.ndarray) -> Classified:
    """Compute the first Lyapunov coefficient at a Neimark-Sacker or Hopf point: d of a cycle, l1 of an equilibrium.

    Supercritical (negative): a stable circle (cycle) is born on the side where the motion has lost its stability. Remarks name a nearby strong
    resonance, or say that the error is as large as the coefficient, or why there is no coefficient.

    Parameters
    ----------
    problem : Problem
    u, p
        The special point.
    spectrum : ndarray of complex
        Raw multipliers there (for a flow with few unknowns they are computed again here).
    """
    flow = problem.spectrum == "flow"
    if problem.kernels.matrix is None:
        return Classified()
    from ...problems.spectra import is_large

    try:
        if is_large(problem):
            from .sparse_pair import sparse_lyapunov

            critical = _critical(np.asarray(problem.to_multipliers(spectrum), dtype=complex), flow)
            found = sparse_lyapunov(problem, u, p, critical)
        else:
            forms = Forms(problem, u, p)
            critical = _critical(forms.eigenvalues if flow else np.asarray(spectrum, dtype=complex), flow)
            found, _ = forms.lyapunov(critical)
    except (ValueError, IndexError, np.linalg.LinAlgError) as error:
        return Classified(remarks=(f"no first Lyapunov coefficient: {error}",))
    value = float(found.value)
    if not np.isfinite(value):
        return Classified(remarks=("no first Lyapunov coefficient: it is not finite",))
    if found.error > 0.5 * abs(value):
        return Classified(None, value, ("the first Lyapunov coefficient is zero within its error",))
    full = np.asarray(problem.to_multipliers(np.array([critical])))[0]
    remarks = () if flow else near_resonance(complex(full))
    return Classified("supercritical" if value < 0.0 else "subcritical", value, remarks)


def _critical(values: np.ndarray, flow: bool) -> complex:
    """Return the value with positive imaginary part that is nearest to the boundary of stability.

    Raises
    ------
    ValueError
        If no value has a positive imaginary part.
    """
    upper = values[np.imag(values) > 0.0]
    if not len(upper):
        raise ValueError("no pair is known at the point")
    return complex(upper[np.argmin(np.abs(np.real(upper)) if flow else np.abs(np.abs(upper) - 1.0))])


def cubic_form(problem: Problem, u: np.ndarray, p: float, flip: bool) -> float | None:
    """Compute the cubic coefficient at a flip or pitchfork; None without a spectrum or a Jacobian matrix, or if the error is too large.

    Parameters
    ----------
    problem : Problem
    u, p
        The special point.
    flip : bool
        Whether the critical multiplier is -1.
    """
    if problem.spectrum == "none" or problem.kernels.matrix is None:
        return None
    factor = -1.0 if flip else (0.0 if problem.spectrum == "flow" else 1.0)
    try:
        found = Forms(problem, u, p).cubic(factor)
    except (ValueError, IndexError, np.linalg.LinAlgError):
        return None
    return (
        float(found.value)
        if np.isfinite(found.value) and found.error < NORMAL_FORMS.unsure * abs(found.value)
        else None
    )


def _neighbours(engine: Engine, point: Solved, step: float) -> list[Solved] | None:
    """Return the points of the branch at +step, -step, +step/2 and -step/2; None if one of them cannot be solved."""
    length = CHORD * step
    z, along = engine.join(point.u, point.p), length * point.tangent
    border = engine.weights * point.tangent
    chord = np.array([z, along, z + along, along])
    found = engine.on_chord(Way(chord, float(border @ z), length, border, point.tangent), PLACES)
    points = [near for near in solved_points(found) if near is not None]
    return points if len(points) == len(PLACES) else None


def _converged(
    engine: Engine, point: Solved, estimate: Callable[[Solved, Solved, float], float]
) -> float | None:
    """Extrapolate a central-difference estimate to zero step; None if it cannot be computed.

    The step is shortened until estimates from the step and from half of it agree, as another special point may be as near as the step. If they never
    do, the result is that of the step at which they differ least.

    Parameters
    ----------
    engine : Engine
    point : Solved
        The special point, with the tangent of the branch.
    estimate : callable
        (point at +step, point at -step, step) -> estimate with an error of second order in the step.
    """
    best, least, step = None, np.inf, NORMAL_FORMS.step
    while step > engine.settings.resolution:
        ends = _neighbours(engine, point, step)
        if ends is not None:
            far, near = estimate(ends[0], ends[1], step), estimate(ends[2], ends[3], 0.5 * step)
            value = (4.0 * near - far) / 3.0
            change = abs((near - far) / value) if value else np.inf
            if np.isfinite(value) and (best is None or change < least):
                best, least = value, change
            if change <= NORMAL_FORMS.digits:
                break
        step *= STEP_RATIO
    return best


def crossing_speed(engine: Engine, point: Solved, name: str, k: int) -> float | None:
    """Compute d(log abs(m))/dp of the critical multiplier m (dm/dp for flows) along the known branch; None if not available.

    Parameters
    ----------
    engine : Engine
    point : Solved
        The special point, with the tangent of the known branch.
    name, k
        Sort and rank of the multiplier; see :func:`contvines.continuation.layout.aim_at_multiplier`.
    """
    kind = engine.problem.spectrum
    if kind == "none" or abs(point.tangent[-1]) < engine.settings.upright:
        return None
    aim = aim_at_multiplier(engine.m, kind, name, k)

    def slope(ahead: Solved, back: Solved, _: float) -> float:
        with np.errstate(all="ignore"):
            return float(np.float64(aim(ahead) - aim(back)) / (ahead.p - back.p))

    found = _converged(engine, point, slope)
    return None if found is None else found * engine.rate


def criticality(curvature: float, speed: float | None, flip: bool) -> tuple[str | None, float | None]:
    """Return ("supercritical" or "subcritical", normal-form coefficient), or (None, None) if undecided.

    Parameters
    ----------
    curvature : float
        p2 of the bifurcating branch, p = p0 + p2 s^2.
    speed : float or None
        d(log abs(m))/dp on the known branch.
    flip : bool
        Whether the critical multiplier is -1.
    """
    if speed is None or not np.isfinite(speed) or speed == 0.0 or curvature == 0.0:
        return None, None
    product = curvature * speed
    return ("supercritical" if product > 0.0 else "subcritical"), float(product if flip else -product)


def fold_coefficient(engine: Engine, point: Solved) -> float | None:
    """Compute a in p = p0 + a s^2 along the branch through a fold, s the amplitude along the critical vector; None if not available."""

    def bend(ahead: Solved, back: Solved, step: float) -> float:
        return (ahead.p + back.p - 2.0 * point.p) / (2.0 * step**2)

    found = _converged(engine, point, bend)
    return None if found is None else found / engine.amplitude(point.tangent) ** 2
