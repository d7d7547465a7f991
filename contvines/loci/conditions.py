"""Test functions in the plane of two parameters: those of the points of codimension two on a locus."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..bifurcation.normal_forms.coefficients import Coefficient, Forms
from ..bifurcation.settings import NORMAL_FORMS
from ..problems.abilities import Adaptive
from .kinds import Look
from .linear import Null
from .on_mesh import on_mesh
from .plane import Plane
from .probing import position_of
from .problem import LocusProblem
from .touching import slope_along_branch

COEFFICIENTS = ("quadratic", "cubic", "lyapunov")  # tests that are coefficients of normal forms
UNKNOWN = Coefficient(np.nan, np.inf)

Test = Callable[[Plane], float]


class References:
    """Borders and positions that belong to one point of a locus, held fixed while tests are compared and solved."""

    def __init__(self, plane: Plane, locus: LocusProblem, near: References | None = None) -> None:
        problem, maps = plane.problem, plane.problem.spectrum == "map"
        self.plus: Null = plane.first.null_vectors(near=None if near is None else near.plus)
        # without a flip the unknowns hold no perturbations that could change sign over the period
        flips = maps and not problem.movable and problem.kernels.flip is not None
        before = None if near is None else near.minus
        self.minus: Null | None = plane.first.null_vectors(True, before) if flips else None
        self.reference = locus.reference
        self.second = 0.0
        if plane.m >= 2:
            self.reference = plane.pair(position_of(plane.spectrum, plane.flow, self.reference))[1]
            self.second = self._other(plane)

    def _other(self, plane: Plane) -> float:
        spectrum = plane.spectrum
        upper = spectrum[spectrum.imag > 0.0]
        if len(upper) < 2:
            return np.nan
        distance = np.abs(upper.real) if plane.flow else np.abs(np.abs(upper) - 1.0)
        other = upper[np.argsort(distance)[1]]
        return float(np.abs(other) ** 2 if plane.flow else other.real)


def test_of(look: Look, locus: LocusProblem, at: References) -> Test | None:
    """The test function of something to look for; None where it cannot be asked here."""
    plus, minus = at.plus, at.minus
    if look.test in COEFFICIENTS:
        return lambda x: coefficient_of(look, at, x).value
    if look.test == "plus":
        return lambda x: x.singular_test(plus.column, plus.row)
    if look.test == "minus":
        return None if minus is None else lambda x: x.singular_test(minus.column, minus.row, flipped=True)
    if look.test == "pair":
        return lambda x: x.pair(at.reference)[0]
    if look.test == "second-pair":
        return None if np.isnan(at.second) else lambda x: x.other_pair(at.reference, at.second)
    if look.test == "touch":
        return lambda x: slope_along_branch(x, plus, locus.index)
    if look.test == "double":
        return lambda x: x.two_nearest(look.value)
    return lambda x: x.pair(at.reference)[1] - look.value


def coefficient_of(look: Look, at: References, plane: Plane, rough: bool = False) -> Coefficient:
    """The coefficient of a normal form that is looked at, to a few digits with ``rough``; NaN where it is not known."""
    if look.test == "quadratic":
        return _bend(plane, at.plus, rough)
    if look.test == "cubic":
        if isinstance(plane.problem, Adaptive):
            return _of_cycle(plane, "period-doubling")
        return _forms(plane, rough).cubic(-1.0)
    return _lyapunov(plane, at.reference, rough)


def _bend(plane: Plane, null: Null, rough: bool = False) -> Coefficient:
    """The quadratic coefficient of a fold, along the null vector that goes with the reference."""
    v, _ = plane.first.null(null.column, null.row)
    if isinstance(plane.problem, Adaptive):
        return _of_cycle(plane, "fold", along=v)
    found = _forms(plane, rough).quadratic(v)
    if found.error <= NORMAL_FORMS.unsure * found.size or (rough and found.error < abs(found.value)):
        return found  # of a rough one the sign is enough
    return _bend(plane, null) if rough else UNKNOWN


def _forms(plane: Plane, rough: bool = False) -> Forms:
    place = plane.place
    return Forms(plane.locus.at(place.q), place.u, place.p, rough)


def critical_eigenvalue(forms: Forms) -> complex | None:
    """The eigenvalue of a flow nearest to the imaginary axis, of those with positive imaginary part."""
    upper = forms.eigenvalues[forms.eigenvalues.imag > 0.0]
    return complex(upper[np.argmin(np.abs(upper.real))]) if len(upper) else None


def _lyapunov(plane: Plane, reference: float, rough: bool = False) -> Coefficient:
    place = plane.pair(reference)[1]
    if plane.flow:
        if place <= 0.0:
            return UNKNOWN
        forms = _forms(plane, rough)
        critical = critical_eigenvalue(forms)
        return UNKNOWN if critical is None else forms.lyapunov(critical)[0]
    if abs(place) >= 1.0:
        return UNKNOWN
    multiplier = complex(place, np.sqrt(1.0 - place * place))
    if isinstance(plane.problem, Adaptive):
        return _of_cycle(plane, "neimark-sacker", multiplier)
    return _forms(plane, rough).lyapunov(multiplier)[0]


def _of_cycle(
    plane: Plane, kind: str, multiplier: complex = -1.0, along: np.ndarray | None = None
) -> Coefficient:
    """The form of a cycle from the equations on its mesh, which cost less than its return map."""
    place = plane.place
    found = on_mesh(plane.locus.at(place.q)).normal_form(kind, place.u, place.p, multiplier, along)
    return UNKNOWN if found is None else Coefficient(found[0], 0.0, found[1])
