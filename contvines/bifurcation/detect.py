"""Detection of special points along a branch: select the segments that may contain some, and search each of them with :mod:`.segment_search`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cached_property
from operator import attrgetter

import numpy as np

from ..continuation.engine import Engine, Solved
from ..continuation.layout import Chunk, Status
from ..problems.abilities import Nearing
from ..shared.numbers import EPSILON
from .consistency import at_one, branch_jump
from .evidence import evidence, fill_zeros, has_kink, kinks, may_be_real, nearest, possible_dips
from .locate import Located, Role, Segment, locate
from .location_error import rounding_of_parameter
from .scan import Scan, counts, scanner, turns_round
from .segment_search import SegmentSearch
from .settings import LOCATING

# the segment next to a branch point, whose beginning is not searched because solutions there are nearly singular:
UNSEARCHED = 0.02  # part of it that is not searched
LARGEST_UNSEARCHED = 0.5  # largest part that is not searched
SHRINKING = 0.25  # factor by which this part shrinks if the evidence at its end shows a special point on it

LANDS = 0.1  # a step lands next to a meeting if it ends at less than this part of its first distance from the fixed space


POSITION = attrgetter("position")


class Detector(SegmentSearch):
    """Finds the special points along a branch: a search of segments, applied to the segments that may contain special points."""

    @cached_property
    def scan(self) -> Callable[[Chunk], Scan]:
        """Function that scans a chunk in one pass; `look` needs its result."""
        return scanner(self.engine, self.symmetries)

    def look(self, chunk: Chunk, scanned: Scan, real: bool = True) -> list[Located]:
        """Return all special points on a chunk, in order, up to the first border, meeting, leap or landing.

        Parameters
        ----------
        chunk : Chunk
        scanned : Scan
            Scan of the chunk.
        real : bool
            Whether the branch has positive margins; on a virtual branch the return to positive margins is the border.

        Returns
        -------
        list of Located
            Positions count segments of the chunk: index of the point before plus the fraction of the segment.
        """
        if len(chunk) < 2:
            return []
        engine, many = self.engine, self.engine.many
        wide = chunk.widened() if len(chunk) == 2 else chunk  # two points are too few for a parabola
        extra = len(wide) - len(chunk)
        if extra:
            scanned = self.scan(wide)
        meetings, landings = self._meetings_and_landings(wide, scanned)
        if scanned.quiet and not (self.own or meetings.any() or landings.any()):
            return []
        lengths, observed = scanned.lengths, evidence(engine, wide, self.own, scanned)
        sides, outside = fill_zeros(observed.sides), observed.outside
        borders = (outside[1:] != outside[:-1]) & (outside[1:] == real)
        differs = (sides[1:] != sides[:-1]).any(axis=1) | borders | meetings
        columns, inside = possible_dips(observed, scanned)
        smallest = observed.first_margin - 1
        inside[:, smallest] = False if real else may_be_real(observed, lengths)
        inside[borders if real else slice(None), smallest + 1 :] = False
        inside[meetings] = (
            False  # a branch that returns to a symmetry's fixed space is marginal there; it is not split
        )
        may_reach = (scanned.reached > 0.0) & (not many) & ~meetings
        sharp = kinks(nearest(engine, wide.rows, scanned.spectra), sides[:, 1], lengths) & ~meetings
        searched = differs | sharp | may_reach | inside.any(axis=1)
        movable = landings[extra:] if chunk.status == Status.RUNNING else landings[extra:-1]
        landed = int(movable.argmax()) if movable.any() else None
        events: list[Located] = []
        for i in np.flatnonzero(searched[extra:][:landed]).tolist():
            k = i + extra
            one, other = (chunk.solved(i + j, float(sides[k + j, 1])) for j in (0, 1))
            segment = Segment(engine, one, other)
            split = self.inside(segment, real, columns[inside[k]].tolist()) if inside[k].any() else None
            if split is None and may_reach[k]:
                split = self.halved(segment, real, _neighbours(wide, lengths, k))
            if many and sharp[k]:
                found = self._by_eigenvalues(segment, real)
            elif split is not None:
                found = [*self.both(segment, *split, real), Located(*split, role=Role.PLAIN)]
            elif differs[k]:
                found = self.search(segment, real)
                border = next((e for e in found if e.role is Role.BORDER), None)
                split = self.before_border(segment, border) if real and border else None
                if split is not None:
                    found = self.both(segment, *split, real)
            elif sharp[k] and has_kink(segment):
                return [*events, Located(float(i), segment.a, role=Role.LEAP)]
            else:
                continue
            if sharp[k] and not (many or found) and has_kink(segment):
                return [*events, Located(float(i), segment.a, role=Role.LEAP)]
            found, leaping = self._without_spurious(segment, found)
            if leaping is not None and leaping.role is Role.LEAP:
                return [*events, replace(leaping, position=float(i))]
            found = sorted([*found, leaping], key=POSITION) if leaping is not None else found
            found = self._cut_at_bounds(segment, found)
            bracket = (float(chunk.values[i]), float(chunk.values[i + 1]))
            # an interpolated point may lie just outside its segment
            found = [_placed(e, i + min(max(e.position, 0.0), 1.0 - EPSILON), bracket) for e in found]
            stop = next((e for e in found if e.ends_branch), None)
            if stop is not None:
                # where a stick or flight vanishes p is stationary: a fold at the border is not a point of its own
                found = [e for e in found if e is stop or self._distinct_from_end(e, stop)]
                events = [e for e in events if self._distinct_from_end(e, stop)]
            events += up_to_end(found)
            if stop is not None:
                return events
        if landed is None:
            return events
        return [*events, Located(float(landed), chunk.solved(landed), role=Role.LANDING)]

    def _without_spurious(
        self, segment: Segment, found: list[Located]
    ) -> tuple[list[Located], Located | None]:
        """Return the special points in order, without spurious ones and those whose error exceeds the interval; and a mark if the ends show a leap."""
        found = sorted(found, key=POSITION)
        leaping, most = branch_jump(segment, found), self.engine.upper - self.engine.lower
        special = [
            e for e in found if not (e.astray or (e.role is Role.SPECIAL and not e.name and e.error > most))
        ]
        return [replace(e, error=max(e.error, e.rounding)) for e in special], leaping

    def opening(self, origin: Solved, first: Solved, real: bool = True) -> list[Located]:
        """Return the special points between a branch point and the first point of a branch that leaves it, in order; a leap comes last.

        The beginning of the segment is not searched, as solutions there are those of a nearly singular system. It is searched if the evidence at its
        end shows a special point on it.
        """
        whole, settings = Segment(self.engine, origin, first), self.engine.settings
        share = UNSEARCHED
        if whole.length > 0.0:
            share = min(max(UNSEARCHED, settings.close / whole.length), LARGEST_UNSEARCHED)
        start = first_start = whole.at(share)
        beyond = share
        while start is not None and share * whole.length > settings.resolution:
            if not self._parameter_differs(origin, start) or not self._point_between(origin, start):
                break
            closer = whole.at(SHRINKING * share)
            if closer is None:
                break
            share, start = SHRINKING * share, closer
        if start is None or first_start is None:
            return []
        segment = Segment(self.engine, start, first)
        split = self.inside_single(segment, real)
        if share < beyond:
            split = (beyond - share) / (1.0 - share), first_start
        found = self.search(segment, real) if split is None else self.both(segment, *split, real)
        found, leaping = self._without_spurious(segment, found)
        # at the branch point itself the parameter is stationary: on a flat branch rounding imitates folds and branch points next to it
        flat = settings.rounding * max(self.engine.parameter_unit(origin.p), abs(origin.p))
        found = [
            _placed(e, share + (1.0 - share) * e.position, (origin.p, first.p))
            for e in found
            if e.kind not in ("fold", "branch-point")
            or self._parameter_differs(origin, e.point, max(flat, 10.0 * e.error))
        ]
        leaps = leaping is not None and leaping.role is Role.LEAP
        return up_to_end(found) + ([leaping] if leaping is not None and leaps else [])

    def _parameter_differs(self, origin: Solved, point: Solved, error: float = 0.0) -> bool:
        """Whether the parameter of a point differs from that of a branch point by at least its error and rounding."""
        if self.engine.adaptive:  # on another mesh the origin itself is shifted, within its error
            error = max(error, rounding_of_parameter(self.engine, point), origin.correction)
        return abs(point.p - origin.p) >= error

    def _point_between(self, origin: Solved, start: Solved) -> bool:
        """Whether multipliers have crossed the circle, or the parameter has turned, between a branch point and a point beside it.

        Borders need no test: first points are so near that their margins have the signs of the branch point's margins.
        """
        engine, settings = self.engine, self.engine.settings
        unit, gap = engine.parameter_unit(origin.p), engine.join(start.u - origin.u, start.p - origin.p)
        # three directions of the parameter, away from the branch point: at the branch point, of the chord, and at the start
        away = float(np.sign(engine.inner(origin.tangent, gap))) * float(origin.tangent[-1])
        ways = (
            (away, settings.stationary * unit),
            (start.p - origin.p, settings.rounding * max(unit, abs(origin.p))),
            (float(start.tangent[-1]), engine.upright(origin.p)),
        )
        return len({way > 0.0 for way, least in ways if abs(way) > least}) > 1 or self._multipliers_crossed(
            origin, start
        )

    def _multipliers_crossed(self, origin: Solved, start: Solved) -> bool:
        """Whether multipliers (eigenvalues) have crossed the circle (the axis) since a branch point, apart from those that are critical there.

        None has crossed if the numbers past -1 and of pairs are unchanged, and the total is that of the branch point's other multipliers plus at most
        the number of critical ones.
        """
        engine = self.engine
        if engine.detection not in ("map", "flow"):
            return False
        (_, *before), (plus, *after) = counts(engine, np.array([origin.row, start.row])).tolist()
        spectrum = engine.spectrum(origin.row)
        gaps = np.abs(spectrum - (1.0 if engine.detection == "map" else 0.0))
        critical = gaps <= max(engine.settings.critical, float(gaps.min(initial=np.inf)))
        sizes = np.abs(spectrum) - 1.0 if engine.detection == "map" else spectrum.real
        others = int((sizes[~critical] > LOCATING.past).sum())
        return before != after or not 0 <= plus + after[0] + 2 * after[1] - others <= int(critical.sum())

    def _meetings_and_landings(self, chunk: Chunk, scanned: Scan) -> tuple[np.ndarray, np.ndarray]:
        """Return two masks of segments, shape (n - 1,): those with a meeting, and those that land next to one.

        At a meeting the branch crosses the fixed space of a symmetry: the asymmetric part u - T(u) changes its sign. A doubled branch is as singular
        there as at any branch point. The nearer a point, the more rounding mixes the other branch into its tangent, so that its evidence is
        useless; the step is repeated with another length.
        """
        meetings, landings = (np.zeros(len(scanned.lengths), dtype=bool) for _ in range(2))
        for test, size, turn in zip(self.symmetries, scanned.sizes, scanned.turns):
            far = size > self.engine.settings.symmetric
            meetings |= far[1:] & far[:-1] & (turn < 0.0)
            for i in np.flatnonzero((turn < 0.0) & ~meetings).tolist() if self.engine.adaptive else ():
                pair = slice(i, i + 2)
                parts = test.part(chunk.points[pair], chunk.values[pair])
                meetings[i] = turns_round(test, parts, np.inf, float(chunk.corrections[pair].max()))
            landings |= far[:-1] & (size[1:] < self.engine.settings.near) & (size[1:] < LANDS * size[:-1])
        return meetings, landings

    def _by_eigenvalues(self, segment: Segment, real: bool) -> list[Located]:
        """Return the special points of a segment of a problem with many unknowns, found from its eigenvalues."""
        search = self._eigenvalue_search
        whole = Segment(search.engine, segment.a, segment.b)
        a, b = whole.at(0.0), whole.at(1.0)
        if a is None or b is None:
            return []
        a = a._replace(tangent=segment.a.tangent, sign=segment.a.sign)
        b = b._replace(tangent=segment.b.tangent, sign=segment.b.sign)
        return search.search(Segment(search.engine, a, b), real)

    @cached_property
    def _eigenvalue_search(self) -> SegmentSearch:
        """Search in the same problem, with eigenvalues computed at each point."""
        problem = self.engine.problem
        assert isinstance(problem, Nearing)
        engine = Engine(problem.closer(), self.engine.within, self.engine.settings)
        search = SegmentSearch(engine, self.kinds)
        search.own = self.own
        return search

    def _cut_at_bounds(self, segment: Segment, events: list[Located]) -> list[Located]:
        """Cut the events at the parameter bound if the branch leaves the interval within the segment, turns back outside and re-enters."""
        engine = self.engine
        for k, event in enumerate(events):
            bound = min(max(event.point.p, engine.lower), engine.upper)
            error = max(event.error, engine.settings.rounding * engine.parameter_unit(bound))
            if abs(event.point.p - bound) <= error:
                continue
            root = locate(Segment(engine, segment.a, event.point), lambda point, bound=bound: point.p - bound)
            if root is not None:
                found = engine.at_value(root.point.u, bound, root.point.tangent) or root.point
                place = event.position * root.position
                return [*(e for e in events[:k] if e.position < place), Located(place, found, role=Role.LEFT)]
        return events

    def _distinct_from_end(self, event: Located, stop: Located) -> bool:
        """Whether an event is distinct from the end of the branch nearby.

        Bifurcations, and folds with a multiplier +1, may be nearer to the end than other events.
        """
        engine, settings = self.engine, self.engine.settings
        own = event.kind not in ("fold", "branch-point") or (
            engine.detection == "map" and at_one(engine, event)
        )
        return engine.distance(event.point, stop.point) > (settings.at_end if own else settings.one_place)


def _neighbours(chunk: Chunk, lengths: np.ndarray, i: int) -> list[tuple[float, np.ndarray]]:
    """Return the points before and behind segment i of a chunk, as (position relative to the segment, row)."""
    before = [(-lengths[i - 1] / lengths[i], chunk.rows[i - 1])] if i > 0 else []
    return before + ([(1.0 + lengths[i + 1] / lengths[i], chunk.rows[i + 2])] if i + 1 < len(lengths) else [])


def _placed(event: Located, position: float, bracket: tuple[float, float]) -> Located:
    """Return an event with another position and bracket; unresolved ones keep their bracket."""
    return replace(
        event, position=position, bracket=event.bracket if event.role is Role.UNRESOLVED else bracket
    )


def up_to_end(events: list[Located]) -> list[Located]:
    """Return the events up to and including the first one at which the branch ends."""
    stop = next((i for i, event in enumerate(events) if event.ends_branch), len(events))
    return events[: stop + 1]
