"""Points of codimension two on a locus: suspected between its points, solved by Newton's method on a system of their own."""

from __future__ import annotations

import math
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np

from ..problems.abilities import Adaptive
from .conditions import COEFFICIENTS, UNKNOWN, References, Test, coefficient_of, own_conditions, test_of
from .kinds import TOUCH, Look, looks
from .layout import FLIP, FOLD, MARGIN, PAIR, PERIOD
from .locus import Locus
from .own_test import of_plane, tested
from .plane import CLOSE, Place, Plane
from .plane_point import PlanePoint
from .problem import LocusProblem
from .starts import SINGULAR, ZERO, begin
from .touching import touching_form

END = 1e-8  # part of the interval, angle, margin: closer to an end, a resonance or a border a point is there
CRITICAL = 1e-6  # distance of a critical multiplier from the boundary, at a solution
APART = 1e-5  # a pair is complex if its imaginary part exceeds this
DOUBLE = 1e-4  # a double multiplier is known to half of the digits only
FEW = 4  # places at which a border is asked whether its equations are singular
NOISY = 1e-7  # corrections below this may no longer shrink where a test is a coefficient; their size is the point's error
ROUGHLY = CRITICAL  # corrections below this no longer shrink where a test has a few digits only
VANISHED = CRITICAL  # of its terms, or of what it is at the ends of its segment: a coefficient that is zero
REACH = 3.0  # lengths of a segment at which a solution still belongs to it
BISECTIONS = 4  # after which a coefficient has grown if it changes its sign through infinity


def find(locus: Locus) -> list[tuple[int, PlanePoint]]:
    """The points of codimension two on a locus, each with the index of the point before it; labels are left empty."""
    problem = locus.problem
    plane = Plane(problem)
    points, values = locus.branch.points, locus.branch.values
    places = [Place(u, float(p), float(q)) for (u, p), q in zip(map(problem.split, points), values)]
    wanted = looks(plane.problem, problem.condition)
    if problem.condition == PERIOD or (problem.condition == MARGIN and _singular(plane, places)):
        return []  # nothing can be told from equations that are singular all along
    found: list[tuple[int, PlanePoint]] = []
    costly = {look: _along(plane, places, look, problem) for look in wanted if look.test in COEFFICIENTS}
    at: References | None = None
    for i in range(len(places) - 1):
        if not math.isfinite(plane.at(places[i])):
            continue
        at = References(plane, problem, at)
        tests = [
            (look, test)
            for look in wanted
            if look not in costly and (test := test_of(look, problem, at)) is not None
        ]
        ends = [_evaluated(plane, place, tests) for place in places[i : i + 2]]
        pairs = [(look, test, a, b) for (look, test), a, b in zip(tests, *ends)]
        for look, values in costly.items():
            test = test_of(look, problem, at)
            assert test is not None
            pairs.append((look, test, values[i], values[i + 1]))
        for look, test, a, b in pairs:
            at_end = (
                look.test == "angle"
                and min(abs(a) if i == 0 else 1.0, abs(b) if i == len(places) - 2 else 1.0) < END
            )
            # a test that vanishes at a point itself changes its sign on one side of it
            if not (((a >= 0.0) != (b >= 0.0) and np.isfinite(a + b)) or at_end):
                continue
            share = float(np.clip(a / (a - b), 0.0, 1.0)) if a != b else 0.5
            guess, gap = _between(places[i], places[i + 1], share), _gap(problem, places[i], places[i + 1])
            if look in costly:  # first with a few digits
                rough = test_of(look, problem, at, rough=True)
                assert rough is not None
                if _through_infinity(plane, (look, rough), places[i : i + 2], (a, b)):
                    continue
                near = solved(plane, problem, at, look.kind, rough, guess, gap, ROUGHLY, rough)
                if near is not None:
                    guess, gap = Place(near.u, *near.value), 0.1 * gap
            close, slopes = CLOSE, None
            if look in costly:
                close, slopes = NOISY, test_of(look, problem, at, rough=True)
            point = solved(plane, problem, at, look.kind, test, guess, gap, close, slopes)
            if point is not None and look in costly:
                left = _evaluated(plane, Place(point.u, *point.value), [(look, test)])[0]
                if not abs(left) <= VANISHED * max(abs(a), abs(b)):
                    continue  # it changes its sign through infinity, where one more multiplier is critical
            if point is not None and not set(point.margins) - set(problem.masked):
                if look is TOUCH:
                    point.coefficients = touching_form(plane, Place(point.u, *point.value), problem.index)
                found.append((i, point))
    born = _where_born(problem, places)
    # where cycles begin other multipliers may be critical, too
    found = [pair for pair in found if not any(_at_one_place(pair[1], own) for _, own in born)]
    found += _at_borders(locus, plane, places) + _of_own_kinds(locus, plane, places) + born
    return sorted((pair for pair in found if not _at_end(locus, pair[1])), key=lambda pair: pair[0])


def _singular(plane: Plane, places: list[Place]) -> bool:
    """Whether the equations are singular at a few places of a border, and so at all of them."""
    few = places[:: max(1, len(places) // FEW)]
    tests = [abs(plane.first.null_vectors().test) for place in few if math.isfinite(plane.at(place))]
    return bool(tests) and float(np.median(tests)) < SINGULAR


def _at_end(locus: Locus, point: PlanePoint) -> bool:
    """Whether the point is an end of the interval, or of what can be evaluated, rather than a point of the plane."""
    low, high = locus.within
    return min(abs(point.value[1] - low), abs(point.value[1] - high)) <= END * (high - low)


def _along(plane: Plane, places: list[Place], look: Look, problem: LocusProblem) -> list[float]:
    """A coefficient at all points, to a few digits; where its terms cancel it is zero, not the rounding that is left of them."""
    values = []
    at: References | None = None
    for place in places:
        plane.at(place)
        at = References(plane, problem, at)
        plane.at(place)
        try:
            found = coefficient_of(look, at, plane, rough=True)
        except (ValueError, np.linalg.LinAlgError):
            found = UNKNOWN
        values.append(0.0 if abs(found.value) <= VANISHED * found.size else found.value)
    return values


def _evaluated(plane: Plane, place: Place, tests: list[tuple[Look, Test]]) -> list[float]:
    values = []
    for _, test in tests:
        plane.at(place)
        try:
            values.append(test(plane))
        except (ValueError, np.linalg.LinAlgError):
            values.append(np.nan)
    return values


def _through_infinity(
    plane: Plane, test: tuple[Look, Test], ends: list[Place], values: tuple[float, float]
) -> bool:
    """Whether a coefficient of opposite signs at two places grows between them, as it does where one more multiplier is critical."""
    (one, other), (a, b) = ends, values
    for _ in range(BISECTIONS):
        middle = _between(one, other, 0.5)
        value = _evaluated(plane, middle, [test])[0]
        if (value >= 0.0) == (a >= 0.0):
            one, a = middle, value
        else:
            other, b = middle, value
    return abs(a) + abs(b) > abs(values[0]) + abs(values[1])


def _between(a: Place, b: Place, share: float) -> Place:
    return Place(
        (1.0 - share) * a.u + share * b.u,
        (1.0 - share) * a.p + share * b.p,
        (1.0 - share) * a.q + share * b.q,
    )


def _gap(locus: LocusProblem, a: Place, b: Place) -> float:
    gap = np.append(np.abs(a.u - b.u), [abs(a.p - b.p), abs(a.q - b.q)])
    return REACH * float((gap / locus.sizes_at(*a)).max())


def solved(
    plane: Plane,
    locus: LocusProblem,
    at: References,
    kind: str,
    test: Test,
    guess: Place,
    reach: float,
    close: float = CLOSE,
    rough: Test | None = None,
) -> PlanePoint | None:
    """The point where a test vanishes on a locus; None if Newton's method does not find it near the guess."""
    conditions = [*own_conditions(plane, locus, at), test]
    try:
        result = plane.refined(conditions, guess, reach, locus.unfolded, close, rough)
    except (ValueError, np.linalg.LinAlgError):
        return None
    if result is None:
        return None
    place, error = result
    low, high = locus.bounds
    slack = 1e-9 * (high - low) if np.isfinite(high - low) else 0.0
    if not low - slack <= place.p <= high + slack:
        return None
    residual = plane.at(place)
    if not _holds(kind, plane):
        return None
    margins, problem = plane.row[2 * plane.m :], locus.at(place.q)
    if isinstance(problem, Adaptive):
        error = max(error, problem.accuracy(place.u, place.p))
    zero = tuple(int(j) for j in np.flatnonzero(np.abs(margins) < END))
    return PlanePoint(
        label="",
        kind=kind,
        parameters=(locus.inner, locus.over),
        value=(place.p, place.q),
        u=place.u,
        multipliers=plane.problem.to_multipliers(plane.spectrum),
        real=not bool((margins < -END).any()),
        error=error,
        residual=residual,
        margins=zero,
        problem=problem,
    )


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
    pairs = int(np.sum((edge < CRITICAL) & (spectrum.imag > APART)))
    if kind in PAIRS:
        return pairs >= PAIRS[kind]
    doubles = {
        "bogdanov-takens": (0.0,),
        "resonance-1-1": (1.0, -1.0) if plane.problem.flip_kind == "symmetry-breaking" else (1.0,),
        "resonance-1-2": () if plane.problem.flip_kind == "symmetry-breaking" else (-1.0,),
    }.get(kind, ())
    return not doubles or any(int(np.sum(np.abs(spectrum - place) < DOUBLE)) >= 2 for place in doubles)


BORDER_KINDS = {
    FOLD: "border-fold",
    FLIP: "border-flip",
    PAIR: "border-neimark-sacker",
    MARGIN: "double-border",
}


def _at_borders(locus: Locus, plane: Plane, places: list[Place]) -> list[tuple[int, PlanePoint]]:
    """Where the locus meets a border: one more margin vanishes."""
    problem, found = locus.problem, []
    kind = BORDER_KINDS.get(problem.condition, "border-fold")
    if problem.condition == FLIP and plane.problem.flip_kind == "symmetry-breaking":
        kind = "border-symmetry-breaking"
    own = int(plane.problem.n_margins)
    rows = []
    for place in places:
        plane.at(place)
        rows.append(plane.row[2 * plane.m : 2 * plane.m + own].copy())
    for i in range(len(places) - 1):
        last = i == len(places) - 2
        for j in range(own):
            if j in problem.masked:
                continue
            a, b = rows[i][j], rows[i + 1][j]
            ends = (last and abs(b) < ZERO) or (i == 0 and abs(a) < ZERO)
            if not (np.isfinite(a) and np.isfinite(b)) or not (a * b < 0.0 or ends):
                continue
            guess = (
                places[i]
                if i == 0 and abs(a) < ZERO
                else places[i + 1]
                if ends
                else _between(places[i], places[i + 1], a / (a - b))
            )
            plane.at(guess)
            at = References(plane, problem)
            point = solved(
                plane,
                problem,
                at,
                kind,
                lambda x, j=j: float(x.row[2 * x.m + j]),
                guess,
                max(_gap(problem, places[i], places[i + 1]), 1e-3),
            )
            if point is not None and not any(same_point(point, other) for _, other in found):
                found.append((0 if guess is places[0] else i + 1 if ends else i, point))
    return found


def _of_own_kinds(locus: Locus, plane: Plane, places: list[Place]) -> list[tuple[int, PlanePoint]]:
    """Zeros of the tests of users' kinds."""
    problem, found = locus.problem, []
    for kind in locus.kinds:
        values = []
        for place in places:
            plane.at(place)
            values.append(tested(kind, plane))
        for i, (a, b) in enumerate(pairwise(values)):
            if not (np.isfinite(a + b) and (a >= 0.0) != (b >= 0.0)):
                continue
            guess, gap = _between(places[i], places[i + 1], a / (a - b)), _gap(problem, *places[i : i + 2])
            plane.at(guess)
            at = References(plane, problem)
            test = partial(tested, kind)
            point = solved(plane, problem, at, kind.name, test, guess, gap, NOISY)
            if point is None:
                continue
            plane.at(Place(point.u, *point.value))
            seen: Any = of_plane(plane)
            if kind.verify is None or kind.verify(seen):
                found.append((i, point))
    return found


def same_point(one: PlanePoint, other: PlanePoint) -> bool:
    """Whether two points of one locus are one: of the same kind and at the same place."""
    return one.kind == other.kind and _at_one_place(one, other)


def _at_one_place(one: PlanePoint, other: PlanePoint) -> bool:
    return all(abs(a - b) <= NOISY * (1.0 + abs(a)) for a, b in zip(one.value, other.value))


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
LOOSE = 1e-3  # relative size of what has all but become an equilibrium, or a cycle of half the period
NEAR_END = 0.02  # distance at which its point of codimension two is sought, relative to the unknowns


def _where_born(locus: LocusProblem, places: list[Place]) -> list[tuple[int, PlanePoint]]:
    """The points at whose motion the cycles of a locus begin: an equilibrium, or a cycle of half the period."""
    found: list[tuple[int, PlanePoint]] = []
    cycles: Any = locus.base
    if not isinstance(cycles, Adaptive):
        return found
    for i, place in ((0, places[0]), (len(places) - 2, places[-1])):
        whole: Any = locus.at(place.q)
        root = whole.root(place.u, place.p, loose=LOOSE)
        if root is None:
            continue
        own, u = root
        still = own.spectrum == "flow"
        kinds = (FIRST_OF_EQUILIBRIA if still else FIRST_OF_CYCLES).get(locus.condition, ())
        parent = begin(own, "hopf" if still else own.flip_kind, u, place.p, locus.over, 0, locus.bounds)
        plane, guess = Plane(parent), Place(u, place.p, place.q)
        if not math.isfinite(plane.at(guess)):
            continue
        at = References(plane, parent)
        for look in looks(own, parent.condition):
            test = test_of(look, parent, at) if look.kind in kinds else None
            point = (
                None if test is None else solved(plane, parent, at, look.kind, test, guess, NEAR_END, NOISY)
            )
            if point is not None:
                found.append((i, point))
                break
    return found
