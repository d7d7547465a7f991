"""The coefficients of normal forms that are given at a point of codimension two."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..bifurcation.normal_forms.coefficients import Forms
from ..bifurcation.normal_forms.critical import normal_form
from ..bifurcation.normal_forms.returned import ReturnForms, forms_at
from .linear import Linearisation
from .plane_point import PlanePoint
from .settings import VANISHING

FREQUENCY_KNOWN = ("bogdanov-takens", "resonance-1-1", "resonance-1-2", "resonance-1-3", "resonance-1-4")
"""Kinds that say themselves where the critical pair is; at a double zero rounding may make one of it."""


def coefficients(point: PlanePoint) -> dict[str, float]:
    """Normal-form coefficients at a point, by name; none where the derivatives cannot be obtained.

    The normal forms are those of :mod:`contvines.bifurcation.normal_forms.critical`; beside their coefficients "angle" is that of a pair (of the
    problem's own period), "omega" its frequency, where the kind itself leaves them open.
    """
    problem, kind = point.attached, point.kind
    if problem.kernels.matrix is None or point.margins:
        return {}
    try:
        forms = forms_at(problem, point.u, point.value[0])
        pairs = critical_pairs(forms)
        found = normal_form(kind, forms, pairs)
    except (ValueError, np.linalg.LinAlgError, IndexError):
        return {}
    if pairs and kind not in FREQUENCY_KNOWN:
        found |= {"omega": pairs[0].imag} if forms.flow else {"angle": float(np.angle(pairs[0]))}
    return {name: float(value) for name, value in found.items() if np.isfinite(value)}


def critical_pairs(forms: Forms) -> list[complex]:
    """The raw multipliers (eigenvalues) on the boundary with positive imaginary part, the most critical one first."""
    if forms.flow:
        spectrum = forms.eigenvalues
        size = float(np.abs(spectrum).max()) or 1.0
        upper = spectrum[spectrum.imag > VANISHING.critical * size]
        distance = np.abs(upper.real) / size
    else:
        spectrum = forms.spectrum() if isinstance(forms, ReturnForms) else _spectrum(forms)
        upper = spectrum[spectrum.imag > VANISHING.critical]
        distance = np.abs(np.abs(upper) - 1.0)
    order = np.argsort(distance, kind="stable")
    return [complex(upper[i]) for i in order if distance[i] < VANISHING.critical]


def _spectrum(forms: Forms) -> NDArray[np.complex128]:
    line = Linearisation(forms.problem)
    line.at(forms.u * forms.units, forms.p)
    return line.spectrum()
