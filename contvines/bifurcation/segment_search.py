"""Search for the special points of one segment of a branch: each kind is searched in turn, and the result is checked for consistency.

"Evidence" is defined in :mod:`.evidence`. A segment is split at a point inside it whose evidence differs from that of both ends; such a point
separates two special points that the ends alone do not show.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from operator import itemgetter
from typing import NamedTuple

import numpy as np

from ..continuation.engine import Engine, Solved
from ..continuation.layout import MARGIN, Status, packed
from ..shared.numbers import EPSILON, TINY
from .consistency import at_one, has_unexplained_change, is_jump, on_circle, unresolved
from .evidence import Evidence, evidence
from .first_border import border_of, first_zero
from .kind import Kind, PointOnBranch, Test, UserFunction, own_tests, verified
from .kinds import BY_NAME, KINDS
from .locate import Located, Role, Segment, locate, locate_singular
from .location_error import with_rounding_error
from .scan import SymmetryTest, parabola_dips, reached, turns_round
from .settings import LIMITS

PLACES = np.arange(1, 8) / 8.0  # positions at which the inside of a segment is sampled
ZOOMS = 3  # number of zooms towards the smallest value of a distance; each samples a quarter of the interval before
HALVINGS = 9  # number of times that parts are halved on which a multiplier may reach the circle
ROOF_ZOOMS = 12  # number of zooms towards the peak of the smallest margin, which may be shaped like a roof


Split = tuple[float, Solved]
"""A point inside a segment, with its position in [0, 1]."""


class _Sample(NamedTuple):
    """Points of a segment at some positions, their evidence, and the first point whose evidence differs from that of both ends."""

    places: list[float]
    points: list[Solved]
    evidence: Evidence
    split: Split | None


class SegmentSearch:
    """Finds the special points of segments.

    Parameters
    ----------
    engine : Engine
    kinds : sequence of Kind
        Kinds to look for, in this order.
    functions : mapping of str to UserFunction, optional
        User functions by name; see :func:`contvines.bifurcation.kind.own_tests`.
    stops : iterable of str
        Names of the user functions at whose zeros a branch ends.

    Attributes
    ----------
    symmetries : list of SymmetryTest
        Tests for the problem's symmetries.
    own : list of Own
        User-defined tests.
    deepest : int
        Largest number of times that a segment is halved.
    parts : int
        Number of parts of segments searched so far along the current branch; the tracer sets it to 0 at the start.
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
        # multipliers of smooth flows can jump by rounding alone, as beside homoclinic orbits: halving twice does not help
        self.deepest = 1 if engine.adaptive else engine.settings.halvings
        scale = None if engine.plain else engine.scale[:-1]
        self.symmetries = [SymmetryTest(s, engine.n, engine.shift, scale) for s in engine.problem.symmetries]
        self.parts = 0
        self.own = own_tests(engine, kinds, functions or {}, tuple(stops), BY_NAME["user"])

    def search(self, segment: Segment, real: bool = True, depth: int = 0) -> list[Located]:
        """Return the special points of one segment.

        Parameters
        ----------
        segment : Segment
        real : bool
            Whether its beginning has positive margins.
        depth : int
            Number of times that a larger segment has been halved already.

        Returns
        -------
        list of Located
            Positions in [0, 1]; not in order.
        """
        self.parts += depth > 0
        behind = self._beside_infinity(segment, real)
        if behind is not None:
            return self.part(segment, behind[1], segment.b, (behind[0], 1.0), real, depth)
        stop, before = self._branch_end(segment, real, depth)
        if before is not None:
            return [*before, *stop]
        found = self._of_all_kinds(segment, stop)
        middle = segment.at(0.5) if has_unexplained_change(segment, found) else None
        if middle is not None:
            closer = depth < self.deepest and segment.length > self.engine.settings.resolution
            if closer and self.parts < self.engine.settings.parts:
                # where an event of a virtual orbit grazes, the parameter may turn back without a multiplier +1
                turns = any(e.kind == "fold" and at_one(self.engine, e) for e in found)
                return self.both(segment, 0.5, middle, real, depth + 1, turns)
            found.append(replace(unresolved(segment, middle), name="parts" if closer else ""))
        return [*found, *self._user_zeros(segment)]

    def part(
        self,
        segment: Segment,
        a: Solved,
        b: Solved,
        places: tuple[float, float],
        real: bool,
        depth: int = 0,
        turns: bool = False,
    ) -> list[Located]:
        """Return the special points of a part of a segment, from a to b; `places` are the positions of a and b on the segment."""
        return moved(self.search(Segment(self.engine, a, b, turns or segment.turns), real, depth), *places)

    def both(
        self, segment: Segment, s: float, middle: Solved, real: bool, depth: int = 0, turns: bool = False
    ) -> list[Located]:
        """Return the special points of a segment by searching its two parts, before and after the point `middle` at `s`.

        `turns` says that the segment contains a fold already found (see `Segment`); it is also set if the slopes at the three points show two folds.
        """
        slopes = np.array([point.tangent[-1] for point in (segment.a, middle, segment.b)])
        if np.abs(slopes).min() > self.engine.upright(middle.p):
            turns = turns or bool(slopes[0] * slopes[1] < 0.0 and slopes[1] * slopes[2] < 0.0)
        second = self.part(segment, middle, segment.b, (s, 1.0), real, depth, turns)
        return self.part(segment, segment.a, middle, (0.0, s), real, depth, turns) + second

    def _beside_infinity(self, segment: Segment, real: bool) -> tuple[float, Solved] | None:
        """Return a point close behind the beginning of a segment, if a multiplier is infinite to rounding at its beginning, and hides the others.

        This happens at a border. None if it is not so, or if the border is crossed at the beginning itself.
        """
        engine, place = self.engine, self.engine.settings.close / max(segment.length, TINY)
        if engine.detection != "map" or not place < 1.0 or not _hidden(engine, segment.a):
            return None
        start = segment.at(place)
        if start is None or _hidden(engine, start) or (engine.smallest_margin(start.row) >= MARGIN) != real:
            return None
        return place, start

    def _of_all_kinds(self, segment: Segment, found: list[Located]) -> list[Located]:
        """Return `found` and the special points of each kind; each search receives the points found before it."""
        for kind in self.kinds:
            found = [*found, *self._of_kind(kind, segment, found)]
        return found

    def _of_kind(self, kind: Kind, segment: Segment, found: Sequence[Located]) -> list[Located]:
        """Return the special points of a kind: the result of its own search, or the verified zeros of its test functions.

        If the ends of the segment give no test function, the parts before and behind each fold are searched: each may contain a point.
        """
        if kind.find is not None:
            return kind.find(segment, found)
        assert kind.tests is not None
        if tests := kind.tests(segment):
            return self._zeros(kind, segment, tests)
        around: list[Located] = []
        for fold in found:
            if fold.kind == "fold":
                place = fold.position
                for ends, places in (
                    ((segment.a, fold.point), (0.0, place)),
                    ((fold.point, segment.b), (place, 1.0)),
                ):
                    part = Segment(self.engine, *ends)
                    around += moved(self._zeros(kind, part, kind.tests(part)), *places)
        return around

    def _zeros(self, kind: Kind, segment: Segment, tests: Iterable[Test]) -> list[Located]:
        """Return the zeros of test functions on a segment that the kind verifies."""
        found = []
        for test in tests:
            root = locate(segment, test.function, jump=test.jump)
            if root is None or not root.continuous:
                continue
            if verified(kind, PointOnBranch(self.engine, root.point, segment)):
                found.append(
                    with_rounding_error(segment, Located.at(root, kind.name, test.index), test.function)
                )
        return found

    def _user_zeros(self, segment: Segment) -> list[Located]:
        """Return the zeros of user-defined tests."""
        found = []
        for number, test in enumerate(self.own):
            if (test.at(segment.a) >= 0.0) != (test.at(segment.b) >= 0.0):
                role = Role.STOP if test.kind.ends else Role.SPECIAL
                events = self._zeros(test.kind, segment, [Test(test.at, number)])
                found += [replace(event, role=role, name=test.name) for event in events]
        return found

    # ------------------------------------------------------------------ where a branch ends
    def _branch_end(
        self, segment: Segment, real: bool, depth: int
    ) -> tuple[list[Located], list[Located] | None]:
        """Return the border or the meeting at which the branch ends, and the special points before it; None instead of the latter if not yet searched."""
        settings, (border, last) = self.engine.settings, border_of(segment, real)
        if border is not None and depth < settings.halvings:
            # behind a border multipliers may return from infinity: counts at the two ends cannot be compared
            short = border.position - settings.close / segment.length
            if not short > 0.0:
                return [border], []
            if last is not None:
                found = self.part(segment, segment.a, last, (0.0, short), real, depth + 1)
                return [border], found + moved(
                    self._at_border(Segment(self.engine, last, border.point)), short, border.position
                )
        meeting = self._meeting(segment)
        if meeting is not None:
            # the branch behind a meeting is the mirror image of that before it, and has the same special points again
            short = meeting.position - max(settings.aside * meeting.position, settings.near / segment.length)
            if not short > 0.0:
                return [meeting], []
            last = segment.at(short)
            if last is not None:
                return [meeting], self.part(segment, segment.a, last, (0.0, short), real, depth)
        return [event for event in (meeting, border) if event is not None], None

    def _at_border(self, end: Segment) -> list[Located]:
        """Return the special points on the last, short segment before a border, if counts at its ends differ and are reliable."""
        engine, (before, after) = self.engine, end.counts
        if before == after or not end.length > engine.settings.resolution:
            return []
        if engine.detection != "map" or engine.adaptive:  # of cycles on meshes multipliers jump by rounding
            return []
        # counts are unreliable with a multiplier that grows without bound; one on the circle belongs to the border
        unbounded = np.abs(engine.spectrum(end.b.row)).max(initial=0.0) >= LIMITS.unbounded
        if unbounded or _hidden(engine, end.b) or on_circle(engine, end.b, LIMITS.agreeing):
            return []
        found = self._of_all_kinds(end, [])
        middle = end.at(0.5) if has_unexplained_change(end, found) else None
        return [e for e in found if not e.astray] + ([] if middle is None else [unresolved(end, middle)])

    def _meeting(self, segment: Segment) -> Located | None:
        """Return the point at which the branch returns to the fixed space of a symmetry, or None.

        Several symmetries can be met at once: a cycle that shrinks to an equilibrium may meet its mirror image, too. The first symmetry in the problem's
        list then gives the kind.
        """
        engine, settings, events = self.engine, self.engine.settings, list[Located]()
        # with multipliers near the inverse of rounding Newton's method stops at larger corrections: smaller asymmetric parts are noise
        correction = max(segment.a.correction, segment.b.correction)
        least = settings.symmetric * max(1.0, correction / settings.tolerance)
        accuracy = correction if engine.adaptive else np.inf
        for index, test in enumerate(self.symmetries):
            ends = test.part(np.array([segment.a.u, segment.b.u]), [segment.a.p, segment.b.p])
            if not turns_round(test, ends, least, accuracy):
                continue
            row = ends[0] / float(np.sqrt(ends[0] @ ends[0]))

            def along(point: Solved, test: SymmetryTest = test, row: np.ndarray = row) -> float:
                return float(row @ test.part(point.u[None, :], [point.p])[0])

            first, last = along(segment.a), along(segment.b)
            root = locate_singular(segment, along, first / (first - last))
            if root is None and (root := locate(segment, along)) is not None:
                root = locate_singular(segment, along, root.position) or root
            if root is not None:
                at = test.symmetry.kind_at
                kind = test.kind if at is None else at(root.point.u)
                events.append(Located.at(root, kind, index, Role.MEETING, is_jump(segment, root)))
        if not events:
            return None
        first_met = min(events, key=lambda event: event.position).point
        return next(e for e in events if engine.distance(e.point, first_met) <= settings.one_place)

    # ------------------------------------------------------------------ special points that the ends of a segment do not show
    def evidence_of(self, points: Sequence[Solved]) -> Evidence:
        """Return the evidence at some points."""
        return evidence(self.engine, packed(points, Status.RUNNING), self.own)

    def inside(self, segment: Segment, real: bool, columns: Iterable[int] = ()) -> Split | None:
        """Return a point inside a segment whose evidence differs from that of both ends, with its position, or None.

        Points at `PLACES` are tried first. Then, for each suspicious distance, points are tried nearer and nearer to its smallest absolute value, as
        long as the parabola through three of them crosses zero. For the smallest margin, which may be shaped like a roof, all zooms are done.

        Parameters
        ----------
        segment : Segment
        real : bool
            Whether its ends have positive margins.
        columns : iterable of int
            Suspicious distances, as `Evidence.distance` counts them.
        """
        if not real and (window := self.passed(segment)) is not None:
            return window
        ends = self.evidence_of([segment.a, segment.b])
        first = sample = self._sampled(segment, PLACES, ends, real)
        for column in columns:
            sample, low, high, outer = first, 0.0, 1.0, ends.distance(column)
            roof = column == ends.first_margin - 1
            for _ in range(ROOF_ZOOMS if roof else ZOOMS):
                if sample.split is not None or not sample.points:
                    break
                values = np.array([outer[0], *sample.evidence.distance(column), outer[1]])
                around = np.array([low, *sample.places, high])
                k = int(np.nan_to_num(np.abs(values[1:-1]), nan=np.inf).argmin()) + 1
                three, gaps = values[k - 1 : k + 2], np.diff(around[k - 1 : k + 2])
                if not (roof or parabola_dips(*(three * np.sign(three[0])), *gaps)):
                    break
                low, high, outer = around[k - 1], around[k + 1], three[::2]
                sample = self._sampled(segment, low + (high - low) * PLACES, ends, real)
            if sample.split is not None:
                break
        return sample.split

    def _sampled(self, segment: Segment, places: np.ndarray, ends: Evidence, real: bool) -> _Sample:
        """Return points of a segment at some positions, their evidence, and the first point whose evidence differs from that of both ends."""
        found = [(s, p) for s, p in zip(places.tolist(), segment.several(places)) if p is not None]
        if not found:
            return _Sample([], [], ends, None)
        points, (one, other) = [point for _, point in found], ends.sides
        inside = self.evidence_of(points)
        new = ((inside.sides - one) * (inside.sides - other) * inside.sides * one * other != 0).any(axis=1)
        if real and not ends.outside.any():
            new |= inside.outside
        elif not real and ends.outside.all():
            new |= inside.distances[:, -1] > self.engine.settings.shown
        return _Sample([s for s, _ in found], points, inside, found[new.argmax()] if new.any() else None)

    def inside_single(self, segment: Segment, real: bool) -> Split | None:
        """Return the same as `inside` for a segment without neighbouring points.

        The middle of the segment is the third point of the parabolas that decide whether to search further.
        """
        ends = self.evidence_of([segment.a, segment.b])
        sample = self._sampled(segment, np.array([0.5]), ends, real)
        if sample.split is not None:
            return sample.split
        if sample.points:
            rows = np.array([segment.a.row, sample.points[0].row, segment.b.row])
            if not self.engine.many and reached(self.engine, rows, np.array([0.5, 0.5])).any():
                split = self.halved(segment, real)
                if split is not None:
                    return split
            (first, last), middle = ends.distances, sample.evidence.distances[0]
            side = np.sign(middle)
            dips = parabola_dips(side * first, side * middle, side * last, 0.5, 0.5)
            if columns := np.flatnonzero(dips[: len(dips) - (not real)]).tolist():
                return self.inside(segment, real, columns)
        return None if real else self.passed(segment)

    def halved(
        self, segment: Segment, real: bool, neighbours: Sequence[tuple[float, np.ndarray]] = ()
    ) -> Split | None:
        """Return the same as `inside` for a segment on which a multiplier may have reached the circle and returned.

        The segment is halved; then, repeatedly, those of its parts on which, by all points so far, a multiplier may still have reached the circle.
        `neighbours` are the rows of the points before and behind the segment, with their positions.
        """
        ends = self.evidence_of([segment.a, segment.b])
        sampled, halves = [*neighbours, (0.0, segment.a.row), (1.0, segment.b.row)], np.array([0.5])
        for _ in range(HALVINGS):
            sample = self._sampled(segment, halves, ends, real)
            if sample.split is not None or not sample.points:
                return sample.split
            sampled = sorted(
                [*sampled, *((s, point.row) for s, point in zip(sample.places, sample.points))],
                key=itemgetter(0),
            )
            places, rows = np.array([s for s, _ in sampled]), np.array([row for _, row in sampled])
            unsure = reached(self.engine, rows, np.diff(places)) & (places[:-1] >= 0.0) & (places[1:] <= 1.0)
            halves = 0.5 * (places[:-1] + places[1:])[unsure]
            if not len(halves):
                break
        return None

    def passed(self, segment: Segment) -> Split | None:
        """Return a real point inside a virtual segment, with its position, or None.

        It exists if the margins that are negative at the beginning become positive before others become negative.
        """
        engine = self.engine
        one, other = (engine.margins(end.row) < MARGIN for end in (segment.a, segment.b))
        if not (one.any() and other.any()) or (one & other).any():
            return None
        begins, ends = (first_zero(segment, np.flatnonzero(negative), False) for negative in (one, other))
        if begins is None or ends is None or not begins.position < ends.position:
            return None
        middle = 0.5 * (begins.position + ends.position)
        point = segment.at(middle)
        if point is None or float(engine.smallest_margin(point.row)) < engine.settings.shown:
            return None
        return middle, point

    def before_border(self, segment: Segment, border: Located) -> Split | None:
        """Return a point before a border at which another margin is negative although it is positive at both ends, with its position, or None."""
        engine, place = self.engine, border.position
        if not 0.0 < place < 1.0:
            return None
        left, middle, right = (
            engine.margins(point.row) - MARGIN for point in (segment.a, border.point, segment.b)
        )
        if (middle < 0.0).any():  # as the margin of a flight that ends within the segment
            return place, border.point
        rows, found = segment.rows(place * PLACES)
        for s in place * PLACES[found & (engine.smallest_margin(rows) < MARGIN)]:
            if (point := segment.at(s)) is not None:
                return float(s), point
        parts = place * segment.length, (1.0 - place) * segment.length
        columns = 2 + len(self.own) + np.flatnonzero(parabola_dips(left, middle, right, *parts))
        part = Segment(engine, segment.a, border.point)
        inside = self.inside(part, True, columns.tolist()) if len(columns) else None
        if inside is None or not engine.smallest_margin(inside[1].row) < MARGIN:
            return None
        # position along the chord of the whole segment
        gap = engine.join(inside[1].u, inside[1].p) - segment.za
        return float(segment.border @ gap) / segment.length, inside[1]


def moved(events: Iterable[Located], low: float, high: float) -> list[Located]:
    """Convert positions of events on a part of a segment, from `low` to `high`, to positions on the whole segment."""
    return [replace(event, position=low + (high - low) * event.position) for event in events]


def _hidden(engine: Engine, point: Solved) -> bool:
    """Whether a point is at a border where a multiplier is so large that its rounding hides the side of another one near the circle."""
    if abs(engine.smallest_margin(point.row)) >= engine.settings.inside:
        return False
    sizes = np.sort(np.abs(engine.spectrum(point.row)))
    near = np.abs(sizes[:-1] - 1.0).min(initial=np.inf) <= EPSILON * sizes.max(initial=0.0)
    return bool(near or not np.isfinite(sizes).all())
