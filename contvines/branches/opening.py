"""The opening of a branch: from the special point that it leaves to the first point from which it is followed.

The first point lies at a distance that suits the branch itself. Where others are near (the next doublings of a cascade, say) it may be
one of those; where a border is near it may lie behind that. Then a first point is looked for that is nearer.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..bifurcation.detect import Detector
from ..bifurcation.locate import Root
from ..bifurcation.located import Located, Role
from ..bifurcation.one_sided_limits import one_sided
from ..bifurcation.segment import Segment
from ..continuation.engine import Engine, Solved
from ..continuation.layout import MARGIN, Status
from ..journal import NullJournal
from .half_branch import HalfBranch, pack, piece_of, single, unpack

if TYPE_CHECKING:
    from ..journal import Journal

SHORTER = 0.125  # steps towards a gap between two branches, as a part of the step that leapt over it
ASTRAY = 0.5  # part of its way along the tangent by which a nearer point may miss the parabola through the first one


def opening(
    engine: Engine, origin: Solved, start: Solved, detector: Detector, journal: Journal, key: str, real: bool
) -> tuple[HalfBranch, Solved]:
    """From a special point to the first point of a branch that leaves it, and that point: a nearer one than `start` where that one leapt."""
    known = journal.recall(key)
    if known is None:
        events, times = _looked_at(engine, origin, start, detector, real)
        if not isinstance(journal, NullJournal):
            journal.record(key, {**pack(events, engine), "nearer": times})
    else:
        events, times = unpack(known), int(known.get("nearer", 0))
    start = _nearer_by(engine, origin, start, times)
    half = single(engine, origin)
    for i, event in enumerate(events):
        half.pieces.append(piece_of(engine, event.point))
        half.events.append((i + 1, event))
    if events and events[-1].ends_branch:
        half.status = Status.BORDER
    else:
        half.pieces.append(piece_of(engine, start))
    return half, start


def _looked_at(
    engine: Engine, origin: Solved, start: Solved, detector: Detector, real: bool
) -> tuple[list[Located], int]:
    """The special points of the opening, and how many times its end was brought nearer; not at all where that does not help."""
    whole = detector.beside(origin, start, real)
    events, times, point = whole, 0, start
    while events and events[-1].role is Role.LEAP:
        closer = nearer(engine, origin, point)
        if closer is None or engine.distance(origin, closer) <= engine.settings.resolution:
            return whole[:-1], 0
        times, point = times + 1, closer
        events = detector.beside(origin, point, real)
    return events, times


def _nearer_by(engine: Engine, origin: Solved, start: Solved, times: int) -> Solved:
    for _ in range(times):
        start = nearer(engine, origin, start) or start
    return start


def nearer(engine: Engine, origin: Solved, point: Solved) -> Solved | None:
    """A point of a branch that leaves a special point, nearer to that than a known one; None if none is found.

    The tangent of `origin` points along the branch; its bend is that of the parabola through both points.
    """
    z, direction = engine.join(origin.u, origin.p), origin.tangent
    gap = engine.join(point.u, point.p) - z
    along = engine.inner(direction, gap)
    guess = z + SHORTER * along * direction + SHORTER**2 * (gap - along * direction)
    border = engine.weights * direction
    tangent = direction if along > 0.0 else -direction
    found = engine.solve(guess[:-1], guess[-1], border, float(border @ guess), tangent)
    if found is None:
        return None
    missed = engine.norm(engine.join(found.u, found.p) - guess)
    return found if missed <= ASTRAY * SHORTER * abs(along) else None


def on_this_side(engine: Engine, origin: Solved, point: Solved | None) -> Solved | None:
    """The first point of a branch that leaves a point with positive margins, brought so near that it has them, too, if it can be."""
    if point is None or float(engine.smallest_margin(origin.row)) < engine.settings.inside:
        return point
    closer: Solved | None = point
    while closer is not None and engine.distance(origin, closer) > engine.settings.resolution:
        if float(engine.smallest_margin(closer.row)) >= MARGIN:
            return closer
        closer = nearer(engine, origin, closer)
    return point


def from_border(engine: Engine, half: HalfBranch, first: Solved) -> HalfBranch:
    """A half that begins at a border beyond which its equations go on, without what is the border itself; its multipliers there are limits.

    Where a stick or flight vanishes p is stationary, or another solution crosses; and where the equations are singular, what they
    tell of the multipliers there is rounding.
    """
    again = [
        i
        for i, e in half.events
        if e.kind in ("fold", "branch-point")
        and engine.norm(engine.join(e.point.u - first.u, e.point.p - first.p)) <= engine.settings.one_place
    ]
    half = half.without(again)
    if len(half) < 2:
        return half
    u, p, tangent = half.at(1)
    ends = Solved(u, p, -tangent, first.row, 0.0, 0.0, 0.0), first._replace(tangent=-first.tangent)
    limits, _ = one_sided(Segment(engine, *ends), Root(1.0, ends[1], 0.0))
    half.pieces[0] = piece_of(engine, first._replace(row=limits.row))
    return half
