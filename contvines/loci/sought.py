"""Kinds of points of codimension two that are searched along a locus, each the zero of a test function."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import NamedTuple, Protocol

import numpy as np

from ..bifurcation.kind import Kind, number_of, verified
from ..bifurcation.normal_forms.coefficients import Coefficient, Forms
from ..bifurcation.settings import NORMAL_FORMS
from ..problems.abilities import Adaptive
from .adaptive import on_mesh
from .kernels import BRANCH, FLIP, FOLD, MARGIN, OWN, PAIR
from .linear import Null, critical_first
from .plane import Plane
from .problem import LocusProblem, PointOfLocus
from .settings import VANISHING

UNKNOWN = Coefficient(np.nan, np.inf)
TOUCHING = "degenerate-border"  # its test is the derivative of the margin along the branch


class References:
    """Null vectors and positions of pairs at one point of a locus; they are held fixed on the following segment, so that tests are smooth.

    Parameters
    ----------
    plane : Plane
        The plane at the point.
    near : References, optional
        References of a neighbouring point.
    """

    def __init__(self, plane: Plane, near: References | None = None) -> None:
        problem = plane.problem
        self.plus: Null = plane.null_vectors(near=None if near is None else near.plus)
        # without a flip kernel there are no perturbations that change sign over the period
        flips = problem.spectrum == "map" and not problem.movable and problem.kernels.flip is not None
        before = None if near is None else near.minus
        self.minus: Null | None = plane.null_vectors(True, before) if flips else None
        self.reference, self.second = plane.locus.reference, np.nan
        if plane.m >= 2:
            first, second, *_ = [*plane.positions(), np.nan, np.nan]
            self.reference = plane.pair(self.reference if np.isnan(first) else float(first))[1]
            self.second = float(second)


Test = Callable[[Plane, References], float]


class Sought(NamedTuple):
    """A kind of point that is searched along a locus.

    Attributes
    ----------
    kind : str
    test : callable
        (plane, references) -> number at the current place of the plane; NaN if it cannot be computed.
    verify : callable
        (plane) -> whether a zero at the current place is of this kind.
    rough : callable or None
        The test to a few digits, if the test itself is expensive.
    zero : float
        Tolerance of zeros at the ends of the locus, where the test may vanish without a change of sign.
    """

    kind: str
    test: Test
    verify: Callable[[Plane], bool]
    rough: Test | None = None
    zero: float = 0.0


def sought(locus: LocusProblem, kinds: Sequence[Kind] = ()) -> Iterator[Sought]:
    """Generate all kinds that are searched along a locus; along a locus of a user-defined kind only users' tests."""
    if locus.condition != OWN:
        yield from _multipliers(locus)
        yield from borders(locus)
    for kind in kinds:
        yield Sought(kind.name, partial(_of_own_test, kind), partial(_of_own_kind, kind))


def _multipliers(locus: LocusProblem) -> Iterator[Sought]:
    """Generate points at which the normal form degenerates, or at which a further multiplier is critical."""
    problem, condition, m = locus.base, locus.condition, locus.n_multipliers
    half, flow = problem.flip_kind == "symmetry-breaking", problem.spectrum == "flow"
    turn = "symmetry-breaking" if half else "flip"
    pairs = m >= (2 if condition in (MARGIN, PAIR) else 3)
    none = problem.spectrum == "none"

    def look(kind: str, test: Test, zero: float = 0.0) -> Sought:
        return Sought(kind, test, partial(_inside, kind), zero=zero)

    def coefficient(kind: str, form: NormalForm) -> Sought:
        return Sought(kind, partial(_exact, form), partial(_inside, kind), partial(_few_digits, form))

    if condition == FOLD:
        yield coefficient("cusp", _quadratic)
    if condition in (FOLD, BRANCH) and m >= 2 and not none:
        double = partial(_double, 0.0 if flow else 1.0)
        yield look("bogdanov-takens" if flow else "resonance-1-1", double)
        if pairs:
            yield look("zero-hopf" if flow else "fold-neimark-sacker", _pair)
        if not flow:
            yield look(f"fold-{turn}", _minus)
    if condition == FLIP:
        yield coefficient("degenerate-symmetry-breaking" if half else "generalized-period-doubling", _cubic)
        if m >= 2:
            yield look("resonance-1-1" if half else "resonance-1-2", partial(_double, -1.0))
            yield look(f"fold-{turn}", _plus)
        if pairs:
            yield look(f"{turn}-neimark-sacker", _pair)
    if condition == PAIR:
        yield coefficient("generalized-hopf" if flow else "chenciner", _lyapunov)
        for kind, cosine in [("bogdanov-takens", 0.0)] if flow else _resonances(half):
            yield look(kind, partial(_angle, cosine), VANISHING.margin)
        if m >= 3:
            yield look("zero-hopf" if flow else "fold-neimark-sacker", _plus)
            if not flow:
                yield look(f"{turn}-neimark-sacker", _minus)
        if m >= 4:
            yield look("double-hopf" if flow else "double-neimark-sacker", _second_pair)
    if condition == MARGIN:
        yield look("border-fold", _plus)
        yield look(TOUCHING, _margin_slope)
        if not flow and not none:
            yield look(f"border-{turn}", _minus)
        if pairs and not none:
            yield look("border-neimark-sacker", _pair)


def _resonances(half: bool) -> list[tuple[str, float]]:
    """Kinds of strong resonances and the cosines of their raw angles; for half-period maps the multipliers of the full period are the squares."""
    root = 0.5**0.5
    cosines = (
        ((1.0, -1.0), (0.0,), (0.5, -0.5), (root, -root)) if half else ((1.0,), (-1.0,), (-0.5,), (0.0,))
    )
    return [(f"resonance-1-{n}", c) for n, pair in enumerate(cosines, 1) for c in pair]


def borders(locus: LocusProblem) -> Iterator[Sought]:
    """Generate points at which a further margin vanishes."""
    kind = {FLIP: "border-flip", PAIR: "border-neimark-sacker", MARGIN: "double-border"}.get(
        locus.condition, "border-fold"
    )
    if locus.condition == FLIP and locus.base.flip_kind == "symmetry-breaking":
        kind = "border-symmetry-breaking"
    for j in set(range(int(locus.base.n_margins))) - set(locus.masked):
        yield Sought(kind, partial(_margin, j), partial(holds, kind), zero=VANISHING.margin)


# ------------------------------------------------------------------ verification of zeros
#: kind -> number of critical pairs of multipliers
PAIRS = {
    "zero-hopf": 1,
    "fold-neimark-sacker": 1,
    "flip-neimark-sacker": 1,
    "symmetry-breaking-neimark-sacker": 1,
    "border-neimark-sacker": 1,
    "double-hopf": 2,
    "double-neimark-sacker": 2,
}


def holds(kind: str, plane: Plane) -> bool:
    """Whether the multipliers at the current place are those of the kind."""
    spectrum = plane.spectrum
    if not plane.m:
        return True
    edge = np.abs(spectrum.real) if plane.flow else np.abs(np.abs(spectrum) - 1.0)
    pairs = int(np.sum((edge < VANISHING.critical) & (spectrum.imag > VANISHING.critical)))
    if kind in PAIRS:
        return pairs >= PAIRS[kind]
    doubles = {
        "bogdanov-takens": (0.0,),
        "resonance-1-1": (1.0, -1.0) if plane.problem.flip_kind == "symmetry-breaking" else (1.0,),
        "resonance-1-2": () if plane.problem.flip_kind == "symmetry-breaking" else (-1.0,),
    }.get(kind, ())
    return not doubles or any(
        int(np.sum(np.abs(spectrum - place) < VANISHING.double)) >= 2 for place in doubles
    )


def _inside(kind: str, plane: Plane) -> bool:
    """Whether the multipliers are those of the kind, and no margin vanishes except that of the locus."""
    return holds(kind, plane) and vanishing_margins(plane) <= set(plane.locus.masked)


def vanishing_margins(plane: Plane) -> set[int]:
    """Return the indices of the margins that vanish at the current place."""
    return set(np.flatnonzero(np.abs(plane.margins) < VANISHING.margin).tolist())


def _of_own_kind(kind: Kind, plane: Plane) -> bool:
    return verified(kind, _point(plane))


def _point(plane: Plane) -> PointOfLocus:
    return PointOfLocus(plane.locus, plane.problem, *plane.place, plane.row)


# ------------------------------------------------------------------ tests
def _of_own_test(kind: Kind, plane: Plane, at: References) -> float:
    return number_of(kind, "test", _point(plane))


def _margin(j: int, plane: Plane, at: References) -> float:
    return float(plane.margins[j])


def _plus(plane: Plane, at: References) -> float:
    """g of F_u: zero if a multiplier is 1 (an eigenvalue 0)."""
    return plane.null(at.plus.column, at.plus.row)[1]


def _minus(plane: Plane, at: References) -> float:
    """g of the flipped F_u: zero if a multiplier is -1."""
    if at.minus is None:
        return np.nan
    with plane.flipped():
        return plane.null(at.minus.column, at.minus.row)[1]


def _pair(plane: Plane, at: References) -> float:
    return plane.pair(at.reference)[0]


def _second_pair(plane: Plane, at: References) -> float:
    return np.nan if np.isnan(at.second) else plane.other_pair(at.reference, at.second)


def _angle(cosine: float, plane: Plane, at: References) -> float:
    return plane.pair(at.reference)[1] - cosine


def _double(value: float, plane: Plane, at: References) -> float:
    """Sum of the two multipliers nearest to a real value, minus twice that value."""
    spectrum = plane.spectrum
    nearest = spectrum[np.argsort(np.abs(spectrum - value), kind="stable")[:2]]
    return float(np.real(np.sum(nearest)) - 2.0 * value)


def _margin_slope(plane: Plane, at: References) -> float:
    return plane.slope_along_branch(at.plus)


# ------------------------------------------------------------------ tests by normal form coefficients
class NormalForm(Protocol):
    """Coefficient of a normal form at the current place of a plane, to a few digits with `rough`; NaN if it is unknown."""

    def __call__(self, plane: Plane, at: References, rough: bool = False) -> Coefficient: ...


def _exact(form: NormalForm, plane: Plane, at: References) -> float:
    return form(plane, at).value


def _few_digits(form: NormalForm, plane: Plane, at: References) -> float:
    """A coefficient to a few digits; zero if its terms cancel up to rounding."""
    found = form(plane, at, rough=True)
    return 0.0 if abs(found.value) <= VANISHING.zero * found.size else found.value


def _quadratic(plane: Plane, at: References, rough: bool = False) -> Coefficient:
    """The quadratic coefficient of a fold, with the null vector oriented by the reference."""
    v, _ = plane.null(at.plus.column, at.plus.row)
    if isinstance(plane.problem, Adaptive):
        return _of_cycle(plane, "fold", along=v)
    found = _forms(plane, rough).quadratic(v)
    if found.error <= NORMAL_FORMS.unsure * found.size or (rough and found.error < abs(found.value)):
        return found  # with `rough` a certain sign is enough
    return _quadratic(plane, at) if rough else UNKNOWN


def _cubic(plane: Plane, at: References, rough: bool = False) -> Coefficient:
    if isinstance(plane.problem, Adaptive):
        return _of_cycle(plane, "period-doubling")
    return _forms(plane, rough).cubic(-1.0)


def _lyapunov(plane: Plane, at: References, rough: bool = False) -> Coefficient:
    place = plane.pair(at.reference)[1]
    if place <= 0.0 if plane.flow else abs(place) >= 1.0:
        return UNKNOWN
    if plane.flow:
        forms = _forms(plane, rough)
        pairs = critical_first(forms.eigenvalues, True)
        return forms.lyapunov(complex(pairs[0]))[0] if len(pairs) else UNKNOWN
    multiplier = complex(place, np.sqrt(1.0 - place * place))
    if isinstance(plane.problem, Adaptive):
        return _of_cycle(plane, "neimark-sacker", multiplier)
    return _forms(plane, rough).lyapunov(multiplier)[0]


def _forms(plane: Plane, rough: bool) -> Forms:
    u, p, q = plane.place
    return Forms(plane.locus.at(q), u, p, rough)


def _of_cycle(
    plane: Plane, kind: str, multiplier: complex = -1.0, along: np.ndarray | None = None
) -> Coefficient:
    """Normal form coefficient of a cycle from its collocation equations, which are cheaper than its return map."""
    u, p, q = plane.place
    found = on_mesh(plane.locus.at(q)).normal_form(kind, u, p, multiplier, along)
    return UNKNOWN if found is None else Coefficient(found[0], 0.0, found[1])
