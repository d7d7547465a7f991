"""Following a branch in one direction with its events."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import count as count_from
from typing import TYPE_CHECKING

from ..bifurcation.detect import Detector
from ..bifurcation.located import Located, Role
from ..continuation.engine import Engine, Solved
from ..continuation.layout import Chunk, Status
from ..continuation.trace import Finer, Retrace, chunks
from ..journal import NullJournal
from .finer_mesh import Meshes
from .half_branch import HalfBranch, Piece, pack, piece_of, single, unpack
from .opening import SHORTER, opening

if TYPE_CHECKING:
    from ..journal import Journal

# a branch that has come to an end like this is followed again where its mesh is too coarse
UNFINISHED = (Status.RUNNING, Status.STEP_TOO_SMALL, Status.BORDER, Status.LEFT_INTERVAL, Status.CREEPING)
AGAIN = {
    Role.LEAP: SHORTER,
    Role.LANDING: 0.7,
}  # parts of the steps that are traced again: those that end next to a meeting, and their successors, end elsewhere
SHORTEST = 0.1  # part of a first step: where a mesh lags behind after shorter ones it is too coarse


def trace_half(
    engine: Engine,
    start: Solved,
    detector: Detector,
    journal: Journal,
    key: str,
    real: bool = True,
    first_step: float | None = None,
    notice: Callable[[int, float], None] | None = None,
    origin: Solved | None = None,
    meshes: Meshes | None = None,
) -> HalfBranch:
    """Follow a branch from a point in the direction of its tangent until it ends.

    A real branch ends at its first border, a virtual one where all margins are positive again; both end where they come
    back to the fixed space of a symmetry. Special points are put between the points. Where a step has led to another
    branch, it is traced again with shorter ones. Where a mesh is too coarse, the branch goes on on a finer one, if it is given and what
    has been found so far can be read there; else the half ends, and says so.

    Parameters
    ----------
    engine : Engine
    start : Solved
    detector : Detector
    journal, key
        Chunks and their events are asked for, and recorded, under ``key/number`` and ``key/number/events``.
    real : bool
    first_step : float, optional
    notice : callable, optional
        Called after each chunk with the number of points so far and the parameter value.
    origin : Solved, optional
        The special point beside which the branch starts: it becomes the first point, and the segment between is looked at.
    meshes : Meshes, optional
    """
    half, detector.parts = single(engine, start), 0
    if origin is not None:
        half, closer = opening(engine, origin, start, detector, journal, f"{key}/opening", real)
        if half.status != Status.RUNNING:
            return half
        if closer is not start:
            start, first_step = closer, engine.distance(origin, closer)
    half.first, begun = start.u, len(half)
    stop = real and engine.problem.n_margins > 0
    walk = chunks(engine, start, journal, key, stop, first_step)
    wish: Retrace | Finer | None = None
    for number in count_from(0):
        chunk = next(walk) if wish is None else walk.send(wish)
        name = f"{key}/{number}/events"
        lag = _lag(engine, chunk)
        if _too_coarse(engine, chunk) or (
            lag is not None and lag.longest < SHORTEST * engine.settings.first_step
        ):
            whole = _ended(half, chunk)
            if meshes is not None and meshes.vanishes(whole):
                return replace(whole, status=Status.STEP_TOO_SMALL)
            onward = None if meshes is None else meshes.onward(half, real)
            if onward is None:
                return whole
            half, detector, image = onward
            engine, wish = half.engine, Finer(half.engine, image)
            continue
        chunk = chunk if lag is None else chunk.cut(lag.count)
        known, scanned = journal.recall(name), detector.scan(chunk)
        if known is None:
            events = detector.look(chunk, scanned, real)
            if len(chunk) > 1 and not isinstance(journal, NullJournal):
                journal.record(name, {**pack(events, engine), "parts": detector.parts})
        else:
            events, detector.parts = unpack(known), int(known.get("parts", 0))
        if any(_repeats(engine, event) for event in events):
            return _ended(half, chunk)
        status, count = chunk.status if lag is None else Status.RUNNING, len(chunk)
        wish = lag
        if events and events[-1].role in AGAIN:
            part, i = AGAIN[events[-1].role], int(events.pop().position)
            change = chunk.points[i + 1] - chunk.points[i], chunk.values[i + 1] - chunk.values[i]
            status, count = Status.RUNNING, i + 1
            wish = Retrace(count, part * engine.norm(engine.join(change[0], float(change[1]))))
        elif events and events[-1].role is Role.LEFT:
            status, count = Status.LEFT_INTERVAL, int(events[-1].position) + 1
            events[-1] = replace(events[-1], role=Role.PLAIN)
        elif events and events[-1].ends_branch:
            status, count = Status.BORDER, int(events[-1].position) + 1
        elif status == Status.BORDER:
            # the loop saw a negative margin that could not be located: keep what is certainly real
            count -= 1
        beside = bool(half.events) and half.events[-1][0] == len(half) - 2
        if engine.adaptive and len(half) > begun and not beside:
            # on the mesh of what follows; what was found before lies on that of the point
            half.put(len(half) - 1, chunk.solved(0))
        whole = Piece(
            chunk.points,
            chunk.values,
            chunk.tangents,
            chunk.rows[:, : 2 * engine.m].copy(),  # the loop writes its next rows to the same place
            scanned.smallest,
        )
        here, total = 1, len(half)  # the first point is the last one of the chunk before
        for event in events:
            where = max(int(event.position) + 1, here)
            half.pieces += [whole.part(here, where)] if where > here else []
            half.pieces.append(piece_of(engine, event.point))
            total += where - here
            if event.role is not Role.PLAIN:
                half.events.append((total, event))
            here, total = where, total + 1
        half.pieces += [whole.part(here, count)] if count > here else []
        half.status = status
        if notice is not None:
            notice(len(half), half.end)
        if status != Status.RUNNING:
            break
    return half


def _ended(half: HalfBranch, chunk: Chunk) -> HalfBranch:
    """A half that ends where its mesh is too coarse."""
    engine = half.engine
    spectrum, margins = chunk.rows[:, : 2 * engine.m].copy(), engine.smallest_margin(chunk.rows)
    last = Piece(chunk.points, chunk.values, chunk.tangents, spectrum, margins)
    return replace(half, pieces=[*half.pieces, last], status=Status.COARSE)


def _repeats(engine: Engine, event: Located) -> bool:
    """Whether a branch comes to solutions that only repeat shorter ones, and turns round there, on a mesh that cannot tell it."""
    problem = engine.adaptive
    if problem is None or event.kind != "branch-point":
        return False
    return problem.too_coarse(event.point.u, event.point.p) and problem.parts_of_refined > 1


def _too_coarse(engine: Engine, chunk: Chunk) -> bool:
    """Whether the mesh has become too coarse on a chunk."""
    problem = engine.adaptive
    if problem is None or chunk.status not in UNFINISHED:
        return False
    stuck = chunk.status == Status.STEP_TOO_SMALL
    return problem.too_coarse(chunk.points[-1], float(chunk.values[-1]), stuck)


def _lag(engine: Engine, chunk: Chunk) -> Retrace | None:
    """Where the mesh lags behind the solutions of a chunk: from the last point before on it is adapted again, with steps that are not longer."""
    problem = engine.adaptive
    if problem is None or chunk.status not in UNFINISHED or len(chunk) < 2:
        return None
    if not problem.lags(chunk.points[-1]):
        return None
    count = next(i for i in range(1, len(chunk)) if problem.lags(chunk.points[i]))
    step = engine.join(
        chunk.points[count] - chunk.points[count - 1], chunk.values[count] - chunk.values[count - 1]
    )
    return Retrace(count, (1.0 if count > 1 else 0.5) * engine.norm(step))
