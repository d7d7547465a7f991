"""Tracing: follow a branch in one direction, with its special points.

A branch that leaves a special point begins with the "opening": the segment from the special point to the first point from which the branch is
followed. If another branch is near (the next doubling of a cascade, for example) that first point may lie on it; if a border is near, it may lie
behind the border. A nearer first point is then computed.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import count as count_from
from typing import TYPE_CHECKING

from ..bifurcation.detect import Detector
from ..bifurcation.first_border import one_sided
from ..bifurcation.locate import Located, Role, Root, Segment
from ..continuation.engine import Engine, Solved
from ..continuation.layout import MARGIN, Chunk, Status
from ..continuation.trace import Finer, Retrace, chunks
from .half_branch import HalfBranch, Meshes, Piece, pack, piece_of, unpack

if TYPE_CHECKING:
    from ..journal import Journal

# statuses after which the mesh is tested: if it is too coarse the branch is followed again on a finer one
UNFINISHED = (Status.RUNNING, Status.STEP_TOO_SMALL, Status.BORDER, Status.LEFT_INTERVAL, Status.CREEPING)
LARGEST_MISS = 0.5  # largest distance of a nearer first point from the expected parabola, relative to its distance along the tangent
SHORTER = 0.125  # new step relative to one that jumped to another branch
STEP_AFTER = {
    Role.LEAP: SHORTER,
    Role.LANDING: 0.7,
}  # new step relative to the one that is repeated; after a landing the new steps end elsewhere
SHORTEST = 0.1  # least step on a mesh that lags behind, relative to the first step; shorter ones mean that the mesh is too coarse


def trace_half(
    detector: Detector,
    start: Solved,
    journal: Journal,
    key: str,
    real: bool = True,
    first_step: float | None = None,
    notice: Callable[[int, float], None] | None = None,
    origin: Solved | None = None,
    meshes: Meshes | None = None,
) -> HalfBranch:
    """Follow a branch from a point in the direction of its tangent until it ends.

    A real branch ends at its first border, a virtual one where all margins are positive again; both end where they return
    to the fixed space of a symmetry. Special points are inserted between the points. If a step has jumped to another
    branch, it is traced again with shorter steps. If the mesh becomes too coarse, the branch continues on a finer one, provided that `meshes` are given
    and the points so far can be transferred; else the half branch ends with the status COARSE.

    Parameters
    ----------
    detector : Detector
    start : Solved
        First point.
    journal, key
        Chunks and their events are recalled from, and recorded in, the journal as ``key/number`` and ``key/number/events``.
    real : bool
        Whether the branch has positive margins.
    first_step : float, optional
    notice : callable, optional
        Called after each chunk with the number of points so far and the parameter value.
    origin : Solved, optional
        The special point beside which the branch starts: it becomes the first point, and the segment between is searched.
    meshes : Meshes, optional
        Finer meshes of the problem.
    """
    engine, detector.parts = detector.engine, 0
    half = HalfBranch(detector, [piece_of(engine, start)])
    if origin is not None:
        half, closer = _opening(detector, origin, start, journal, f"{key}/opening", real)
        if half.status != Status.RUNNING:
            return half
        if closer is not start:
            start, first_step = closer, engine.distance(origin, closer)
    half.first, opening_length = start.u, len(half)
    walk = chunks(engine, start, journal, key, real and engine.problem.n_margins > 0, first_step)
    request: Retrace | Finer | None = None
    for number in count_from(0):
        chunk = next(walk) if request is None else walk.send(request)
        name = f"{key}/{number}/events"
        coarse, lag = _coarse(engine, chunk)
        if coarse:
            whole = _ended(half, chunk)
            if meshes is not None and meshes.vanishes(whole):
                return replace(whole, status=Status.STEP_TOO_SMALL)
            onward = None if meshes is None else meshes.onward(half, real)
            if onward is None:
                return whole
            half, image = onward
            detector, engine = half.detector, half.engine
            request = Finer(engine, image)
            continue
        chunk = chunk if lag is None else chunk.cut(lag.count)
        recorded, scanned = journal.recall(name), detector.scan(chunk)
        if recorded is None:
            events = detector.look(chunk, scanned, real)
            if len(chunk) > 1:
                journal.record(name, {**pack(events, engine), "parts": detector.parts})
        else:
            events, detector.parts = unpack(recorded), int(recorded.get("parts", 0))
        if any(_repeats(engine, event) for event in events):
            return _ended(half, chunk)
        status, count, request = chunk.status if lag is None else Status.RUNNING, len(chunk), lag
        if events and events[-1].role in STEP_AFTER:
            part, i = STEP_AFTER[events[-1].role], int(events.pop().position)
            status, count = Status.RUNNING, i + 1
            request = Retrace(count, part * _step(engine, chunk, count))
        elif events and events[-1].role is Role.LEFT:
            status, count = Status.LEFT_INTERVAL, int(events[-1].position) + 1
            events[-1] = replace(events[-1], role=Role.PLAIN)
        elif events and events[-1].ends_branch:
            status, count = Status.BORDER, int(events[-1].position) + 1
        elif status == Status.BORDER:
            # the loop met a negative margin whose zero could not be located: drop the last point, which may be virtual
            count -= 1
        just_passed = bool(half.events) and half.events[-1][0] == len(half) - 2
        if engine.adaptive and len(half) > opening_length and not just_passed:
            # replace the last point by the same one on the mesh of the following points
            half.put(len(half) - 1, chunk.solved(0))
        # copied, as the loop reuses the array of rows
        spectrum = chunk.rows[:, : 2 * engine.m].copy()
        whole = Piece(chunk.points, chunk.values, chunk.tangents, spectrum, scanned.smallest)
        begin, total = 1, len(half)  # the first point is the last one of the chunk before
        for event in events:
            end = max(int(event.position) + 1, begin)
            half.pieces += [whole.part(begin, end), piece_of(engine, event.point)]
            total += end - begin
            if event.role is not Role.PLAIN:
                half.events.append((total, event))
            begin, total = end, total + 1
        half.pieces += [whole.part(begin, count)] if count > begin else []
        half.status = status
        if notice is not None:
            notice(len(half), half.end)
        if status != Status.RUNNING:
            break
    return half


def _ended(half: HalfBranch, chunk: Chunk) -> HalfBranch:
    """Return the half branch with the points of the chunk, ended because its mesh is too coarse."""
    spectrum, margins = chunk.rows[:, : 2 * half.engine.m].copy(), half.engine.smallest_margin(chunk.rows)
    last = Piece(chunk.points, chunk.values, chunk.tangents, spectrum, margins)
    return replace(half, pieces=[*half.pieces, last], status=Status.COARSE)


def _repeats(engine: Engine, event: Located) -> bool:
    """Whether an event is a branch point at cycles that repeat a shorter one, on a mesh too coarse to show that the branch turns round there."""
    problem = engine.adaptive
    if problem is None or event.kind != "branch-point":
        return False
    return problem.too_coarse(event.point.u, event.point.p) and problem.parts_of_refined > 1


def _coarse(engine: Engine, chunk: Chunk) -> tuple[bool, Retrace | None]:
    """Test the mesh of a chunk.

    Returns
    -------
    coarse : bool
        Whether the mesh is too coarse.
    lag : Retrace or None
        If the mesh lags behind the solutions: trace again from the last good point, where the mesh is adapted, with steps that are not longer.
    """
    problem = engine.adaptive
    if problem is None or chunk.status not in UNFINISHED:
        return False, None
    lag = None
    if len(chunk) > 1 and problem.lags(chunk.points[-1]):
        count = next(i for i in range(1, len(chunk)) if problem.lags(chunk.points[i]))
        lag = Retrace(count, (1.0 if count > 1 else 0.5) * _step(engine, chunk, count))
    stuck, last = chunk.status == Status.STEP_TOO_SMALL, float(chunk.values[-1])
    short = lag is not None and lag.longest < SHORTEST * engine.settings.first_step
    return problem.too_coarse(chunk.points[-1], last, stuck) or short, lag


def _step(engine: Engine, chunk: Chunk, i: int) -> float:
    """Return the length of the step to point i of a chunk."""
    change = chunk.points[i] - chunk.points[i - 1], float(chunk.values[i] - chunk.values[i - 1])
    return engine.norm(engine.join(*change))


# ------------------------------------------------------------------ the opening
def _opening(
    detector: Detector, origin: Solved, start: Solved, journal: Journal, key: str, real: bool
) -> tuple[HalfBranch, Solved]:
    """Return the opening as a half branch, and the first point: `start`, or a nearer one if `start` lies on another branch."""
    engine, recorded = detector.engine, journal.recall(key)
    if recorded is None:
        events, times = _searched_opening(detector, origin, start, real)
        journal.record(key, {**pack(events, engine), "nearer": times})
    else:
        events, times = unpack(recorded), int(recorded.get("nearer", 0))
    for _ in range(times):
        start = nearer_start(engine, origin, start) or start
    ends = bool(events) and events[-1].ends_branch
    points = [origin, *(event.point for event in events), *([] if ends else [start])]
    half = HalfBranch(detector, [piece_of(engine, *points)], list(enumerate(events, 1)))
    half.status = Status.BORDER if ends else Status.RUNNING
    return half, start


def _searched_opening(
    detector: Detector, origin: Solved, start: Solved, real: bool
) -> tuple[list[Located], int]:
    """Return the special points of the opening, and the number of times that its end was moved nearer; 0 if that does not help."""
    engine, whole = detector.engine, detector.opening(origin, start, real)
    events, times, point = whole, 0, start
    while events and events[-1].role is Role.LEAP:
        closer = nearer_start(engine, origin, point)
        if closer is None or engine.distance(origin, closer) <= engine.settings.resolution:
            return whole[:-1], 0
        times, point = times + 1, closer
        events = detector.opening(origin, point, real)
    return events, times


def nearer_start(engine: Engine, origin: Solved, point: Solved) -> Solved | None:
    """Compute a point of a branch that leaves the special point `origin`, nearer to it than the known `point`; None if there is none.

    The tangent of `origin` points along the branch; the guess lies on the parabola through both points.
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
    return found if missed <= LARGEST_MISS * SHORTER * abs(along) else None


def on_real_side(engine: Engine, origin: Solved, point: Solved | None) -> Solved | None:
    """Move the first point of a leaving branch nearer to its origin until its margins are positive, if those of the origin are.

    Returns the given point if that is not possible.
    """
    if point is None or float(engine.smallest_margin(origin.row)) < engine.settings.inside:
        return point
    closer: Solved | None = point
    while closer is not None and engine.distance(origin, closer) > engine.settings.resolution:
        if float(engine.smallest_margin(closer.row)) >= MARGIN:
            return closer
        closer = nearer_start(engine, origin, closer)
    return point


def from_border(half: HalfBranch, first: Solved) -> HalfBranch:
    """Correct a half branch that begins at a border and continues with the same equations.

    Folds and branch points at the border itself are removed: where a stick or flight vanishes p is stationary, or another solution crosses. The
    multipliers at the border are replaced by their one-sided limits, as the equations may be singular there.
    """
    engine = half.engine
    repeated = [
        i
        for i, e in half.events
        if e.kind in ("fold", "branch-point")
        and engine.norm(engine.join(e.point.u - first.u, e.point.p - first.p)) <= engine.settings.one_place
    ]
    half = half.without(repeated)
    if len(half) < 2:
        return half
    u, p, tangent = half.at(1)
    ends = Solved(u, p, -tangent, first.row, 0.0, 0.0, 0.0), first._replace(tangent=-first.tangent)
    limits, _ = one_sided(Segment(engine, *ends), Root(1.0, ends[1], 0.0))
    half.put(0, first._replace(row=limits.row))
    return half
