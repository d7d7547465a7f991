"""Points of codimension two on a locus: zeros of test functions along it, located like special points on branches.

One loop evaluates all test functions; they are listed in :mod:`contvines.loci.sought`. Also: the points at which a locus begins or ends because its
motion becomes an equilibrium, a shorter motion or a symmetric one.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from ..bifurcation.kinds import CODIMENSION_TWO
from ..bifurcation.locate import Segment, locate
from ..bifurcation.normal_forms.coefficients import Forms, ReturnForms, forms_at
from ..bifurcation.normal_forms.critical import normal_form
from ..bifurcation.scan import image_of
from ..bifurcation.settings import LOCATING
from ..continuation.engine import Engine, Solved
from ..continuation.settings import Settings
from ..flows.cycles import CycleProblem
from ..long_work import listening
from ..problems.abilities import Adaptive
from ..problems.protocol import Problem
from ..shared.numbers import ROUNDED
from .adaptive import on_mesh
from .kernels import FLIP, FOLD, MARGIN, PAIR, PERIOD
from .linear import Linearisation, critical_first
from .locus import Locus, PlanePoint
from .plane import Place, Plane
from .problem import LocusProblem
from .settings import PLACES, VANISHING
from .sought import TOUCHING, References, Sought, Test, borders, sought, vanishing_margins
from .starts import Candidate, begin, first_point

FEW = 4  # points of a border's locus at which its equations are tested for being singular
# ratio of the squared sizes of two cycles from which the point at which they vanish is extrapolated
SIZE_RATIO = 2.0
REACH = 0.02  # distance (in the metric) on either side of a locus's end between which the parent motion's point is searched
FREQUENCY_KNOWN = ("bogdanov-takens", "resonance-1-1", "resonance-1-2", "resonance-1-3", "resonance-1-4")
"""Kinds that determine the critical pair's position, so that no angle or frequency is given; rounding may split a double zero into a pair."""

Interval = tuple[float, float]
Found = tuple[int, PlanePoint]


# ------------------------------------------------------------------ the points of a locus
@listening()
def mark_locus(locus: Locus) -> tuple[Found, ...]:
    """Find the points of codimension two on a locus that is not part of a chart.

    Parameters
    ----------
    locus : Locus

    Returns
    -------
    tuple of (int, PlanePoint)
        Each point with the index of the locus's point before it. Labels are numbered along the locus, separately for each kind.
    """
    numbers = Counter[str]()

    def label(prefix: str) -> str:
        numbers[prefix] += 1
        return f"{prefix}{numbers[prefix]}"

    return mark(locus, {}, label, same_point)


def mark(
    locus: Locus,
    points: dict[str, PlanePoint],
    label: Callable[[str], str],
    same: Callable[[PlanePoint, PlanePoint], bool],
) -> tuple[Found, ...]:
    """Find the points of codimension two on a locus, and add the new ones, with labels and coefficients, to the known points.

    Parameters
    ----------
    locus : Locus
    points : dict of PlanePoint
        Known points by label; extended in place.
    label : callable
        prefix -> next label with this prefix.
    same : callable
        (PlanePoint, PlanePoint) -> whether they are equal.

    Returns
    -------
    tuple of (int, PlanePoint)
        All points on the locus, each with the index of the locus's point before it.
    """
    by_name, marked = {kind.name: kind for kind in locus.kinds}, dict[str, Found]()
    for index, point in find(locus):
        before = next((other for other in points.values() if same(point, other)), None)
        if before is None:
            point.label = label((by_name.get(point.kind) or CODIMENSION_TWO[point.kind]).label)
            point.coefficients = point.coefficients or coefficients(point)
            before = points[point.label] = point
        if locus.label not in before.on:
            before.on.append(locus.label)
        marked.setdefault(before.label, (index, before))
    return tuple(marked.values())


def find(locus: Locus) -> list[Found]:
    """Find the points of codimension two on a locus, each with the index of the locus's point before it; labels are empty."""
    problem, branch = locus.problem, locus.branch
    if problem is None:
        return []
    points = without_rows(branch.points, branch.values, branch.tangents)
    if problem.condition == PERIOD or (problem.condition == MARGIN and _singular(problem, points)):
        return []  # the tests are meaningless where the equations are singular all along the locus
    ends = (0, points[0]), (len(points) - 1, points[-1])
    at_ends = [(index, beginning(problem, end, locus.within)) for index, end in ends]
    beginnings = [(index, point) for index, point in at_ends if point is not None]
    found: list[Found] = []
    for index, point in _zeros(problem, points, locus.within, list(sought(problem, locus.kinds))):
        # where the motions are born, further multipliers may be critical, and tests nearly vanish without being points
        begins = any(_at_one_place(point, other, PLACES.end) for _, other in beginnings)
        if not begins and not any(same_point(point, other) for _, other in found):
            found.append((index, point))
    return sorted([*found, *beginnings], key=lambda pair: pair[0])


def without_rows(points: np.ndarray, values: np.ndarray, tangents: np.ndarray) -> list[Solved]:
    """Wrap arrays of points as `Solved`, without rows."""
    rest = np.zeros(0), 0.0, 0.0, 0.0
    return [Solved(u, float(q), tangent, *rest) for u, q, tangent in zip(points, values, tangents)]


def _singular(problem: LocusProblem, points: Sequence[Solved]) -> bool:
    """Whether the equations are singular at a few points of a border, and so at all of them."""
    plane = Plane(problem)
    few = [_place(problem, point) for point in points[:: max(1, len(points) // FEW)]]
    tests = [abs(plane.null_vectors().test) for place in few if plane.to(place)]
    return bool(tests) and float(np.median(tests)) < VANISHING.singular


def _place(problem: LocusProblem, point: Solved) -> Place:
    u, p = problem.split(point.u)
    return Place(u, float(p), float(point.p))


def same_point(one: PlanePoint, other: PlanePoint) -> bool:
    """Whether two points of one locus are equal: the same kind at the same place."""
    return one.kind == other.kind and _at_one_place(one, other)


def _at_one_place(one: PlanePoint, other: PlanePoint, near: float = PLACES.same) -> bool:
    return all(abs(a - b) <= near * (1.0 + abs(a)) for a, b in zip(one.value, other.value))


# ------------------------------------------------------------------ one loop
def _zeros(
    problem: LocusProblem, points: Sequence[Solved], within: Interval, wanted: Sequence[Sought]
) -> Iterator[Found]:
    """Generate the verified zeros of the tests between points of a locus, each with the index of the point before it."""
    plane, last = Plane(problem), len(points) - 2
    places = [_place(problem, point) for point in points]
    references: list[References | None] = []
    for place in places:
        before = references[-1] if references else None
        references.append(References(plane, before) if plane.to(place) else before)
    rough = {each.kind: _by_few_digits(each, plane, places, references) for each in wanted if each.rough}
    for i, (ends, at) in enumerate(zip(pairwise(places), references)):
        if at is None or not plane.to(ends[0]):
            continue
        values = [
            [rough[each.kind][i + k] if each.rough else _value(plane, end, each.test, at) for each in wanted]
            for k, end in enumerate(ends)
        ]
        segment: Segment | None = None
        for each, a, b in zip(wanted, *values):
            root: tuple[Place, float] | None = None
            index = i
            if i == 0 and abs(a) < each.zero:
                root = ends[0], ROUNDED
            elif i == last and abs(b) < each.zero:
                index, root = i + 1, (ends[1], ROUNDED)
            elif (a >= 0.0) != (b >= 0.0) and math.isfinite(a + b):
                segment = segment or _segment(problem, points[i : i + 2], within, at)
                root = _root(plane, segment, each.test, at, abs(a) + abs(b))
            point = None if root is None else _point(each, plane, *root, within)
            if point is not None:
                yield index, point


def _by_few_digits(
    wanted: Sought, plane: Plane, places: Sequence[Place], references: Sequence[References | None]
) -> list[float]:
    """Values of an expensive test at all places: to a few digits, but exact at both ends of every change of sign (repeated, since the exact values may move it)."""

    def value(test: Test | None, j: int) -> float:
        at = references[j]
        return math.nan if at is None or test is None else _value(plane, places[j], test, at)

    values, exact = [value(wanted.rough, j) for j in range(len(places))], set[int]()
    while (
        ends := {
            j for i, (a, b) in enumerate(pairwise(values)) if (a >= 0.0) != (b >= 0.0) for j in (i, i + 1)
        }
        - exact
    ):
        for j in ends:
            values[j] = value(wanted.test, j)
        exact |= ends
    return values


def _value(plane: Plane, place: Place, test: Test, at: References) -> float:
    """Evaluate a test at a place; NaN if it cannot be computed."""
    plane.to(place)
    try:
        return test(plane, at)
    except (ValueError, np.linalg.LinAlgError):
        return math.nan


def _segment(problem: LocusProblem, ends: Sequence[Solved], within: Interval, at: References) -> Segment:
    """A segment of a locus; its equations have the borders and the reference pair of its first point."""
    engine = Engine(problem.bordered_at(*_place(problem, ends[0]), at.reference), within, Settings())
    row = np.zeros(engine.row_size)
    first, last = (end._replace(tangent=engine.unit(end.tangent), row=row) for end in ends)
    return Segment(engine, first, last)


def _root(
    plane: Plane, segment: Segment, test: Test, at: References, size: float
) -> tuple[Place, float] | None:
    """Locate the zero of a test on a segment, with its error; None if the test jumps or has a pole.

    The coefficient of a normal form has a pole where a further multiplier is critical.
    """

    def value(point: Solved) -> float:
        return _value(plane, _place(plane.locus, point), test, at)

    root = None if size < VANISHING.nothing else locate(segment, value, jump=size)
    if root is None or not root.continuous or not abs(value(root.point)) <= VANISHING.zero * size:
        return None
    one, other = (_place(plane.locus, end) for end in (segment.a, segment.b))
    width = LOCATING.bracket * (abs(one.p - other.p) + abs(one.q - other.q))
    return plane.place, max(root.error + width, root.point.correction) / (1.0 + abs(root.point.p)) + ROUNDED


def _point(wanted: Sought, plane: Plane, place: Place, error: float, within: Interval) -> PlanePoint | None:
    """The point of codimension two at a zero; None if it fails the verification, or lies at an end of the interval."""
    plane.to(place)
    low, high = within
    at_end = min(abs(place.q - low), abs(place.q - high)) <= VANISHING.margin * (high - low)
    if at_end or not wanted.verify(plane):
        return None
    locus, problem = plane.locus, plane.locus.at(place.q)
    if isinstance(problem, Adaptive):
        error += problem.accuracy(place.u, place.p)
    return PlanePoint(
        label="",
        kind=wanted.kind,
        parameters=(locus.inner, locus.over),
        value=(place.p, place.q),
        u=place.u,
        coefficients=plane.touching_form() if wanted.kind == TOUCHING else {},
        multipliers=plane.problem.to_multipliers(plane.spectrum),
        real=not bool((plane.margins < -VANISHING.margin).any()),
        error=error,
        residual=plane.largest,
        margins=tuple(sorted(vanishing_margins(plane))),
        problem=problem,
    )


# ------------------------------------------------------------------ coefficients of normal forms
def coefficients(point: PlanePoint) -> dict[str, float]:
    """Return normal form coefficients at a point, by name; empty if the derivatives cannot be computed.

    The normal forms are those of :mod:`contvines.bifurcation.normal_forms.critical`. In addition, "angle" is the angle of the critical pair (over the
    problem's own period) and "omega" its frequency, unless the kind determines them.
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
    """Return the raw multipliers (eigenvalues) on the stability boundary with positive imaginary part, the most critical one first."""
    if forms.flow:
        spectrum = forms.eigenvalues
    elif isinstance(forms, ReturnForms):
        spectrum = forms.spectrum()
    else:
        spectrum = Linearisation(forms.problem).at(forms.u * forms.units, forms.p).spectrum
    unit = (float(np.abs(spectrum).max()) or 1.0) if forms.flow else 1.0
    return [
        complex(z)
        for z in critical_first(spectrum, forms.flow)
        if z.imag > VANISHING.critical * unit
        and (abs(z.real) / unit if forms.flow else abs(abs(z) - 1.0)) < VANISHING.critical
    ]


# ------------------------------------------------------------------ ends at shorter or more symmetric motions
#: condition of a locus -> kinds of the points at which the locus begins, if its cycles are born at equilibria (first table) or at cycles of half the period
FIRST_OF_EQUILIBRIA = {
    FOLD: ("generalized-hopf",),
    PAIR: ("zero-hopf", "double-hopf"),
    FLIP: ("double-hopf",),
}
FIRST_OF_CYCLES = {
    FOLD: ("generalized-period-doubling",),
    PAIR: ("resonance-1-2", "fold-flip", "flip-neimark-sacker"),
}


class Parent(NamedTuple):
    """A more symmetric motion that a motion nearly equals: kind of the special point at which they separate, and its problem and unknowns, if there are any."""

    kind: str
    problem: Problem | None = None
    u: np.ndarray | None = None


def simpler_motion(locus: LocusProblem, place: Place) -> Parent | None:
    """Return the more symmetric motion that the motion at a place of a locus nearly equals; None if there is none."""
    u, p, q = place
    whole = locus.at(q)
    if isinstance(whole, CycleProblem):
        root = whole.root(u, p, VANISHING.loose)
        if root is None:
            return None
        return Parent("hopf" if root[0].spectrum == "flow" else root[0].flip_kind, *root)
    sizes = locus.sizes_at(*place)[:-2]
    for symmetry in whole.symmetries:
        if np.abs((image_of(symmetry, u, p) - u) / sizes).max() < VANISHING.image:
            return Parent(symmetry.kind, *(() if symmetry.root is None else symmetry.root(u)))
    return None


def beginning(
    locus: LocusProblem, end: Solved, within: Interval, simpler: Parent | None = None, ahead: float = 0.0
) -> PlanePoint | None:
    """Find the point of codimension two at which a locus begins or ends because its motion becomes an equilibrium, a shorter or a symmetric motion.

    The equations of the locus are singular there, and its points approach it only to half of the digits. Therefore the point is computed on the locus
    of the other motion.

    Parameters
    ----------
    locus : LocusProblem
    end : Solved
        First or last point of the locus.
    within : (float, float)
        Interval of the second parameter.
    simpler : Parent, optional
        The other motion, if it is known.
    ahead : float
        Estimated distance of the parameters from those of the point.
    """
    place = _place(locus, end)
    simpler, (_, p, q) = simpler or simpler_motion(locus, place), place
    if simpler is None or simpler.problem is None or simpler.u is None:
        return None
    kinds = FIRST_OF_EQUILIBRIA if simpler.problem.spectrum == "flow" else FIRST_OF_CYCLES
    parent = begin(Candidate(simpler.problem, simpler.kind, simpler.u, p, q, ""), locus.over, locus.bounds)
    wanted = [each for each in sought(parent) if each.kind in kinds.get(locus.condition, ())]
    if not isinstance(locus.base, Adaptive):
        wanted += borders(parent)
    engine, start = first_point(parent, simpler.u, p, q, within, Settings())
    if start is None:
        return None
    reach = REACH + 2.0 * ahead / float(np.linalg.norm(start.tangent[-2:]))
    around = [engine.beside(start, step) for step in (-reach, reach)]
    points = [point for point in around if point is not None]
    if len(points) < 2:
        return None
    found = [point for _, point in _zeros(parent, points, within, wanted)]
    return min(found, key=lambda point: abs(point.value[0] - p) + abs(point.value[1] - q), default=None)


def vanishing(locus: LocusProblem, ends: Sequence[Solved], within: Interval) -> PlanePoint | None:
    """Find the point of codimension two at which the cycles of a locus shrink to an equilibrium, from its last points.

    The equations become singular with a high order of the cycles' size, so that Newton's method fails before. Since the squared size is
    proportional to the distance of the parameters from the point, the point is extrapolated.
    """
    problem = on_mesh(locus.base)
    last = _place(locus, ends[-1])
    mean, size = problem.center(last.u)
    places = (_place(locus, end) for end in reversed(ends))
    before = next((one for one in places if problem.center(one.u)[1] > SIZE_RATIO * size), None)
    if before is None or not problem.free_period:
        return None
    behind = np.subtract(last[1:], before[1:])
    ahead = behind * size / (problem.center(before.u)[1] - size)
    rest = on_mesh(locus.at(last.q)).root(problem.resting(last.u, mean), last.p)
    if rest is None:
        return None
    found = beginning(locus, ends[-1], within, Parent("hopf", *rest), float(np.abs(behind).max()))
    missed = np.inf if found is None else np.abs(np.subtract(found.value, last[1:]) - ahead).max()
    return found if missed <= np.abs(behind).max() else None  # the smallest cycles have few accurate digits
