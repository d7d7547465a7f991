"""The special points of one segment of a branch: all kinds are asked in one loop, and what they find is checked for consistency."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from ..continuation.engine import Engine, Solved
from .consistency import unaccounted, unresolved
from .dips import below_zero
from .first_border import find_border, rounding
from .kind import Kind, Test
from .kinds import BY_NAME, KINDS
from .locate import locate, locate_singular
from .located import NOWHERE, Located, Role
from .location_error import blurred
from .one_sided_limits import one_sided
from .point_on_branch import PointOnBranch
from .segment import Segment
from .singular import singular
from .symmetry_test import SymmetryTest
from .user_functions import own_tests

CLEAR = 1e-4  # distance from a meeting (in the metric) within which tangents and multipliers are those of its singular equations
SAME = 1e-4  # part of a segment: what is closer is one


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
        functions: Mapping[str, Any] | None = None,
        stops: Iterable[str] = (),
    ) -> None:
        self.engine = engine
        self.kinds = [kind for kind in kinds if kind.tests or kind.find]
        # multipliers of smooth flows jump by rounding alone, as beside homoclinic orbits: parts of parts tell no more
        self.deepest = 1 if engine.adaptive else engine.settings.halvings
        scale = None if engine.plain else engine.scale[:-1]
        self.symmetries = [SymmetryTest(s, engine.n, engine.shift, scale) for s in engine.problem.symmetries]
        self.own = own_tests(engine, kinds, functions or {}, tuple(stops), BY_NAME["user"])

    def search(self, segment: Segment, real: bool = True, depth: int = 0) -> list[Located]:
        """The special points of one segment (positions in [0, 1]), those of users' tests apart."""
        stop, before = self._stop(segment, real, depth)
        if before is not None:
            return [*before, *stop]
        found = stop
        for kind in self.kinds:
            found = [*found, *self._of_kind(kind, segment, found)]
        found = _without_turnings(found)
        if not unaccounted(segment, found):
            return found
        middle = segment.at(0.5)
        if middle is None:
            return found
        if depth < self.deepest and segment.length > self.engine.settings.resolution:
            return self.both(segment, 0.5, middle, real, depth + 1)
        return [*found, unresolved(segment, middle)]

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
        if kind.verify is not None and not kind.verify(point):
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
                    found.append(event._replace(position=start + length * event.position))
        return found

    # ------------------------------------------------------------------ where a branch ends
    def _stop(self, segment: Segment, real: bool, depth: int) -> tuple[list[Located], list[Located] | None]:
        """The border or the meetings at which the branch ends, and the special points before; None where these are not looked for yet."""
        borders, last = self._borders(segment, real)
        if borders and depth < self.engine.settings.halvings:
            # behind a border multipliers may come back from infinity, and what they say of both ends together is nothing
            short = borders[0].position - self.engine.settings.close / segment.length
            if not short > 0.0:
                return borders, []
            if last is not None:
                return borders, self.before(segment, short, last, real, depth + 1)
        events = self._meetings(segment)
        if events:
            # behind a meeting lies the image of what is before it, so that what was passed before it is passed again
            first = min(e.position for e in events)
            short = first - max(self.engine.settings.aside * first, CLEAR / segment.length)
            if not short > 0.0:
                return events, []
            last = segment.at(short)
            if last is not None:
                return events, self.before(segment, short, last, real, depth)
        return [*events, *borders], None

    def _borders(self, segment: Segment, real: bool) -> tuple[list[Located], Solved | None]:
        border = find_border(segment, real)
        if border is None:
            return [], None
        root, index = border
        kind = self.engine.problem.margin_kind(index)
        point, before = one_sided(segment, root)
        blur = rounding(segment, root, index, before)
        found = Located(root.position, kind, index, point, NOWHERE, root.error, Role.BORDER, "", blur)
        return [found], before

    def _meetings(self, segment: Segment) -> list[Located]:
        events = []
        for index, test in enumerate(self.symmetries):
            ends = test.part(np.array([segment.a.u, segment.b.u]), [segment.a.p, segment.b.p])
            if not (
                ends[0] @ ends[1] < 0.0 and np.abs(ends).max(axis=1).min() > self.engine.settings.symmetric
            ):
                continue
            scale = float(np.sqrt(ends[0] @ ends[0]))

            def along(point: Solved, test: SymmetryTest = test, row: np.ndarray = ends[0] / scale) -> float:
                return float(row @ test.part(point.u[None, :], [point.p])[0])

            first, last = along(segment.a), along(segment.b)
            root = locate_singular(segment, along, first / (first - last)) or locate(segment, along)
            if root is not None:
                root = locate_singular(segment, along, root.position) or root
                at = test.symmetry.kind_at
                kind = test.kind if at is None else at(root.point.u)
                known = self.engine.many or segment.length <= self.engine.settings.resolution
                kind = kind if known or singular(self.engine, root.point) else "astray"
                events.append(Located.at(root, kind, index, Role.MEETING))
        return events

    # ------------------------------------------------------------------ tests of users
    def own_points(
        self, number: int, segment: Segment, ends: Sequence[float], dips: bool = False
    ) -> list[Located]:
        """Zeros of one of the users' tests on a segment at whose ends it has these values; two of them where it dips."""
        own, (one, other) = self.own[number], ends
        parts = [(0.0, segment, 1.0)]
        if (one >= 0.0) == (other >= 0.0):
            side = 1.0 if one >= 0.0 else -1.0
            inside = below_zero(segment, lambda point: side * own.at(point)) if dips else None
            if inside is None:
                return []
            s, middle = inside
            halves = Segment(self.engine, segment.a, middle), Segment(self.engine, middle, segment.b)
            parts = [(0.0, halves[0], s), (s, halves[1], 1.0 - s)]
        role = Role.STOP if own.kind.ends else Role.SPECIAL
        found = []
        for start, part, length in parts:
            event = self.zero(own.kind, part, Test(own.at, number))
            if event is not None:
                position = start + length * event.position
                found.append(event._replace(position=position, role=role, name=own.name))
        return found

    # ------------------------------------------------------------------ parts of segments
    def before(self, segment: Segment, s: float, middle: Solved, real: bool, depth: int = 0) -> list[Located]:
        """The special points of the first part of a segment."""
        part = self.search(Segment(self.engine, segment.a, middle), real, depth)
        return [e._replace(position=s * e.position) for e in part]

    def both(self, segment: Segment, s: float, middle: Solved, real: bool, depth: int = 0) -> list[Located]:
        """The special points of a segment from its two parts."""
        second = self.search(Segment(self.engine, middle, segment.b), real, depth)
        return self.before(segment, s, middle, real, depth) + [
            e._replace(position=s + (1.0 - s) * e.position) for e in second
        ]


def _without_turnings(found: list[Located]) -> list[Located]:
    """Without folds at branch points of the segment: a side branch may turn where it meets the other one."""
    points = [e.position for e in found if e.kind == "branch-point"]
    return [e for e in found if e.kind != "fold" or not any(abs(e.position - s) <= SAME for s in points)]
