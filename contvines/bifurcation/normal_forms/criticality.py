"""Criticality of Neimark-Sacker and Hopf points, and the strong resonances next to them."""

from __future__ import annotations

import numpy as np

from ...problems.protocol import Problem
from ..kind import Classified
from ..settings import NORMAL_FORMS
from .coefficients import Forms

STRONG = {"1:1": 0.0, "1:2": np.pi, "1:3": 2.0 * np.pi / 3.0, "1:4": 0.5 * np.pi}


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
