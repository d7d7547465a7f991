"""Following a branch in one direction with its events, and joining two directions into one Branch."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from .branch import Branch
from .continuation.engine import Engine, Solved
from .continuation.status import Status
from .continuation.trace import chunks
from .events.examine import Located
from .events.segment import Segment
from .events.watch import Watch

APART = 1e-5  # special points closer than this (in the metric) are one place: no point is put between them
MARGINAL = 1e-9  # multipliers this close to the circle (or the imaginary axis) do not tell stability


@dataclass
class Half:
    """A branch in one direction from its start: arrays, and the events with their indices in them."""

    points: np.ndarray
    values: np.ndarray
    tangents: np.ndarray
    rows: np.ndarray
    events: list[tuple[int, Located]] = field(default_factory=list)
    status: Status = Status.RUNNING

    def __len__(self) -> int:
        return len(self.values)

    def reversed(self) -> Half:
        """The same points in opposite order, tangents turned round."""
        last = len(self) - 1
        events = [
            (last - i, e._replace(point=e.point._replace(tangent=-e.point.tangent)))
            for i, e in self.events[::-1]
        ]
        return Half(
            self.points[::-1], self.values[::-1], -self.tangents[::-1], self.rows[::-1], events, self.status
        )

    def extended(self, other: Half, skip: int = 0) -> Half:
        """This half, then the other one without its first ``skip`` points."""
        return join([self, other], skip)


def join(parts: list[Half], skip: int = 1) -> Half:
    """Parts one after the other, each but the first without its first ``skip`` points."""
    events, total = list(parts[0].events), len(parts[0])
    for part in parts[1:]:
        events += [(i + total - skip, e) for i, e in part.events]
        total += len(part) - skip
    first, rest = parts[0], parts[1:]
    return Half(
        np.concatenate([first.points, *(part.points[skip:] for part in rest)]),
        np.concatenate([first.values, *(part.values[skip:] for part in rest)]),
        np.concatenate([first.tangents, *(part.tangents[skip:] for part in rest)]),
        np.concatenate([first.rows, *(part.rows[skip:] for part in rest)]),
        events,
        parts[-1].status,
    )


def single(point: Solved) -> Half:
    """A half of one point."""
    return Half(
        point.u[None, :].copy(), np.array([point.p]), point.tangent[None, :].copy(), point.row[None, :].copy()
    )


def follow(
    engine: Engine,
    start: Solved,
    watch: Watch,
    journal: Any,
    key: str,
    real: bool = True,
    first_step: float | None = None,
    notice: Callable[[int, float], None] | None = None,
) -> Half:
    """Follow a branch from a point in the direction of its tangent until it ends.

    A real branch ends at its first border, a virtual one where all margins are positive again; both end where they come
    back to the fixed space of a symmetry. Special points are put between the points.

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
    """
    parts, total = [single(start)], 1
    stop = real and engine.problem.n_margins > 0
    for number, chunk in enumerate(chunks(engine, start, journal, key, stop, first_step)):
        name = f"{key}/{number}/events"
        known = journal.recall(name)
        if known is None:
            events = watch.look(chunk, real=real)
            journal.record(name, pack(events, engine))
        else:
            events = unpack(known)
        status = chunk.status
        if events and (events[-1].kind == "meets" or events[-1].note == "border"):
            status = Status.BORDER
            chunk = chunk.cut(int(events[-1].position) + 1)
        elif status == Status.BORDER:
            # the loop saw a negative margin that could not be located: keep what is certainly real
            chunk = chunk.cut(len(chunk) - 1)
        where = np.array([int(e.position) + 1 for e in events], dtype=int)
        part = Half(chunk.points, chunk.values, chunk.tangents, chunk.rows, [], status)
        if len(where):
            part = Half(
                np.insert(chunk.points, where, np.array([e.point.u for e in events]), axis=0),
                np.insert(chunk.values, where, [e.point.p for e in events]),
                np.insert(chunk.tangents, where, np.array([e.point.tangent for e in events]), axis=0),
                np.insert(chunk.rows, where, np.array([e.point.row for e in events]), axis=0),
                [(int(w) + i, e) for i, (w, e) in enumerate(zip(where, events)) if e.kind != "plain"],
                status,
            )
        parts.append(part)
        total += len(part) - 1
        if notice is not None:
            notice(total, float(part.values[-1]))
        if status != Status.RUNNING:
            break
    return join(parts)


def filled(engine: Engine, half: Half, origin: int | None = None) -> Half:
    """The half with a solved point between neighbouring special points, or ends, that have none between them."""
    special = {i for i, _ in half.events} | {0, len(half) - 1}
    if origin is not None:
        special.add(origin)
    events = dict.fromkeys(i for i, _ in half.events)
    inserted: list[tuple[int, Solved]] = []
    for i in sorted(special):
        if i + 1 not in special or not (i in events or i + 1 in events):
            continue
        ends = [Solved(half.points[j], float(half.values[j]), half.tangents[j], half.rows[j], 0.0, 0.0, 0.0)
                for j in (i, i + 1)]  # fmt: skip
        segment = Segment(engine, *ends)
        if not segment.length > APART:
            continue
        middle = next((found for s in (0.5, 0.4, 0.6) if (found := segment.at(s)) is not None), None)
        if middle is not None:
            inserted.append((i + 1, middle))
    if not inserted:
        return half
    where = [i for i, _ in inserted]
    return Half(
        np.insert(half.points, where, np.array([p.u for _, p in inserted]), axis=0),
        np.insert(half.values, where, [p.p for _, p in inserted]),
        np.insert(half.tangents, where, np.array([p.tangent for _, p in inserted]), axis=0),
        np.insert(half.rows, where, np.array([p.row for _, p in inserted]), axis=0),
        [(i + int(np.searchsorted(where, i, side="right")), e) for i, e in half.events],
        half.status,
    )


def stability(engine: Engine, half: Half, origin: int | None = None) -> np.ndarray:
    """Which points count as stable.

    A special point is stable when one of its neighbours is. A point with a multiplier on the circle to roundoff, as at the
    end of an interval or where a multiplier crosses, takes the stability of the nearest point that can tell, up to the next
    special point.
    """
    stable = engine.stable(half.rows)
    special = np.zeros(len(half), dtype=bool)
    special[[i for i, _ in half.events]] = True
    if origin is not None:
        special[origin] = True
    if len(half) < 2:
        return stable
    telling = ~special & ~engine.marginal(half.rows, MARGINAL)
    for start, stop in _runs(~special):
        known = start + np.flatnonzero(telling[start:stop])
        if not len(known):
            stable[start:stop] = False  # conservative: nothing is attracted
            continue
        here = np.arange(start, stop)
        after = np.clip(np.searchsorted(known, here), 0, len(known) - 1)
        before = np.maximum(after - 1, 0)
        nearer = np.where(np.abs(known[before] - here) < np.abs(known[after] - here), before, after)
        stable[start:stop] = stable[known[nearer]]
    before = np.append(False, stable[:-1] & ~special[:-1])
    after = np.append(stable[1:] & ~special[1:], False)
    return np.where(special, before | after, stable)


def _runs(chosen: np.ndarray) -> list[tuple[int, int]]:
    """Maximal runs of chosen entries, as (start, stop)."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], chosen, [False]]).astype(int)))
    return [(int(a), int(b)) for a, b in zip(edges[::2], edges[1::2])]


def make_branch(
    label: str,
    engine: Engine,
    half: Half,
    real: bool,
    ended: tuple[str, str],
    closed: bool,
    seed: str | None,
    origin: int | None = None,
) -> Branch:
    """A Branch from joined arrays; ``marks`` are left to the caller, ``origin`` is the point at which it was reached."""
    problem = engine.problem
    return Branch(
        label=label,
        problem=problem,
        points=np.ascontiguousarray(half.points),
        values=np.ascontiguousarray(half.values),
        tangents=np.ascontiguousarray(half.tangents),
        multipliers=engine.multipliers(half.rows),
        margin=engine.smallest_margin(half.rows),
        stable=stability(engine, half, origin),
        real=real,
        ended=ended,
        closed=closed,
        seed=seed,
        description=dict(problem.describe()),
        parameter=problem.parameter,
    )


def pack(events: list[Located], engine: Engine) -> dict[str, Any]:
    """Located events as arrays and JSON scalars, for a journal."""
    n, m = engine.n, engine.row_size
    points = [e.point for e in events]
    return {
        "kind": [e.kind for e in events],
        "note": [e.note for e in events],
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
            Located(position, kind, int(record["index"][i]), point, (low, high), error, record["note"][i])
        )
    return events
