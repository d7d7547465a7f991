"""What is looked for along a locus: points of codimension two, each the zero of a test in the plane of two parameters."""

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
    """Borders and positions that belong to one point of a locus, held fixed while tests are compared and solved.

    Parameters
    ----------
    plane : Plane
        At the point.
    near : References, optional
        Of a neighbour.
    """

    def __init__(self, plane: Plane, near: References | None = None) -> None:
        problem = plane.problem
        self.plus: Null = plane.null_vectors(near=None if near is None else near.plus)
        # without a flip the unknowns hold no perturbations that could change sign over the period
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
    """A kind of point that is looked for along a locus.

    Attributes
    ----------
    kind : str
    test : callable
        (plane, references) -> number, at the place of the plane; NaN where it cannot be told.
    verify : callable
        Whether a zero, at which a plane is, is of this kind.
    rough : callable or None
        The test to a few digits, where the test itself is costly.
    zero : float
        What counts as zero at an end of the locus, where the test may vanish without a change of its sign.
    """

    kind: str
    test: Test
    verify: Callable[[Plane], bool]
    rough: Test | None = None
    zero: float = 0.0


def sought(locus: LocusProblem, kinds: Sequence[Kind] = ()) -> Iterator[Sought]:
    """All that is looked for along a locus; of the condition of a user's kind nothing is known, but users' tests are asked."""
    if locus.condition != OWN:
        yield from _multipliers(locus)
        yield from borders(locus)
    for own in kinds:
        yield Sought(own.name, partial(_of_own_test, own), partial(_of_own_kind, own))


def _multipliers(locus: LocusProblem) -> Iterator[Sought]:
    """Where the normal form degenerates, or one more multiplier is critical; at no border but that of the locus itself."""
    problem, condition, m = locus.base, locus.condition, locus.n_multipliers
    half, flow = problem.flip_kind == "symmetry-breaking", problem.spectrum == "flow"
    turn = "symmetry-breaking" if half else "flip"
    pairs = m >= (2 if condition in (MARGIN, PAIR) else 3)
    none = problem.spectrum == "none"

    def look(kind: str, test: Test, zero: float = 0.0) -> Sought:
        return Sought(kind, test, partial(_inside, kind), zero=zero)

    def coefficient(kind: str, of: NormalForm) -> Sought:
        return Sought(kind, partial(_exact, of), partial(_inside, kind), partial(_few_digits, of))

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
        yield look(TOUCHING, _touch)
        if not flow and not none:
            yield look(f"border-{turn}", _minus)
        if pairs and not none:
            yield look("border-neimark-sacker", _pair)


def _resonances(half: bool) -> list[tuple[str, float]]:
    """Strong resonances by the cosine of the raw angle; on half maps the multipliers of the full period are squares."""
    root = 0.5**0.5
    cosines = (
        ((1.0, -1.0), (0.0,), (0.5, -0.5), (root, -root)) if half else ((1.0,), (-1.0,), (-0.5,), (0.0,))
    )
    return [(f"resonance-1-{n}", c) for n, both in enumerate(cosines, 1) for c in both]


def borders(locus: LocusProblem) -> Iterator[Sought]:
    """Where one more margin vanishes."""
    kind = {FLIP: "border-flip", PAIR: "border-neimark-sacker", MARGIN: "double-border"}.get(
        locus.condition, "border-fold"
    )
    if locus.condition == FLIP and locus.base.flip_kind == "symmetry-breaking":
        kind = "border-symmetry-breaking"
    for j in set(range(int(locus.base.n_margins))) - set(locus.masked):
        yield Sought(kind, partial(_margin, j), partial(holds, kind), zero=VANISHING.margin)


# ------------------------------------------------------------------ whether a zero is of its kind
#: kind -> critical pairs of multipliers
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
    """Whether the multipliers at a solution are those that the name of the point says."""
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
    return holds(kind, plane) and vanishing_margins(plane) <= set(plane.locus.masked)


def vanishing_margins(plane: Plane) -> set[int]:
    """Places of the margins that are zero."""
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
    """g of F_u with given borders."""
    return plane.null(at.plus.column, at.plus.row)[1]


def _minus(plane: Plane, at: References) -> float:
    """g of the flipped F_u."""
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
    """Sum of the two multipliers nearest to a place of the real axis, less twice that place."""
    spectrum = plane.spectrum
    nearest = spectrum[np.argsort(np.abs(spectrum - value), kind="stable")[:2]]
    return float(np.real(np.sum(nearest)) - 2.0 * value)


def _touch(plane: Plane, at: References) -> float:
    return plane.slope_along_branch(at.plus)


# ------------------------------------------------------------------ tests that are coefficients of normal forms
class NormalForm(Protocol):
    """The coefficient of a normal form at the place of a plane, to a few digits with `rough`; NaN where it is not known."""

    def __call__(self, plane: Plane, at: References, rough: bool = False) -> Coefficient: ...


def _exact(form: NormalForm, plane: Plane, at: References) -> float:
    return form(plane, at).value


def _few_digits(form: NormalForm, plane: Plane, at: References) -> float:
    """A coefficient; where its terms cancel it is zero, not the rounding that is left of them."""
    found = form(plane, at, rough=True)
    return 0.0 if abs(found.value) <= VANISHING.zero * found.size else found.value


def _quadratic(plane: Plane, at: References, rough: bool = False) -> Coefficient:
    """The quadratic coefficient of a fold, along the null vector that goes with the reference."""
    v, _ = plane.null(at.plus.column, at.plus.row)
    if isinstance(plane.problem, Adaptive):
        return _of_cycle(plane, "fold", along=v)
    found = _forms(plane, rough).quadratic(v)
    if found.error <= NORMAL_FORMS.unsure * found.size or (rough and found.error < abs(found.value)):
        return found  # of a rough one the sign is enough
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
    """The form of a cycle from the equations on its mesh, which cost less than its return map."""
    u, p, q = plane.place
    found = on_mesh(plane.locus.at(q)).normal_form(kind, u, p, multiplier, along)
    return UNKNOWN if found is None else Coefficient(found[0], 0.0, found[1])
