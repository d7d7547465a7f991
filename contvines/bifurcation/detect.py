"""Detection: in which segments of a branch may there be special points? Each of them is searched; see :mod:`.segment_search`."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np

from ..continuation.aims import LIMIT
from ..continuation.chunk import Chunk
from ..continuation.engine import Engine, Solved
from ..continuation.loop import MARGIN
from . import complex_pairs as pairs
from .branch_jumps import inexact, leap
from .dips import before_border, below_zero
from .left_interval import left_between
from .located import Located, Role
from .multiplier_counts import balance, counts, nearest_to_circle
from .near_symmetric_step import again, first_landing
from .real_intervals import passed, real_inside, windows
from .scan import Scan, Scanner, dips
from .scan_arrays import dips as all_dips
from .scan_arrays import turns_and_landings
from .segment import Segment
from .segment_flags import BORDER, DAMPED, HUMP, LANDING, MEETING, MULTIPLIER, SHALLOW, SINGULAR
from .segment_search import SegmentSearch

# beside the bits of a scan: a user function changes its sign; a real multiplier, or a complex pair, may do so twice; a pair comes about;
# a virtual branch may be real in between
USER, TWICE, PAIRS, BORN, WINDOW = 256, 512, 1024, 2048, 4096
INSIDE = SHALLOW | DAMPED | HUMP | TWICE | PAIRS | BORN | WINDOW  # what the ends of a segment do not tell
NO_MARGIN = 1e-13  # something has no length or speed at all
AT_END = 1e-7  # bifurcations closer than this to the end of a branch are the end
REACH, EDGE = (
    1.5,
    0.9,
)  # lengths of a segment within which the distance to a singular matrix, continued, may be zero
BESIDE = 0.02  # part of the segment next to a branch point that is left out ...
MOST = 0.5  # ... but not more


class Detector(SegmentSearch):
    """What to look for along a branch: a search of segments, which is shown those that may hold something."""

    @cached_property
    def scanner(self) -> Scanner:
        """Finds those segments."""
        return Scanner(self.engine, self.symmetries)

    def scan(self, chunk: Chunk, real: bool = True) -> Scan:
        """Marks segments of a chunk that may hold something, and finds the smallest margins; see :meth:`look`."""
        wide = _wide(chunk)
        scan = self.scanner(
            wide.points, wide.values, wide.tangents, wide.rows, without_zeros(wide.signs), real
        )
        own = len(wide) - len(chunk)
        return Scan(scan.flags[own:], scan.smallest[own:]) if own else scan

    def look(self, chunk: Chunk, scan: Scan, real: bool = True) -> list[Located]:
        """All special points on a chunk, in order; what lies behind a border, a meeting, a leap or a landing is left out.

        Parameters
        ----------
        chunk : Chunk
        scan : Scan
            Of the chunk.
        real : bool
            Whether the branch has positive margins; on a virtual one the return to positive margins is the border.
        """
        n = len(chunk)
        if n < 2:
            return []
        flags = scan.flags.copy()
        if real and scan.smallest[0] < MARGIN and not (scan.smallest[1:] < MARGIN).all():
            flags[scan.smallest[1:] < MARGIN] |= BORDER
        for test in self.scanner.left_out:
            turns, lands = turns_and_landings(test.part(chunk.points, chunk.values))
            flags[turns] |= MEETING
            flags[lands] |= LANDING
        close: set[int] = set()
        wide = _wide(chunk)
        own = len(wide) - len(chunk)
        if self.engine.many:
            close = {i - own for i in self._near_singular(wide).tolist() if i >= own}
            flags[list(close)] |= SINGULAR
        elif self.engine.exchanges:
            sums = balance(self.engine.spectrum(chunk.rows), self.engine.detection)
            flags[changes(np.nan_to_num(sums))] |= MULTIPLIER
            flags[self._twice(wide)[own:]] |= TWICE
        if self.engine.m > 2 and self.engine.detection in ("map", "flow"):
            flags[pairs.touching(self.engine, self.engine.detection, wide)[own:]] |= PAIRS
            flags[pairs.born(self.engine, self.engine.detection, wide)[own:]] |= BORN
        if not real and self.engine.problem.n_margins:
            flags[windows(self.engine, wide)[own:]] |= WINDOW
        own_values = [own.values(chunk) for own in self.own]
        dipping = [_dipping(self.engine, chunk, values) for values in own_values]
        for values, dip in zip(own_values, dipping):
            flags[changes(values) | dip] |= USER
        signs = without_zeros(chunk.signs)
        events: list[Located] = []
        landed = first_landing(chunk, flags)
        for i in flags[:landed].nonzero()[0].tolist():
            bits = int(flags[i])
            segment = Segment(
                self.engine, chunk.solved(i, float(signs[i])), chunk.solved(i + 1, float(signs[i + 1]))
            )
            if bits & BORDER:
                bits &= ~SHALLOW  # what is lost before a border is looked for when that is known
            suspects = self._suspects(wide, i + own) if bits & SHALLOW else []
            split = self._split(segment, bits, suspects) if bits & INSIDE else None
            if i in close:
                found = self._closely(segment, real)
            elif split is not None:
                s, middle = split
                plain = Located(s, "", 0, middle, (np.nan, np.nan), 0.0, Role.PLAIN)
                found = [*self.both(segment, s, middle, real), plain]
            elif bits & ~INSIDE:
                found = self.search(segment, real=real)
                border = min(
                    (e for e in found if e.role is Role.BORDER), key=lambda e: e.position, default=None
                )
                split = before_border(segment, border.position, border.point) if real and border else None
                if split is not None:
                    found = self.both(segment, *split, real)
            else:
                continue
            for k, values in enumerate(own_values):
                found += self.own_points(k, segment, values[i : i + 2].tolist(), bool(dipping[k][i]))
            found.sort(key=lambda e: e.position)
            leaping = leap(segment, found)
            if leaping is not None and leaping.role is Role.LEAP:
                return [*events, leaping._replace(position=float(i))]
            if leaping is not None:
                found = sorted([*found, leaping], key=lambda e: e.position)
            found = [e for e in found if e.kind != "astray" and not self._of_rounding(e)]
            found = [e._replace(error=e.rounding) if e.rounding > e.error else e for e in found]
            outside = left_between(segment, found)
            if outside is not None:
                found = [*(e for e in found if e.position < outside.position), outside]
            bracket = (float(chunk.values[i]), float(chunk.values[i + 1]))
            found = [_placed(e, i + _inside(e.position), bracket) for e in found]
            stop = next((e for e in found if e.ends_branch), None)
            if stop is not None:
                # at a vanishing stick or flight p is stationary: the fold at the border itself is the border
                found = [e for e in found if e is stop or self._apart(e, stop)]
                events = [e for e in events if self._apart(e, stop)]
            events += before_stop(found)
            if stop is not None:
                return events
        return events if landed is None else [*events, again(chunk, landed)]

    def beside(self, origin: Solved, first: Solved, real: bool = True) -> list[Located]:
        """The special points between a branch point and the first point of a branch that leaves it, in order; a leap comes last.

        The beginning of the segment, where every solution is that of a nearly singular system, is left out.
        """
        whole = Segment(self.engine, origin, first)
        share = (
            min(max(BESIDE, self.engine.settings.close / whole.length), MOST)
            if whole.length > 0.0
            else BESIDE
        )
        start = whole.at(share)
        if start is None:
            return []
        segment = Segment(self.engine, start, first)
        window = None if real else passed(segment)
        found = self.search(segment, real) if window is None else self.both(segment, *window, real)
        for k, own in enumerate(self.own):
            found += self.own_points(k, segment, (own.at(start), own.at(first)))
        found.sort(key=lambda e: e.position)
        leaping = leap(segment, found)
        leaping = leaping if leaping is not None and leaping.role is Role.LEAP else None
        # at the branch point the parameter is stationary itself: on a flat branch it seems to turn back, or to branch, where rounding has it
        flat = self.engine.settings.rounding * max(self.engine.parameter_unit(origin.p), abs(origin.p))
        found = [
            e
            for e in found
            # what cannot be located is no special point: the segment leads on to another branch
            if e.kind != "astray"
            and not self._placeless(e)
            and not (e.role is Role.SPECIAL and inexact(segment, e))
            and not (
                e.kind in ("fold", "branch-point") and abs(e.point.p - origin.p) <= max(flat, 10.0 * e.error)
            )
        ]
        bracket = (origin.p, first.p)
        found = [_placed(e, share + (1.0 - share) * e.position, bracket) for e in found]
        return before_stop(found) + ([] if leaping is None else [leaping])

    def _suspects(self, chunk: Chunk, i: int) -> list[int]:
        """The margins that may pass zero and come back in a segment: the parabola through three of their values does."""
        first = max(i - 1, 0)
        margins = self.engine.margins(chunk.rows[first : i + 3]) - MARGIN
        z = np.column_stack([chunk.points[first : i + 3], chunk.values[first : i + 3]])
        lengths = [self.engine.norm(step) for step in np.diff(z, axis=0)]
        found = set()
        for k in range(len(margins) - 2):
            for j, (left, middle, right) in enumerate(margins[k : k + 3].T):
                if dips(left, middle, right, lengths[k], lengths[k + 1]):
                    found.add(j)
        return sorted(found)

    def _near_singular(self, chunk: Chunk) -> np.ndarray:
        """Segments, of a problem with many unknowns, in which an even number of branch points may lie: where the signs at the ends are

        the same, but the distances to a singular matrix, continued from before and from behind, reach zero.
        """
        distance, signs = -chunk.rows[:, 0], without_zeros(chunk.signs)  # negative: none is past zero
        steps = np.diff(np.column_stack([chunk.points, chunk.values]), axis=0)
        lengths = np.sqrt((steps**2) @ self.engine.weights)
        falls, rises = distance[:-1] - distance[1:], distance[1:] - distance[:-1]
        with np.errstate(all="ignore"):
            ahead = np.where(
                falls > 0.0, distance[1:] * lengths / falls, np.inf
            )  # zero behind the segment's end
            back = np.where(rises > 0.0, distance[:-1] * lengths / rises, np.inf)  # ... before its beginning
        # at the ends of a chunk there is only one side to tell: its zero has to lie well inside
        before, behind = np.append(np.inf, ahead[:-1]) / lengths, np.append(back[1:], np.inf) / lengths
        inside = (before < REACH) & (behind < REACH)
        if len(lengths) > 1:
            inside[0], inside[-1] = behind[0] < EDGE, before[-1] < EDGE
        return np.flatnonzero((signs[:-1] == signs[1:]) & inside)

    def _closely(self, segment: Segment, real: bool) -> list[Located]:
        """The special points of a segment of a problem with many unknowns, from eigenvalues."""
        problem: Any = self.engine.problem
        problem.closely = True
        try:
            a, b = segment.at(0.0), segment.at(1.0)
            if a is None or b is None:
                return []
            a = a._replace(tangent=segment.a.tangent, sign=segment.a.sign)
            b = b._replace(tangent=segment.b.tangent, sign=segment.b.sign)
            return self.search(Segment(self.engine, a, b), real=real)
        finally:
            problem.closely = False

    def _twice(self, chunk: Chunk) -> np.ndarray:
        """Segments in which a real multiplier may pass the circle and come back: the parabola through its distances does."""
        spectrum, engine = self.engine.spectrum(chunk.rows), self.engine
        distance, count = (
            nearest_to_circle(spectrum, self.engine.detection),
            counts(spectrum, self.engine.detection)[:, 0],
        )
        steps = np.diff(np.column_stack([chunk.points, chunk.values]), axis=0)
        lengths = np.sqrt((steps**2) @ engine.weights)
        found = np.zeros(len(chunk) - 1, dtype=bool)
        level = (count[:-2] == count[1:-1]) & (count[1:-1] == count[2:])
        falls = (distance[1:-1] < distance[:-2]) | (distance[1:-1] < distance[2:])
        for i in np.flatnonzero(level & falls & (distance[1:-1] < LIMIT)):
            left, middle, right = distance[i : i + 3]
            if dips(left, middle, right, lengths[i], lengths[i + 1]):
                found[i : i + 2] = True
        return found

    def _split(self, segment: Segment, bits: int, suspects: list[int]) -> tuple[float, Solved] | None:
        """A point of the segment where the smallest margin, or one of those suspected, is negative, the parameter turns back, or

        stability is lost, though not at its ends; of a virtual branch, one where it is real.
        """
        if bits & WINDOW and (inside := real_inside(segment)) is not None:
            return inside
        if bits & MEETING:
            # a branch that comes back to a symmetry is marginal there: no point to cut it at
            bits &= ~(DAMPED | TWICE)
        side = np.sign(segment.a.tangent[-1]) / self.engine.parameter_unit(segment.a.p)
        tests = {
            SHALLOW: lambda point: float(self.engine.smallest_margin(point.row)),
            HUMP: lambda point: float(side * point.tangent[-1]),
            DAMPED: lambda point: float(self._damping(point.row)),
            TWICE: lambda point: self._side(point, segment.a),
            PAIRS: lambda point: pairs.side(self.engine, self.engine.detection, point, segment.a),
        }
        wanted = [test for bit, test in tests.items() if bits & bit]
        if bits & BORN and (outside := pairs.outside(segment, self.engine.detection)) is not None:
            return outside
        wanted += [lambda point, j=j: float(self.engine.margins(point.row)[j]) for j in suspects]
        for test in wanted:
            found = below_zero(segment, test)
            if found is not None:
                return found
        return None

    def _side(self, point: Solved, other: Solved) -> float:
        """Distance of the nearest real multiplier from the circle; negative where another number of them is past it."""
        spectrum = self.engine.spectrum(np.array([point.row, other.row]))
        count = counts(spectrum, self.engine.detection)[:, 0]
        distance = float(nearest_to_circle(spectrum, self.engine.detection)[0])
        return distance if count[0] == count[1] else -distance

    def _damping(self, rows: np.ndarray) -> np.ndarray:
        """Positive where stable: minus the logarithm of the largest multiplier (minus the largest real part)."""
        spectrum = self.engine.spectrum(rows)
        if self.engine.detection == "flow":
            return -spectrum.real.max(axis=-1)
        with np.errstate(divide="ignore"):
            return -np.log(np.abs(spectrum).max(axis=-1))

    def _placeless(self, event: Located) -> bool:
        """Whether rounding leaves open where an event is: anywhere in the interval."""
        return bool(event.error > self.engine.upper - self.engine.lower)

    def _of_rounding(self, event: Located) -> bool:
        """Whether a multiplier passes the circle where a margin is zero but for rounding, and the multipliers are rounding as well, or at no known place."""
        if event.role is not Role.SPECIAL or event.name:
            return False
        return self._placeless(event) or bool(abs(self.engine.smallest_margin(event.point.row)) < NO_MARGIN)

    def _apart(self, event: Located, stop: Located) -> bool:
        """Whether an event close to where a branch ends is one of its own: bifurcations are, and folds at which a multiplier is +1."""
        own = event.kind not in ("fold", "branch-point") or self._at_one(event.point)
        return self.engine.distance(event.point, stop.point) > (
            AT_END if own else self.engine.settings.one_place
        )

    def _at_one(self, point: Solved) -> bool:
        spectrum = self.engine.spectrum(point.row)
        return self.engine.detection == "map" and bool(
            np.abs(spectrum - 1.0).min(initial=1.0) <= self.engine.settings.critical
        )


def _wide(chunk: Chunk) -> Chunk:
    """The chunk, with the point before it where its own are too few for a parabola."""
    return chunk.widened() if len(chunk) == 2 else chunk


def _placed(event: Located, position: float, bracket: tuple[float, float]) -> Located:
    """An event at its position, with the bracket in which it was seen; what is unresolved has one of its own."""
    return event._replace(
        position=position, bracket=event.bracket if event.role is Role.UNRESOLVED else bracket
    )


def before_stop(events: list[Located]) -> list[Located]:
    """The events up to the first one at which the branch ends."""
    for i, event in enumerate(events):
        if event.ends_branch:
            return events[: i + 1]
    return events


def _inside(position: float) -> float:
    """The position in [0, 1): an interpolated point may lie just outside of its segment."""
    return min(max(position, 0.0), 1.0 - 1e-9)


def without_zeros(signs: np.ndarray) -> np.ndarray:
    """Signs in which a zero (a point that is singular to roundoff) has taken the sign before it."""
    if signs.all():
        return signs
    signs = signs.copy()
    for i in np.flatnonzero(signs == 0.0):
        others = signs[i + 1 :][signs[i + 1 :] != 0.0]
        signs[i] = signs[i - 1] if i > 0 else (others[0] if len(others) else 1.0)
    return signs


def _dipping(engine: Engine, chunk: Chunk, values: np.ndarray) -> np.ndarray:
    """Segments in which a number that keeps its sign may pass zero and come back: the parabola through three values does."""
    found = np.zeros(len(values) - 1, dtype=bool)
    if len(values) > 2:
        steps = np.diff(np.column_stack([chunk.points, chunk.values]), axis=0)
        lengths = np.sqrt((steps**2) @ engine.weights)
        for side in (values, -values):
            with np.errstate(all="ignore"):
                middles = all_dips(side[:-2], side[1:-1], side[2:], lengths)
            found[:-1] |= middles
            found[1:] |= middles
    return found


def changes(values: np.ndarray) -> np.ndarray:
    """Whether the sign changes between neighbours; an exact zero counts as positive."""
    positive = values >= 0.0
    return positive[:-1] != positive[1:]
