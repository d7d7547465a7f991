"""The opening of a branch: from the special point that it leaves to the first point from which it is followed.

The first point lies at a distance that suits the branch itself. Where others are near (the next doublings of a cascade, say) it may be
one of those; where a border is near it may lie behind that. Then a first point is looked for that is nearer.
"""

from __future__ import annotations

from typing import Any

from ..continuation.engine import Engine, Solved
from ..continuation.march import MARGIN
from ..continuation.status import Status
from ..events.leaps import SHORTEST
from ..events.located import Located, Role
from ..events.watch import Watch
from .half_branch import HalfBranch, piece_of, single
from .records import pack, unpack

SHORTER = 0.125  # steps towards a gap between two branches, as a part of the step that leapt over it
SHOWN = 1e-10  # margins of a special point that are certainly positive
ASTRAY = 0.5  # part of its distance by which a nearer point may miss the parabola through the first one


def opening(
    engine: Engine, origin: Solved, start: Solved, watch: Watch, journal: Any, key: str, real: bool
) -> tuple[HalfBranch, Solved]:
    """From a special point to the first point of a branch that leaves it, and that point: a nearer one than `start` where that one leapt."""
    known = journal.recall(key)
    if known is None:
        events, times = _looked_at(engine, origin, start, watch, real)
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
    engine: Engine, origin: Solved, start: Solved, watch: Watch, real: bool
) -> tuple[list[Located], int]:
    """The special points of the opening, and how many times its end was brought nearer; not at all where that does not help."""
    whole = watch.beside(origin, start, real)
    events, times, point = whole, 0, start
    while events and events[-1].role is Role.LEAP:
        closer = nearer(engine, origin, point)
        if closer is None or engine.distance(origin, closer) <= SHORTEST:
            return whole[:-1], 0
        times, point = times + 1, closer
        events = watch.beside(origin, point, real)
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
    return found if missed <= ASTRAY * SHORTER * engine.norm(gap) else None


def on_this_side(engine: Engine, origin: Solved, point: Solved | None) -> Solved | None:
    """The first point of a branch that leaves a point with positive margins, brought so near that it has them, too, if it can be."""
    if point is None or float(engine.smallest_margin(origin.row)) < SHOWN:
        return point
    closer: Solved | None = point
    while closer is not None and engine.distance(origin, closer) > SHORTEST:
        if float(engine.smallest_margin(closer.row)) >= MARGIN:
            return closer
        closer = nearer(engine, origin, closer)
    return point
