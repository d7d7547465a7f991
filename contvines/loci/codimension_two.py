"""Points of codimension two on a locus: suspected between its points, solved by Newton's method on a system of their own."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..problems.derivatives import along
from .coefficients import Forms
from .kernels import BRANCH, FLIP, FOLD, MARGIN, PAIR
from .kinds import Look, looks
from .linear import Null
from .locus import Locus
from .plane import Place, Plane
from .problem import LocusProblem

Test = Callable[[Plane], float]
THIRD_ORDER = ("cubic", "lyapunov")
END = 1e-8  # points closer than this part of the interval to its ends are the ends
REACH = 3.0  # lengths of a segment at which a solution still belongs to it


@dataclass(eq=False)
class PlanePoint:
    """A point of codimension two.

    Attributes
    ----------
    label, kind : str
    parameters : (str, str)
    value : (float, float)
    u : ndarray, shape (N,)
        The motion, in the unknowns of ``problem``.
    on : list of str
        Labels of the loci on which it lies.
    coefficients : dict
        Of its normal form; see :mod:`contvines.loci.coefficients`.
    multipliers : ndarray of complex
        Of the full period.
    real : bool
    error : float
        Last correction of Newton's method, relative.
    residual : float
    margins : tuple of int
        Places of the margins that vanish there.
    note : str
    problem : Problem or None
    """

    label: str
    kind: str
    parameters: tuple[str, str]
    value: tuple[float, float]
    u: np.ndarray = field(repr=False)
    on: list[str] = field(default_factory=list)
    coefficients: dict[str, float] = field(default_factory=dict)
    multipliers: np.ndarray = field(default_factory=lambda: np.zeros(0, complex), repr=False)
    real: bool = True
    error: float = 0.0
    residual: float = 0.0
    margins: tuple[int, ...] = ()
    note: str = ""
    problem: Any = field(default=None, repr=False)

    @property
    def orbit(self) -> Any:
        """The motion as the object that its problem hands to users."""
        if self.problem is None:
            raise ValueError(f"{self.label} was loaded without its problem")
        return self.problem.orbit(self.u, self.value[0])

    def to_dict(self) -> dict[str, Any]:
        """The entry of this point in the JSON of a chart."""
        return {
            "label": self.label,
            "kind": self.kind,
            "value": dict(zip(self.parameters, map(float, self.value))),
            "on": list(self.on),
            "coefficients": {name: float(value) for name, value in self.coefficients.items()},
            "real": bool(self.real),
            "multipliers": [[float(m.real), float(m.imag)] for m in self.multipliers],
            "error": float(self.error),
            "residual": float(self.residual),
            "note": self.note,
        }


class References:
    """Borders and positions that belong to one point of a locus, held fixed while tests are compared and solved."""

    def __init__(self, plane: Plane, locus: LocusProblem) -> None:
        problem, maps = plane.problem, plane.problem.spectrum == "map"
        self.plus: Null = plane.first.null_vectors()
        flips = maps and getattr(problem, "pinned", 0) != 2
        self.minus: Null | None = plane.first.null_vectors(flipped=True) if flips else None
        self.reference = locus.reference
        self.second = 0.0
        if plane.m >= 2:
            self.reference = plane.pair(self._nearest(plane))[1]
            self.second = self._other(plane)

    def _nearest(self, plane: Plane) -> float:
        spectrum = plane.spectrum
        upper = spectrum[spectrum.imag > 0.0]
        if not len(upper):
            return self.reference
        if plane.flow:
            return float(np.abs(upper[np.argmin(np.abs(upper.real))]) ** 2)
        return float(upper[np.argmin(np.abs(np.abs(upper) - 1.0))].real)

    def _other(self, plane: Plane) -> float:
        spectrum = plane.spectrum
        upper = spectrum[spectrum.imag > 0.0]
        if len(upper) < 2:
            return np.nan
        distance = np.abs(upper.real) if plane.flow else np.abs(np.abs(upper) - 1.0)
        other = upper[np.argsort(distance)[1]]
        return float(np.abs(other) ** 2 if plane.flow else other.real)


def own_conditions(plane: Plane, locus: LocusProblem, at: References) -> list[Test]:
    """The conditions of the locus itself, with references held fixed."""
    if locus.condition == FOLD:
        return [lambda x: x.singular_test(at.plus.left, at.plus.right)]
    if locus.condition == FLIP:
        assert at.minus is not None
        minus = at.minus
        return [lambda x: x.singular_test(minus.left, minus.right, flipped=True)]
    if locus.condition == BRANCH:
        return [
            lambda x: x.singular_test(at.plus.left, at.plus.right),
            lambda x: x.unfolding_test(at.plus.left, at.plus.right),
        ]
    if locus.condition == PAIR:
        return [lambda x: x.pair(at.reference)[0]]
    return [lambda x: float(x.row[2 * x.m + locus.index])]


def test_of(look: Look, locus: LocusProblem, at: References, rough: bool = False) -> Test | None:
    """The test function of something to look for; None where it cannot be asked here.

    Coefficients of third order are computed to a few digits with ``rough``.
    """
    plus, minus = at.plus, at.minus
    if look.test == "quadratic":
        return lambda x: _bend(x, plus)
    if look.test == "cubic":
        return lambda x: _forms(x, rough).cubic(-1.0).value
    if look.test == "lyapunov":
        return lambda x: _lyapunov(x, at.reference, rough)
    if look.test == "plus":
        return lambda x: x.singular_test(plus.left, plus.right)
    if look.test == "minus":
        return None if minus is None else lambda x: x.singular_test(minus.left, minus.right, flipped=True)
    if look.test == "pair":
        return lambda x: x.pair(at.reference)[0]
    if look.test == "second-pair":
        return None if np.isnan(at.second) else lambda x: x.pair(at.second)[0]
    if look.test == "double":
        return lambda x: x.two_nearest(look.value)
    return lambda x: x.pair(at.reference)[1] - look.value


def _bend(plane: Plane, null: Null) -> float:
    """w.B(v, v), as the derivative of g along the null vector."""
    place, line = plane.place, plane.first
    v, _ = line.null(null.left, null.right)

    def test(t: float) -> np.ndarray:
        line.at(place.u + t * v, place.p)
        return np.array(line.null(null.left, null.right)[1])

    value = float(along(test, _size(place.u) / float(np.abs(v).max())).value)
    line.at(place.u, place.p)
    return value


def _size(u: np.ndarray) -> float:
    return max(float(np.abs(u).max(initial=0.0)), 1.0)


def _forms(plane: Plane, rough: bool = False) -> Forms:
    place = plane.place
    return Forms(plane.locus.at(place.q), place.u, place.p, rough)


def _lyapunov(plane: Plane, reference: float, rough: bool = False) -> float:
    place = plane.pair(reference)[1]
    if plane.flow:
        if place <= 0.0:
            return np.nan
        return _forms(plane, rough).lyapunov(1j * np.sqrt(place))[0].value
    if abs(place) >= 1.0:
        return np.nan
    return _forms(plane, rough).lyapunov(complex(place, np.sqrt(1.0 - place * place)))[0].value


def find(locus: Locus) -> list[tuple[int, PlanePoint]]:
    """The points of codimension two on a locus, each with the index of the point before it; labels are left empty."""
    problem = locus.problem
    plane = Plane(problem)
    points, values = locus.branch.points, locus.branch.values
    places = [Place(U[: problem.size], float(U[problem.size]), float(q)) for U, q in zip(points, values)]
    wanted = looks(plane.problem, problem.condition)
    found: list[tuple[int, PlanePoint]] = []
    costly = {look: _along(plane, places, look, problem) for look in wanted if look.test in THIRD_ORDER}
    for i in range(len(places) - 1):
        if not plane.at(places[i]) < 1e300:
            continue
        at = References(plane, problem)
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
            if not a * b < 0.0:
                continue
            guess, gap = _between(places[i], places[i + 1], a / (a - b)), _gap(places[i], places[i + 1])
            if look in costly:  # first with a few digits
                rough = test_of(look, problem, at, rough=True)
                assert rough is not None
                near = solved(plane, problem, at, look.kind, rough, guess, gap)
                if near is None:
                    continue
                guess, gap = Place(near.u, *near.value), 0.1 * gap
            point = solved(plane, problem, at, look.kind, test, guess, gap)
            if point is not None and not set(point.margins) - set(problem.masked):
                found.append((i, point))
    found += _at_borders(locus, plane, places)
    return sorted((pair for pair in found if not _at_end(locus, pair[1])), key=lambda pair: pair[0])


def _at_end(locus: Locus, point: PlanePoint) -> bool:
    """Whether the point is an end of the interval, or of what can be evaluated, rather than a point of the plane."""
    low, high = locus.within
    return min(abs(point.value[1] - low), abs(point.value[1] - high)) <= END * (high - low)


def _along(plane: Plane, places: list[Place], look: Look, problem: LocusProblem) -> list[float]:
    """A coefficient of third order at all points, to a few digits."""
    values = []
    for place in places:
        plane.at(place)
        at = References(plane, problem)
        test = test_of(look, problem, at, rough=True)
        assert test is not None
        plane.at(place)
        values += _evaluated(plane, place, [(look, test)])
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


def _between(a: Place, b: Place, share: float) -> Place:
    return Place(
        (1.0 - share) * a.u + share * b.u,
        (1.0 - share) * a.p + share * b.p,
        (1.0 - share) * a.q + share * b.q,
    )


def _gap(a: Place, b: Place) -> float:
    gap = np.append(np.abs(a.u - b.u), [abs(a.p - b.p), abs(a.q - b.q)])
    return REACH * float(
        (gap / np.append(1.0 + np.abs(a.u), [max(abs(a.p), 1e-3), max(abs(a.q), 1e-3)])).max()
    )


def solved(
    plane: Plane, locus: LocusProblem, at: References, kind: str, test: Test, guess: Place, reach: float
) -> PlanePoint | None:
    """The point where a test vanishes on a locus; None if Newton's method does not find it near the guess."""
    conditions = [*own_conditions(plane, locus, at), test]
    try:
        result = plane.refined(conditions, guess, reach, locus.unfolded)
    except (ValueError, np.linalg.LinAlgError):
        return None
    if result is None:
        return None
    place, error = result
    low, high = locus.bounds
    if not low - 1e-9 <= place.p <= high + 1e-9:
        return None
    residual = plane.at(place)
    margins = plane.row[2 * plane.m :]
    zero = tuple(int(j) for j in np.flatnonzero(np.abs(margins) < 1e-8))
    return PlanePoint(
        label="",
        kind=kind,
        parameters=(locus.inner, locus.over),
        value=(place.p, place.q),
        u=place.u,
        multipliers=plane.problem.to_multipliers(plane.spectrum),
        real=not bool((margins < -1e-8).any()),
        error=error,
        residual=residual,
        margins=zero,
        problem=locus.at(place.q),
    )


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
            ends = (last and abs(b) < 1e-9) or (i == 0 and abs(a) < 1e-9)
            if not (a * b < 0.0 or ends) or not np.isfinite(a + b):
                continue
            guess = (
                places[i]
                if i == 0 and abs(a) < 1e-9
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
                max(_gap(places[i], places[i + 1]), 1e-3),
            )
            if point is not None and not any(
                _same(point, other) and point.kind == other.kind for _, other in found
            ):
                found.append((0 if guess is places[0] else i + 1 if ends else i, point))
    return found


def _same(one: PlanePoint, other: PlanePoint) -> bool:
    return all(abs(a - b) <= 1e-7 * (1.0 + abs(a)) for a, b in zip(one.value, other.value))
