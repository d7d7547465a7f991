"""Which coefficients of normal forms are given at which point of codimension two."""

from __future__ import annotations

import numpy as np

from ..forms.coefficients import Forms
from .conditions import critical_eigenvalue
from .linear import Linearisation
from .plane_point import PlanePoint


def coefficients(point: PlanePoint) -> dict[str, float]:
    """Normal-form coefficients at a point, by name; none where the derivatives cannot be had.

    "a" is the quadratic coefficient of a critical direction with multiplier 1, "c" the cubic one (of a cusp, a flip, a symmetry
    breaking), "l1" (flows) or "d" (maps) the first Lyapunov coefficient, "theta" the angle of a pair, "omega" its frequency.
    Bogdanov-Takens: z1' = z2, z2' = a z1^2 + b z1 z2. Resonance 1:4: z -> i z + c z^2 z* + d z*^3, given as A = -i c / abs(d).
    """
    problem, kind = point.problem, point.kind
    if getattr(problem.kernels, "matrix", None) is None or point.margins:
        return {}
    try:
        forms = Forms(problem, point.u, point.value[0])
        return {name: float(value) for name, value in _of(kind, forms, point).items() if np.isfinite(value)}
    except (ValueError, np.linalg.LinAlgError, IndexError):
        return {}


def _of(kind: str, forms: Forms, point: PlanePoint) -> dict[str, float]:
    found: dict[str, float] = {}
    if kind == "cusp":
        found["c"] = forms.cubic(0.0 if forms.flow else 1.0).value
    if kind == "bogdanov-takens":
        found["a"], found["b"] = forms.bogdanov_takens()
    if kind in ("fold-flip", "fold-symmetry-breaking", "fold-neimark-sacker", "zero-hopf"):
        found["a"] = forms.quadratic().value
    if kind in (
        "fold-flip",
        "fold-symmetry-breaking",
        "flip-neimark-sacker",
        "symmetry-breaking-neimark-sacker",
    ):
        found["c"] = forms.cubic(-1.0).value
    pair = _pair(forms)
    if pair is None:
        return found
    if forms.flow:
        found["omega"] = pair.imag
    else:
        found["theta"] = float(np.angle(pair))
    if kind == "resonance-1-4":
        found |= forms.fourth_order(pair)
    elif kind in ("resonance-1-3", "generalized-hopf", "chenciner"):
        found["l1" if forms.flow else "d"] = forms.lyapunov(pair)[0].value
    return found


def _pair(forms: Forms) -> complex | None:
    """The raw critical pair, upper one; None if there is none on the boundary."""
    if forms.flow:
        return critical_eigenvalue(forms)
    line = Linearisation(forms.problem)
    line.at(forms.u, forms.p)
    spectrum = line.spectrum()
    upper = spectrum[spectrum.imag > 1e-6]
    if not len(upper):
        return None
    distance = np.abs(np.abs(upper) - 1.0)
    return complex(upper[np.argmin(distance)]) if distance.min() < 1e-6 else None
