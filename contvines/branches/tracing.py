"""Following a branch in one direction with its events."""

from __future__ import annotations

from collections.abc import Callable
from itertools import count as count_from
from typing import Any

import numpy as np

from ..continuation.engine import Engine, Solved
from ..continuation.status import Status
from ..continuation.trace import Retrace, chunks
from ..events.located import Located, Role
from ..events.watch import Watch
from .half_branch import HalfBranch, Piece, piece_of, single

SHORTER = 0.125  # steps towards a gap between two branches, as a part of the step that leapt over it


def trace_half(
    engine: Engine,
    start: Solved,
    watch: Watch,
    journal: Any,
    key: str,
    real: bool = True,
    first_step: float | None = None,
    notice: Callable[[int, float], None] | None = None,
    origin: Solved | None = None,
) -> HalfBranch:
    """Follow a branch from a point in the direction of its tangent until it ends.

    A real branch ends at its first border, a virtual one where all margins are positive again; both end where they come
    back to the fixed space of a symmetry. Special points are put between the points. Where a step has led to another
    branch, it is traced again with shorter ones.

    Parameters
    ----------
    engine : Engine
    start : Solved
    watch : Watch
    journal, key
        Chunks and their events are asked for, and recorded, under ``key/number`` and ``key/number/events``.
    real : bool
    first_step : float, optional
    notice : callable, optional
        Called after each chunk with the number of points so far and the parameter value.
    origin : Solved, optional
        The special point beside which the branch starts: it becomes the first point, and the segment between is looked at.
    """
    half = single(engine, start)
    if origin is not None:
        half = _opening(engine, origin, start, watch, journal, f"{key}/opening", real)
        if half.status != Status.RUNNING:
            return half
    stop = real and engine.problem.n_margins > 0
    walk = chunks(engine, start, journal, key, stop, first_step)
    retrace = None
    for number in count_from(0):
        chunk = next(walk) if retrace is None else walk.send(retrace)
        name = f"{key}/{number}/events"
        known = journal.recall(name)
        scan = watch.scan(chunk, real)
        if known is None:
            events = watch.look(chunk, scan, real)
            journal.record(name, pack(events, engine))
        else:
            events = unpack(known)
        status, count = chunk.status, len(chunk)
        retrace = None
        if events and events[-1].role is Role.LEAP:
            i = int(events.pop().position)
            change = chunk.points[i + 1] - chunk.points[i], chunk.values[i + 1] - chunk.values[i]
            status, count = Status.RUNNING, i + 1
            retrace = Retrace(count, SHORTER * engine.norm(engine.join(change[0], float(change[1]))))
        elif events and events[-1].ends_branch:
            status, count = Status.BORDER, int(events[-1].position) + 1
        elif status == Status.BORDER:
            # the loop saw a negative margin that could not be located: keep what is certainly real
            count -= 1
        whole = Piece(
            chunk.points,
            chunk.values,
            chunk.tangents,
            chunk.rows[:, : 2 * engine.m].copy(),  # the loop writes its next rows to the same place
            scan.smallest,
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


def _opening(
    engine: Engine, origin: Solved, start: Solved, watch: Watch, journal: Any, key: str, real: bool
) -> HalfBranch:
    """From a special point to the first point of a branch that leaves it."""
    known = journal.recall(key)
    if known is None:
        events = watch.beside(origin, start, real)
        journal.record(key, pack(events, engine))
    else:
        events = unpack(known)
    half = single(engine, origin)
    for i, event in enumerate(events):
        half.pieces.append(piece_of(engine, event.point))
        half.events.append((i + 1, event))
    if events and events[-1].ends_branch:
        half.status = Status.BORDER
    else:
        half.pieces.append(piece_of(engine, start))
    return half


def pack(events: list[Located], engine: Engine) -> dict[str, Any]:
    """Located events as arrays and JSON scalars, for a journal."""
    n, m = engine.n, engine.row_size
    points = [e.point for e in events]
    return {
        "kind": [e.kind for e in events],
        "role": [e.role.value for e in events],
        "name": [e.name for e in events],
        "index": [int(e.index) for e in events],
        "numbers": np.array(
            [
                [
                    e.position,
                    e.error,
                    *e.bracket,
                    e.point.p,
                    e.point.sign,
                    e.point.residual,
                    e.point.correction,
                ]
                for e in events
            ]
        ).reshape(len(events), 8),
        "u": np.array([p.u for p in points]).reshape(len(events), n),
        "tangent": np.array([p.tangent for p in points]).reshape(len(events), n + 1),
        "row": np.array([p.row for p in points]).reshape(len(events), m),
    }


def unpack(record: dict[str, Any]) -> list[Located]:
    """Located events from a journal."""
    events = []
    for i, kind in enumerate(record["kind"]):
        position, error, low, high, p, sign, residual, correction = (float(x) for x in record["numbers"][i])
        point = Solved(
            np.array(record["u"][i]),
            p,
            np.array(record["tangent"][i]),
            np.array(record["row"][i]),
            sign,
            residual,
            correction,
        )
        events.append(
            Located(
                position,
                kind,
                int(record["index"][i]),
                point,
                (low, high),
                error,
                Role(record["role"][i]),
                record["name"][i],
            )
        )
    return events
