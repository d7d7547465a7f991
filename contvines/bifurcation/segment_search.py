"""The special points of one segment of a branch: all kinds are asked in one loop, and what they find is checked for consistency."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from operator import itemgetter
from typing import TYPE_CHECKING

import numpy as np

from ..continuation.engine import Engine, Solved
from ..continuation.layout import MARGIN
from ..shared.floating_point import EPSILON, TINY
from .consistency import at_one, on_circle, unaccounted, unresolved
from .determinant import singular
from .evidence import Evidence, evidence
from .first_border import find_border, first_zero, rounding
from .kind import Kind, Test
from .kind_answers import verified
from .kinds import BY_NAME, KINDS
from .locate import locate, locate_singular
from .located import NOWHERE, Located, Role
from .location_error import blurred
from .one_sided_limits import one_sided
from .parabola import parabola_dips
from .point_on_branch import PointOnBranch
from .scan import reached, spectra
from .segment import Segment
from .settings import LIMITS
from .symmetry_test import SymmetryTest, turns_round

if TYPE_CHECKING:
    from .user_functions import Own, UserFunction

PLACES = np.arange(1, 8) / 8.0  # of a segment at which its inside is looked at
NARROWER = 3  # times that a distance is looked at nearer, at places eight times as dense each time, ...
HALVINGS = 9  # ... times that parts are halved on which a multiplier may reach the circle, ...
ROOF = 12  # ... and times that the smallest margin, which may be a roof, is looked at nearer


class SegmentSearch:
    """Finds the special points of segments.

    Parameters
    ----------
    engine : Engine
    kinds : sequence of Kind
    functions : mapping of name to function, optional
        See :func:`contvines.bifurcation.user_functions.own_tests`.
    stops : iterable of str
        Names of those at whose zeros a branch ends.
    """

    def __init__(
        self,
        engine: Engine,
        kinds: Sequence[Kind] = KINDS,
        functions: Mapping[str, UserFunction] | None = None,
        stops: Iterable[str] = (),
    ) -> None:
        self.engine = engine
        self.kinds = [kind for kind in kinds if kind.tests or kind.find]
        # multipliers of smooth flows jump by rounding alone, as beside homoclinic orbits: parts of parts tell no more
        self.deepest = 1 if engine.adaptive else engine.settings.halvings
        scale = None if engine.plain else engine.scale[:-1]
        self.symmetries = [SymmetryTest(s, engine.n, engine.shift, scale) for s in engine.problem.symmetries]
        self.parts = 0  # of segments that were searched along the branch that is followed
        self.own: list[Own] = []
        if functions or any(kind.test is not None for kind in kinds):
            from .user_functions import own_tests

            self.own = own_tests(engine, kinds, functions or {}, tuple(stops), BY_NAME["user"])

    def search(self, segment: Segment, real: bool = True, depth: int = 0) -> list[Located]:
        """The special points of one segment (positions in [0, 1])."""
        self.parts += depth > 0
        place, start = self._beside_infinity(segment, real)
        if start is not None:
            rest = self.search(Segment(self.engine, start, segment.b, segment.turns), real, depth)
            return [replace(e, position=place + (1.0 - place) * e.position) for e in rest]
        stop, before = self._stop(segment, real, depth)
        if before is not None:
            return [*before, *stop]
        found = stop
        for kind in self.kinds:
            found = [*found, *self._of_kind(kind, segment, found)]
        if not unaccounted(segment, found):
            return [*found, *self._own(segment)]
        middle = segment.at(0.5)
        if middle is None:
            return [*found, *self._own(segment)]
        settings = self.engine.settings
        if depth < self.deepest and segment.length > settings.resolution:
            if self.parts < settings.parts:
                # where an event of a virtual orbit grazes the parameter may turn back, but no multiplier is +1
                turns = any(e.kind == "fold" and at_one(self.engine, e) for e in found)
                return self.both(segment, 0.5, middle, real, depth + 1, turns)
            return [*found, *self._own(segment), replace(unresolved(segment, middle), name="parts")]
        return [*found, *self._own(segment), unresolved(segment, middle)]

    def _beside_infinity(self, segment: Segment, real: bool) -> tuple[float, Solved | None]:
        """A point close behind the beginning of a segment at a border where a multiplier is infinite but for rounding, and drowns the others.

        None, too, where the border is passed at the beginning itself.
        """
        engine, place = self.engine, self.engine.settings.close / max(segment.length, TINY)
        if engine.detection != "map" or not place < 1.0 or not _drowned(engine, segment.a):
            return place, None
        start = segment.at(place)
        if start is None or _drowned(engine, start) or (engine.smallest_margin(start.row) >= MARGIN) != real:
            return place, None
        return place, start

    def _of_kind(self, kind: Kind, segment: Segment, found: Sequence[Located]) -> list[Located]:
        """The special points of a kind: its own search, or the zeros of its test functions that it verifies."""
        if kind.find is not None:
            return kind.find(segment, found)
        assert kind.tests is not None
        located = [self.zero(kind, segment, test) for test in kind.tests(segment, found)]
        for fold in found:
            if fold.kind == "fold":
                located += self._around(kind, segment, fold)
        return [event for event in located if event is not None]

    def zero(self, kind: Kind, segment: Segment, test: Test) -> Located | None:
        """The zero of a test function on a segment, if it is one of this kind."""
        root = locate(segment, test.function, jump=test.jump)
        if root is None or not root.continuous:
            return None
        point = PointOnBranch(self.engine, root.point, segment, root.position, test.index)
        if not verified(kind, point, {self.engine.problem.parameter: root.point.p}):
            return None
        return blurred(segment, Located.at(root, kind.name, test.index), test.function)

    def _around(self, kind: Kind, segment: Segment, fold: Located) -> list[Located | None]:
        """Zeros before a fold and behind it, so that the ends of the segment do not tell."""
        assert kind.tests is not None
        if kind.tests(segment, ()):
            return []
        found: list[Located | None] = []
        for first, second, start, length in (
            (segment.a, fold.point, 0.0, fold.position),
            (fold.point, segment.b, fold.position, 1.0 - fold.position),
        ):
            part = Segment(self.engine, first, second)
            for test in kind.tests(part, ()):
                event = self.zero(kind, part, test)
                if event is not None:
                    found.append(replace(event, position=start + length * event.position))
        return found

    def _own(self, segment: Segment) -> list[Located]:
        """Zeros of users' tests."""
        found = []
        for number, own in enumerate(self.own):
            if (own.at(segment.a) >= 0.0) != (own.at(segment.b) >= 0.0):
                event = self.zero(own.kind, segment, Test(own.at, number))
                if event is not None:
                    role = Role.STOP if own.kind.ends else Role.SPECIAL
                    found.append(replace(event, role=role, name=own.name))
        return found

    # ------------------------------------------------------------------ where a branch ends
    def _stop(self, segment: Segment, real: bool, depth: int) -> tuple[list[Located], list[Located] | None]:
        """The border or the meetings at which the branch ends, and the special points before; None where these are not looked for yet."""
        engine, borders, last = self.engine, *self._borders(segment, real)
        settings = engine.settings
        if borders and depth < settings.halvings:
            # behind a border multipliers may come back from infinity, and what they say of both ends together is nothing
            short = borders[0].position - settings.close / segment.length
            if not short > 0.0:
                return borders, []
            if last is not None:
                found = self.before(segment, short, last, real, depth + 1)
                return borders, found + self._at_border(
                    short, Segment(engine, last, borders[0].point), borders[0]
                )
        events = self._meetings(segment)
        if events:
            # behind a meeting lies the image of what is before it, so that what was passed before it is passed again
            first = min(e.position for e in events)
            short = first - max(settings.aside * first, settings.near / segment.length)
            if not short > 0.0:
                return events, []
            last = segment.at(short)
            if last is not None:
                return events, self.before(segment, short, last, real, depth)
        return [*events, *borders], None

    def _at_border(self, short: float, end: Segment, border: Located) -> list[Located]:
        """The special points between a border and the place close before it up to which others are looked for, where both tell of some."""
        engine, (before, after) = self.engine, end.counts
        if before == after or not end.length > engine.settings.resolution:
            return []
        if (
            engine.detection != "map"
            or engine.adaptive
            or _unbounded(engine, end.b)
            or _drowned(engine, end.b)
        ):
            return []  # of cycles on meshes multipliers jump by rounding
        if on_circle(engine, end.b, LIMITS.agreeing):  # it is the border's
            return []
        found: list[Located] = []
        for kind in self.kinds:
            found = [*found, *self._of_kind(kind, end, found)]
        middle = end.at(0.5) if unaccounted(end, found) else None
        found = [e for e in found if not e.astray] + ([] if middle is None else [unresolved(end, middle)])
        return [replace(e, position=short + (border.position - short) * e.position) for e in found]

    def _borders(self, segment: Segment, real: bool) -> tuple[list[Located], Solved | None]:
        border = find_border(segment, real)
        if border is None:
            return [], None
        root, index = border.root, border.index
        kind = self.engine.problem.margin_kind(index)
        point, before = one_sided(segment, root)
        blur = rounding(segment, root, index, before)
        found = Located(root.position, kind, index, point, NOWHERE, root.error, Role.BORDER, "", blur)
        return [found], before

    def _meetings(self, segment: Segment) -> list[Located]:
        events, settings = [], self.engine.settings
        # beside multipliers near the inverse of rounding Newton's method stops at larger corrections, and what is not symmetric is noise
        correction = max(segment.a.correction, segment.b.correction)
        least = settings.symmetric * max(1.0, correction / settings.tolerance)
        accuracy = correction if self.engine.adaptive else np.inf
        for index, test in enumerate(self.symmetries):
            ends = test.part(np.array([segment.a.u, segment.b.u]), [segment.a.p, segment.b.p])
            if not turns_round(test, ends, least, accuracy):
                continue
            scale = float(np.sqrt(ends[0] @ ends[0]))

            def along(point: Solved, test: SymmetryTest = test, row: np.ndarray = ends[0] / scale) -> float:
                return float(row @ test.part(point.u[None, :], [point.p])[0])

            first, last = along(segment.a), along(segment.b)
            root = locate_singular(segment, along, first / (first - last))
            if root is None and (root := locate(segment, along)) is not None:
                root = locate_singular(segment, along, root.position) or root
            if root is not None:
                at = test.symmetry.kind_at
                kind = test.kind if at is None else at(root.point.u)
                known = self.engine.many or segment.length <= self.engine.settings.resolution
                astray = not (known or singular(self.engine, root.point))
                events.append(Located.at(root, kind, index, Role.MEETING, astray))
        if not events:
            return []
        # an equilibrium that a cycle becomes may be its own mirror image, too: of symmetries that are met at once the first one says what is met
        first = min(events, key=lambda event: event.position)
        return [e for e in events if self.engine.distance(e.point, first.point) <= settings.one_place][:1]

    # ------------------------------------------------------------------ what the ends of a segment do not tell
    def evidence_of(self, points: Sequence[Solved]) -> Evidence:
        """What some points tell."""
        own = np.array([[own.at(point) for own in self.own] for point in points])
        rows = np.array([point.row for point in points])
        return evidence(
            self.engine,
            rows,
            self.engine.smallest_margin(rows),
            spectra(self.engine, rows),
            np.array([point.tangent[-1] for point in points]),
            np.array([point.sign for point in points]),
            self.engine.upright(points[0].p),
            own.reshape(len(points), len(self.own)),
        )

    def inside(
        self, segment: Segment, real: bool, columns: Sequence[int] = ()
    ) -> tuple[float, Solved] | None:
        """A point inside a segment that tells what neither end tells, with its place, or None.

        A few places are looked at, then, for each suspicious distance (columns of `distances`), others near the one at which it is smallest: of
        the smallest margin, which may be a roof, to the end, of others while the parabola through three of them passes zero.
        """
        if not real and (window := self.passed(segment)) is not None:
            return window
        ends = self.evidence_of([segment.a, segment.b])
        smallest = ends.first_margin - 1

        def look(low: float, high: float) -> tuple[list[tuple[float, Solved]], Evidence, np.ndarray]:
            return self._at(segment, low + (high - low) * PLACES, ends, real)

        first = look(0.0, 1.0)
        for column in [None, *columns]:
            (found, seen, new), low, high = first, 0.0, 1.0
            ends_here = ends.distance(column or 0)
            for _ in range(ROOF if column == smallest else NARROWER):
                if new.any():
                    return found[int(new.argmax())]
                if column is None or not found:
                    break
                values = np.array([ends_here[0], *seen.distance(column), ends_here[1]])
                around = np.array([low, *(s for s, _ in found), high])
                k = int(np.nan_to_num(np.abs(values[1:-1]), nan=np.inf).argmin()) + 1
                three, gaps = values[k - 1 : k + 2], np.diff(around[k - 1 : k + 2])
                if column != smallest and not parabola_dips(*(three * np.sign(three[0])), *gaps):
                    break
                low, high, ends_here = around[k - 1], around[k + 1], three[::2]
                found, seen, new = look(low, high)
        return None

    def _at(
        self, segment: Segment, places: np.ndarray, ends: Evidence, real: bool
    ) -> tuple[list[tuple[float, Solved]], Evidence, np.ndarray]:
        """Points of a segment at some places, what they tell, and which of them tell what its ends do not."""
        found = [(s, p) for s, p in zip(places.tolist(), segment.several(places)) if p is not None]
        if not found:
            return found, ends, np.zeros(0, dtype=bool)
        seen, (one, other) = self.evidence_of([point for _, point in found]), ends.sides
        new = ((seen.sides - one) * (seen.sides - other) * seen.sides * one * other != 0).any(axis=1)
        if real and not ends.outside.any():
            new |= seen.outside
        elif not real and ends.outside.all():
            new |= seen.distances[:, ends.first_margin - 1] > self.engine.settings.shown
        return found, seen, new

    def alone(self, segment: Segment, real: bool) -> tuple[float, Solved] | None:
        """A point inside a segment without neighbours that tells what neither end tells, with its place, or None.

        Its middle is the third point of the parabolas that say whether to look further.
        """
        ends = self.evidence_of([segment.a, segment.b])
        found, seen, new = self._at(segment, np.array([0.5]), ends, real)
        if new.any():
            return found[0]
        columns: list[int] = []
        if found:
            rows = np.array([segment.a.row, found[0][1].row, segment.b.row])
            if not self.engine.many and reached(self.engine, rows, np.array([0.5, 0.5])).any():
                split = self.halved(segment, real)
                if split is not None:
                    return split
            (first, last), middle = ends.distances, seen.distances[0]
            side = np.sign(middle)
            dips = parabola_dips(side * first, side * middle, side * last, 0.5, 0.5)
            columns = np.flatnonzero(dips[: len(dips) - (not real)]).tolist()
        if columns:
            return self.inside(segment, real, columns)
        return None if real else self.passed(segment)

    def halved(
        self, segment: Segment, real: bool, neighbours: Sequence[tuple[float, np.ndarray]] = ()
    ) -> tuple[float, Solved] | None:
        """A point inside a segment that tells what neither end tells, with its place, or None, where a multiplier may have reached the circle.

        The segment is halved, then those of its parts on which, as far as the points now tell, one may have. `neighbours` are rows of points
        before and behind, with their places.
        """
        ends = self.evidence_of([segment.a, segment.b])
        known = sorted([*neighbours, (0.0, segment.a.row), (1.0, segment.b.row)], key=itemgetter(0))
        halves = np.array([0.5])
        for _ in range(HALVINGS):
            found, _, new = self._at(segment, halves, ends, real)
            if new.any():
                return found[int(new.argmax())]
            known = sorted([*known, *((s, point.row) for s, point in found)], key=itemgetter(0))
            places, rows = np.array([s for s, _ in known]), np.array([row for _, row in known])
            open_ = reached(self.engine, rows, np.diff(places)) & (places[:-1] >= 0.0) & (places[1:] <= 1.0)
            halves = 0.5 * (places[:-1] + places[1:])[open_]
            if not (found and len(halves)):
                return None
        return None

    def passed(self, segment: Segment) -> tuple[float, Solved] | None:
        """A point of a virtual segment at which all margins are positive, between where the first ones come back and others are lost."""
        engine = self.engine
        below = [engine.margins(end.row) < MARGIN for end in (segment.a, segment.b)]
        if not (below[0].any() and below[1].any()) or (below[0] & below[1]).any():
            return None
        begins, ends = (first_zero(segment, np.flatnonzero(which), False) for which in below)
        if begins is None or ends is None or not begins.position < ends.position:
            return None
        middle = 0.5 * (begins.position + ends.position)
        point = segment.at(middle)
        return (
            None
            if point is None or float(engine.smallest_margin(point.row)) < engine.settings.shown
            else (middle, point)
        )

    def before_border(self, segment: Segment, border: Located) -> tuple[float, Solved] | None:
        """A point up to a border where another margin is negative, though it is positive at both ends, or None."""
        engine, place = self.engine, border.position
        if not 0.0 < place < 1.0:
            return None
        left, middle, right = (engine.margins(point.row) for point in (segment.a, border.point, segment.b))
        if (middle < MARGIN).any():  # one of a flight, say, that is over before the segment is
            return place, border.point
        rows, found = segment.rows(place * PLACES)
        below = np.flatnonzero(found & (engine.smallest_margin(rows) < MARGIN))
        for share in PLACES[below].tolist():
            point = segment.at(share * place)
            if point is not None:
                return share * place, point
        parts = place * segment.length, (1.0 - place) * segment.length
        columns = np.flatnonzero(parabola_dips(left - MARGIN, middle - MARGIN, right - MARGIN, *parts))
        if not len(columns):
            return None
        first = 2 + len(self.own)
        inside = self.inside(Segment(engine, segment.a, border.point), True, (first + columns).tolist())
        if inside is None or not engine.smallest_margin(inside[1].row) < MARGIN:
            return None
        # measured along the chord of the whole segment
        gap = engine.join(inside[1].u, inside[1].p) - segment.za
        return float(segment.border @ gap) / segment.length, inside[1]

    # ------------------------------------------------------------------ parts of segments
    def before(
        self, segment: Segment, s: float, middle: Solved, real: bool, depth: int = 0, turns: bool = False
    ) -> list[Located]:
        """The special points of the first part of a segment."""
        part = self.search(Segment(self.engine, segment.a, middle, turns or segment.turns), real, depth)
        return [replace(e, position=s * e.position) for e in part]

    def both(
        self, segment: Segment, s: float, middle: Solved, real: bool, depth: int = 0, turns: bool = False
    ) -> list[Located]:
        """The special points of a segment from its two parts; `turns` where a fold has been found on it, or its inside tells of two."""
        slopes = np.array([point.tangent[-1] for point in (segment.a, middle, segment.b)])
        certain = np.abs(slopes).min() > self.engine.upright(middle.p)
        turns = (
            turns
            or segment.turns
            or bool(certain and slopes[0] * slopes[1] < 0.0 and slopes[1] * slopes[2] < 0.0)
        )
        second = self.search(Segment(self.engine, middle, segment.b, turns), real, depth)
        return self.before(segment, s, middle, real, depth, turns) + [
            replace(e, position=s + (1.0 - s) * e.position) for e in second
        ]


def _drowned(engine: Engine, point: Solved) -> bool:
    """Whether a point is at a border, and another multiplier nearer to the circle than the rounding of the largest one."""
    if abs(engine.smallest_margin(point.row)) >= engine.settings.inside:
        return False
    sizes = np.sort(np.abs(engine.spectrum(point.row)))
    near = np.abs(sizes[:-1] - 1.0).min(initial=np.inf) <= EPSILON * sizes.max(initial=0.0)
    return bool(near or not np.isfinite(sizes).all())


def _unbounded(engine: Engine, point: Solved) -> bool:
    """Whether a multiplier grows without bound towards a point: nothing tells on which side."""
    return bool(np.abs(engine.spectrum(point.row)).max(initial=0.0) >= LIMITS.unbounded)
