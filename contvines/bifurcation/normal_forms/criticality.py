"""Normal forms: on which side a bifurcating branch lives, and how steeply; strong resonances next to Neimark-Sacker points.

At a period doubling or symmetry breaking with critical multiplier m(p) the bifurcating branch is p = p0 + p2 s^2 with s the
amplitude along the critical vector: the Lyapunov-Schmidt reduction, carried out numerically by solving at fixed small
amplitudes and extrapolating to zero (:mod:`contvines.bifurcation.switching`). Comparing with the normal forms
(Kuznetsov, Elements of Applied Bifurcation Theory, 3rd ed., sections 4.5 and 7.4). The critical vector q has q.q = 1 over
the unknowns of an algebraic problem, over the first point of a cycle, of maps and of machines alike; the form is that of the return map:

    flip        xi -> m xi + c xi^3,  m near -1:   c = p2 d|m|/dp     supercritical for c > 0
    pitchfork   xi -> m xi + a xi^3,  m near +1:   a = -p2 dm/dp      supercritical for a < 0
    flow        xi' = m xi + a xi^3,  m near 0:    a = -p2 dm/dp      supercritical for a < 0

In words: supercritical when the bifurcating branch lives where the known one has lost the stability that it had.
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
WIDE = 16.0  # times a step: the chord on which points beside a special point are placed; they may lie far off it, and are none of its ends
PLACES = np.array([1.0, -1.0, 0.5, -0.5]) / WIDE
NEARER = 0.25  # times a step: the next one, where a number has not converged


def strong_resonance(multiplier: complex) -> str:
    """The strong resonance at which a multiplier of the full period is, "1:3" for example; "" for none."""
    angle = abs(float(np.angle(multiplier)))
    return next((n for n, place in STRONG.items() if abs(angle - place) < NORMAL_FORMS.resonant), "")


def near_resonance(multiplier: complex) -> tuple[str, ...]:
    """Remarks on a multiplier of the full period next to a strong resonance."""
    resonance = strong_resonance(multiplier)
    return (f"near the strong resonance {resonance}",) if resonance else ()


def pair_form(problem: Problem, u: np.ndarray, p: float, spectrum: np.ndarray) -> Classified:
    """The first Lyapunov coefficient at a Neimark-Sacker or Hopf point, d of a cycle, l1 of an equilibrium; None where it cannot be obtained.

    Supercritical: a stable circle (cycle) is born where the motion has lost its stability. Remarks name a nearby strong resonance, or say that
    the error is as large as the coefficient.

    Parameters
    ----------
    problem : Problem
    u, p
        The point.
    spectrum : ndarray of complex
        Raw multipliers there (of a flow with few unknowns they are computed here).
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
    """Of the upper half plane the value that is nearest to the boundary of stability.

    Raises
    ------
    ValueError
        If none is there.
    """
    upper = values[np.imag(values) > 0.0]
    if not len(upper):
        raise ValueError("no pair is known at the point")
    return complex(upper[np.argmin(np.abs(np.real(upper)) if flow else np.abs(np.abs(upper) - 1.0))])


def cubic_form(problem: Problem, u: np.ndarray, p: float, flip: bool) -> float | None:
    """The cubic coefficient at a flip or pitchfork of a problem with a spectrum and the whole Jacobian; else None.

    Parameters
    ----------
    problem : Problem
    u, p
        The point.
    flip : bool
        Critical multiplier -1.
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


def _beside(engine: Engine, point: Solved, step: float) -> list[Solved] | None:
    """Points of the branch ahead and back, at a step and at half of that; None if one of them is not found."""
    length = WIDE * step
    z, along = engine.join(point.u, point.p), length * point.tangent
    border = engine.weights * point.tangent
    chord = np.array([z, along, z + along, along])
    found = engine.on_chord(Way(chord, float(border @ z), length, border, point.tangent), PLACES)
    points = [near for near in solved_points(found) if near is not None]
    return points if len(points) == len(PLACES) else None


def _converged(
    engine: Engine, point: Solved, estimate: Callable[[Solved, Solved, float], float]
) -> float | None:
    """A number from a point of the branch ahead and one back, both at a step, continued to no step at all; None if it is not available.

    The step is made shorter until half of it says the same: another special point, of which the number knows nothing, may be as near as that.
    Where none does, the number is that of the step at which both differ least.
    """
    best, least, step = None, np.inf, NORMAL_FORMS.step
    while step > engine.settings.resolution:
        ends = _beside(engine, point, step)
        if ends is not None:
            far, near = estimate(ends[0], ends[1], step), estimate(ends[2], ends[3], 0.5 * step)
            value = (4.0 * near - far) / 3.0
            apart = abs((near - far) / value) if value else np.inf
            if np.isfinite(value) and (best is None or apart < least):
                best, least = value, apart
            if apart <= NORMAL_FORMS.digits:
                break
        step *= NEARER
    return best


def crossing_speed(engine: Engine, point: Solved, name: str, k: int) -> float | None:
    """d(log abs(m))/dp of the critical multiplier (dm/dp for flows) along the known branch; None if not available.

    Parameters
    ----------
    engine : Engine
    point : Solved
        The special point, with the tangent of the known branch.
    name, k
        Which multiplier; see :func:`contvines.continuation.layout.aim_at_multiplier`.
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

    def bend(ahead: Solved, back: Solved, step: float) -> float:
        return (ahead.p + back.p - 2.0 * point.p) / (2.0 * step**2)

    found = _converged(engine, point, bend)
    return None if found is None else found / engine.amplitude(point.tangent) ** 2
