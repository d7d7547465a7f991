"""Points of codimension two on a locus: zeros of tests along it, located as special points on branches are.

All kinds are asked in one loop: those that :func:`contvines.loci.kinds.looks` names for the locus, its borders, and the user's own.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from ..bifurcation.kind import Kind
from ..bifurcation.kind_answers import verified
from ..bifurcation.locate import locate
from ..bifurcation.segment import Segment
from ..bifurcation.settings import LOCATING
from ..bifurcation.symmetry_test import image_of
from ..continuation.engine import Engine, Solved
from ..continuation.settings import Settings
from ..flows.cycles import CycleProblem
from ..problems.abilities import Adaptive
from ..problems.protocol import Problem
from ..shared.floating_point import ROUNDED
from .conditions import COEFFICIENTS, References, Test, coefficient_of, test_of
from .kinds import TOUCH, Look, looks
from .layout import FLIP, FOLD, MARGIN, OWN, PAIR, PERIOD
from .locus import Locus
from .on_mesh import on_mesh
from .own_test import of_plane, tested
from .plane import Place, Plane
from .plane_point import PlanePoint
from .problem import LocusProblem
from .settings import PLACES, VANISHING
from .starts import begin, first_point
from .touching import touching_form

FEW = 4  # places at which a border is asked whether its equations are singular
SHRINKS = 2.0  # ratio of squares of sizes over which cycles are seen to shrink
BESIDE = 0.02  # distance (in the metric) on either side at which its point of codimension two is sought

Found = tuple[int, PlanePoint]


class Sought(NamedTuple):
    """A kind of point that is looked for along a locus.

    Attributes
    ----------
    kind : str
    test : callable
        The test, with the references of a point of the locus; None where it cannot be asked.
    verify : callable
        Whether a zero, at which a plane is, is of this kind.
    rough : callable or None
        The test to a few digits, at the place of a plane, where the test itself is costly.
    zero : float
        What counts as zero at an end of the locus, where the test may vanish without a change of its sign.
    """

    kind: str
    test: Callable[[References], Test | None]
    verify: Callable[[Plane], bool]
    rough: Callable[[Plane, References], float] | None = None
    zero: float = 0.0


def find(locus: Locus) -> list[Found]:
    """The points of codimension two on a locus, each with the index of the point before it; labels are left empty."""
    branch = locus.branch
    points = [
        Solved(u, float(q), tangent, np.zeros(0), 0.0, 0.0, 0.0)
        for u, q, tangent in zip(branch.points, branch.values, branch.tangents)
    ]
    problem = locus.problem
    if problem is None:
        return []
    if problem.condition == PERIOD or (problem.condition == MARGIN and _singular(problem, points)):
        return []  # nothing can be told from equations that are singular all along
    ends = (0, points[0]), (len(points) - 1, points[-1])
    both = [(index, beginning(problem, end, locus.within)) for index, end in ends]
    born = [(index, point) for index, point in both if point is not None]
    found: list[Found] = []
    for index, point in _zeros(problem, points, locus.within, list(_sought(problem, locus.kinds))):
        # where cycles begin other multipliers may be critical, too, and tests are all but zero
        begins = any(_at_one_place(point, other, PLACES.end) for _, other in born)
        if not begins and not any(same_point(point, other) for _, other in found):
            found.append((index, point))
    return sorted([*found, *born], key=lambda pair: pair[0])


def _singular(problem: LocusProblem, points: Sequence[Solved]) -> bool:
    """Whether the equations are singular at a few points of a border, and so at all of them."""
    plane = Plane(problem)
    few = [_place(problem, point) for point in points[:: max(1, len(points) // FEW)]]
    tests = [abs(plane.first.null_vectors().test) for place in few if math.isfinite(plane.at(place))]
    return bool(tests) and float(np.median(tests)) < VANISHING.singular


def _place(problem: LocusProblem, point: Solved) -> Place:
    u, p = problem.split(point.u)
    return Place(u, float(p), float(point.p))


# ------------------------------------------------------------------ what is looked for
def _sought(problem: LocusProblem, kinds: Sequence[Kind]) -> Iterator[Sought]:
    """All that is looked for along a locus."""
    for look in looks(problem.base, problem.condition):
        yield _of_look(look, problem)
    yield from _borders(problem)
    for own in kinds:
        test = partial(tested, own)
        yield Sought(own.name, lambda at, test=test: test, partial(_of_own, own))


def _of_look(look: Look, problem: LocusProblem) -> Sought:
    rough = partial(_few_digits, look) if look.test in COEFFICIENTS else None
    verify = partial(_inside, look.kind, frozenset(problem.masked))
    return Sought(
        look.kind,
        partial(test_of, look, problem),
        verify,
        rough,
        VANISHING.margin if look.test == "angle" else 0.0,
    )


def _borders(problem: LocusProblem) -> Iterator[Sought]:
    """One more margin that vanishes; of the condition of a user's kind nothing is known."""
    if problem.condition == OWN:
        return
    kind = BORDER_KINDS.get(problem.condition, "border-fold")
    if problem.condition == FLIP and problem.base.flip_kind == "symmetry-breaking":
        kind = "border-symmetry-breaking"
    for j in set(range(int(problem.base.n_margins))) - set(problem.masked):
        yield Sought(
            kind, lambda at, j=j: partial(_margin, j=j), partial(_holds, kind), None, VANISHING.margin
        )


def _margin(plane: Plane, j: int) -> float:
    return float(plane.row[2 * plane.m + j])


def _few_digits(look: Look, plane: Plane, at: References) -> float:
    """A coefficient; where its terms cancel it is zero, not the rounding that is left of them."""
    found = coefficient_of(look, at, plane, rough=True)
    return 0.0 if abs(found.value) <= VANISHING.zero * found.size else found.value


def _of_own(kind: Kind, plane: Plane) -> bool:
    point = of_plane(plane)
    return verified(kind, point, point.place)


def _inside(kind: str, masked: frozenset[int], plane: Plane) -> bool:
    """Whether the multipliers are those of a kind, at no border but that of the locus itself."""
    return _holds(kind, plane) and _vanishing(plane) <= masked


def _vanishing(plane: Plane) -> set[int]:
    return set(np.flatnonzero(np.abs(plane.row[2 * plane.m :]) < VANISHING.margin).tolist())


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


def _holds(kind: str, plane: Plane) -> bool:
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


BORDER_KINDS = {
    FOLD: "border-fold",
    FLIP: "border-flip",
    PAIR: "border-neimark-sacker",
    MARGIN: "double-border",
}


# ------------------------------------------------------------------ one loop
def _zeros(
    problem: LocusProblem, points: Sequence[Solved], within: tuple[float, float], wanted: Sequence[Sought]
) -> Iterator[Found]:
    """The zeros of tests between points of a locus that are what is looked for, each with the index of the point before it."""
    plane, last = Plane(problem), len(points) - 2
    places = [_place(problem, point) for point in points]
    beside: list[References | None] = []
    for place in places:
        before = beside[-1] if beside else None
        finite = math.isfinite(plane.at(place))
        beside.append(References(plane, problem, before) if finite else before)
    rough = {
        sought.kind: [_roughly(sought.rough, plane, *pair) for pair in zip(places, beside)]
        for sought in wanted
        if sought.rough is not None
    }
    for sought in wanted:
        if sought.rough is not None:
            _sharpen(rough[sought.kind], sought, plane, places, beside)
    for i, (ends, at) in enumerate(zip(pairwise(places), beside)):
        if at is None or not math.isfinite(plane.at(ends[0])):
            continue
        tests = [(sought, test) for sought in wanted if (test := sought.test(at)) is not None]
        values = [
            [rough[s.kind][i + k] if s.rough else _value(plane, end, test) for s, test in tests]
            for k, end in enumerate(ends)
        ]
        segment: Segment | None = None
        for (sought, test), a, b in zip(tests, *values):
            root: tuple[Place, float] | None = None
            index = i
            if i == 0 and abs(a) < sought.zero:
                root = ends[0], ROUNDED
            elif i == last and abs(b) < sought.zero:
                index, root = i + 1, (ends[1], ROUNDED)
            elif (a >= 0.0) != (b >= 0.0) and math.isfinite(a + b):
                segment = segment or _segment(problem, points[i : i + 2], within, at)
                root = _root(plane, segment, test, abs(a) + abs(b))
            point = None if root is None else _point(sought, plane, *root, within)
            if point is not None:
                yield index, point


def _roughly(
    rough: Callable[[Plane, References], float], plane: Plane, place: Place, at: References | None
) -> float:
    return math.nan if at is None else _value(plane, place, lambda x: rough(x, at))


def _sharpen(
    values: list[float],
    sought: Sought,
    plane: Plane,
    places: Sequence[Place],
    beside: Sequence[References | None],
) -> None:
    """Replace rough values by exact ones at both ends of each change of sign, which may then lie between the next two points."""
    exact: set[int] = set()
    while (
        ends := {
            j for i, (a, b) in enumerate(pairwise(values)) if (a >= 0.0) != (b >= 0.0) for j in (i, i + 1)
        }
        - exact
    ):
        for j in ends:
            at = beside[j]
            test = None if at is None else sought.test(at)
            if test is not None:
                values[j] = _value(plane, places[j], test)
        exact |= ends


def _value(plane: Plane, place: Place, test: Test) -> float:
    """A test at a place; NaN where it cannot be computed."""
    plane.at(place)
    try:
        return test(plane)
    except (ValueError, np.linalg.LinAlgError):
        return math.nan


def _segment(
    problem: LocusProblem, ends: Sequence[Solved], within: tuple[float, float], at: References
) -> Segment:
    """A segment of a locus, its equations with the borders and the pair that belong to its beginning."""
    engine = Engine(problem.bordered_at(*_place(problem, ends[0]), at.reference), within, Settings())
    row = np.zeros(engine.row_size)
    first, last = (end._replace(tangent=engine.unit(end.tangent), row=row) for end in ends)
    return Segment(engine, first, last)


def _root(plane: Plane, segment: Segment, test: Test, size: float) -> tuple[Place, float] | None:
    """Where a test vanishes on a segment, with the error; None where it jumps, or has a pole.

    The coefficient of a normal form has one where one more multiplier is critical.
    """

    def value(point: Solved) -> float:
        return _value(plane, _place(plane.locus, point), test)

    root = None if size < VANISHING.nothing else locate(segment, value, jump=size)
    if root is None or not root.continuous or not abs(value(root.point)) <= VANISHING.zero * size:
        return None
    one, other = (_place(plane.locus, end) for end in (segment.a, segment.b))
    width = LOCATING.bracket * (abs(one.p - other.p) + abs(one.q - other.q))
    return plane.place, max(root.error + width, root.point.correction) / (1.0 + abs(root.point.p)) + ROUNDED


def _point(
    sought: Sought, plane: Plane, place: Place, error: float, within: tuple[float, float]
) -> PlanePoint | None:
    """The point at a zero; None where it is not of its kind, or an end of the interval."""
    residual, (low, high) = plane.at(place), within
    if min(abs(place.q - low), abs(place.q - high)) <= VANISHING.margin * (high - low) or not sought.verify(
        plane
    ):
        return None
    locus, problem = plane.locus, plane.locus.at(place.q)
    if isinstance(problem, Adaptive):
        error += problem.accuracy(place.u, place.p)
    return PlanePoint(
        label="",
        kind=sought.kind,
        parameters=(locus.inner, locus.over),
        value=(place.p, place.q),
        u=place.u,
        coefficients=touching_form(plane, place, locus.index) if sought.kind == TOUCH.kind else {},
        multipliers=plane.problem.to_multipliers(plane.spectrum),
        real=not bool((plane.row[2 * plane.m :] < -VANISHING.margin).any()),
        error=error,
        residual=residual,
        margins=tuple(sorted(_vanishing(plane))),
        problem=problem,
    )


def same_point(one: PlanePoint, other: PlanePoint) -> bool:
    """Whether two points of one locus are one: of the same kind and at the same place."""
    return one.kind == other.kind and _at_one_place(one, other)


def _at_one_place(one: PlanePoint, other: PlanePoint, near: float = PLACES.same) -> bool:
    return all(abs(a - b) <= near * (1.0 + abs(a)) for a, b in zip(one.value, other.value))


# ------------------------------------------------------------------ where a motion becomes a shorter or more symmetric one
#: what is followed -> kinds of the points at which it begins beside equilibria, and beside cycles of half the period
FIRST_OF_EQUILIBRIA = {
    FOLD: ("generalized-hopf",),
    PAIR: ("zero-hopf", "double-hopf"),
    FLIP: ("double-hopf",),
}
FIRST_OF_CYCLES = {
    FOLD: ("generalized-period-doubling",),
    PAIR: ("resonance-1-2", "fold-flip", "flip-neimark-sacker"),
}


def vanishing(locus: LocusProblem, ends: Sequence[Solved], within: tuple[float, float]) -> PlanePoint | None:
    """The point of codimension two at which the cycles of a locus shrink to an equilibrium, from the last of its points.

    Their equations are singular there to a higher order in their size: Newton's method fails before. The square of the size falls to zero in
    proportion to the parameters, and the point is where that leads to.
    """
    problem = on_mesh(locus.base)
    last = _place(locus, ends[-1])
    mean, size = problem.center(last.u)
    places = (_place(locus, end) for end in reversed(ends))
    before = next((one for one in places if problem.center(one.u)[1] > SHRINKS * size), None)
    if before is None or not problem.free_period:
        return None
    behind = np.subtract(last[1:], before[1:])
    ahead = behind * size / (problem.center(before.u)[1] - size)
    rest = on_mesh(locus.at(last.q)).root(problem.resting(last.u, mean), last.p)
    if rest is None:
        return None
    found = beginning(locus, ends[-1], within, Becomes("hopf", *rest), float(np.abs(behind).max()))
    missed = np.inf if found is None else np.abs(np.subtract(found.value, last[1:]) - ahead).max()
    return found if missed <= np.abs(behind).max() else None  # the smallest cycles are known to few digits


def beginning(
    locus: LocusProblem,
    end: Solved,
    within: tuple[float, float],
    met: Becomes | None = None,
    ahead: float = 0.0,
) -> PlanePoint | None:
    """The point of codimension two at which a locus begins, or ends, whose motion there is an equilibrium, a shorter or a symmetric one.

    It is the point of that motion: the equations of the locus are singular there, and no point of it comes nearer than to half the digits.

    Parameters
    ----------
    locus, end, within
    met : Becomes, optional
        That motion, where it is known.
    ahead : float
        How far the parameters may still be from those of the point.
    """
    u, p, q = _place(locus, end)
    met = met or becomes(locus, u, p, q)
    if met is None or met.problem is None or met.u is None:
        return None
    still = met.problem.spectrum == "flow"
    kinds = (FIRST_OF_EQUILIBRIA if still else FIRST_OF_CYCLES).get(locus.condition, ())
    parent = begin(met.problem, met.kind, met.u, p, locus.over, 0, locus.bounds)
    wanted = [_of_look(look, parent) for look in looks(met.problem, parent.condition) if look.kind in kinds]
    if not isinstance(locus.base, Adaptive):
        wanted += _borders(parent)
    engine, start = first_point(parent, met.u, p, q, within, Settings())
    beside = []
    if start is not None:
        reach = BESIDE + 2.0 * ahead / float(np.linalg.norm(start.tangent[-2:]))
        beside = [engine.beside(start, by) for by in (-reach, reach)]
    around = [point for point in beside if point is not None]
    if len(around) < 2:
        return None
    found = [point for _, point in _zeros(parent, around, within, wanted)]
    return min(found, key=lambda point: abs(point.value[0] - p) + abs(point.value[1] - q), default=None)


class Becomes(NamedTuple):
    """The motion that a motion all but is: the kind of special point at which it leaves that, its problem and unknowns, where there are some."""

    kind: str
    problem: Problem | None = None
    u: np.ndarray | None = None


def becomes(locus: LocusProblem, u: np.ndarray, p: float, q: float) -> Becomes | None:
    """What the motion at a place of a locus all but is, if it is more symmetric than others of its equations."""
    whole = locus.at(q)
    if isinstance(whole, CycleProblem):
        root = whole.root(u, p, VANISHING.loose)
        return (
            None
            if root is None
            else Becomes("hopf" if root[0].spectrum == "flow" else root[0].flip_kind, *root)
        )
    sizes = locus.sizes_at(u, p, q)[:-2]
    for symmetry in whole.symmetries:
        if np.abs((image_of(symmetry, u, p) - u) / sizes).max() < VANISHING.image:
            return Becomes(symmetry.kind, *(() if symmetry.root is None else symmetry.root(u)))
    return None
