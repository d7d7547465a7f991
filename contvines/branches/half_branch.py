"""HalfBranch: what has been found of a branch, as pieces in order; put together once, at the end."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np

from ..bifurcation.kinds import RENAMED
from ..bifurcation.located import Located, Role
from ..continuation.engine import Engine, Solved
from ..continuation.layout import Status


class Piece(NamedTuple):
    """Consecutive points: arrays of shapes (n, N), (n,), (n, N + 1), (n, 2 m) and (n,).

    ``spectrum`` has the multipliers as (re, im) pairs, ``smallest`` the smallest margins. ``turned`` pieces are read
    backwards, with tangents of opposite sign.
    """

    points: np.ndarray
    values: np.ndarray
    tangents: np.ndarray
    spectrum: np.ndarray
    smallest: np.ndarray
    turned: bool = False

    def part(self, start: int, stop: int) -> Piece:
        """Points start to stop in the order in which the piece is read."""
        n = len(self.values)
        where = slice(n - stop, n - start) if self.turned else slice(start, stop)
        return Piece(*(array[where] for array in self[:5]), turned=self.turned)


def piece_of(engine: Engine, point: Solved) -> Piece:
    """A piece of one point."""
    return Piece(
        point.u[None, :],
        np.array([point.p]),
        point.tangent[None, :],
        point.row[None, : 2 * engine.m],
        engine.smallest_margin(point.row)[None],
    )


@dataclass
class HalfBranch:
    """Points of a branch in order, and the events with their indices among them; `first` are the unknowns where the loop began.

    `engine` is that of all points: where a mesh became too coarse on the way, that of the finer one.
    """

    engine: Engine
    pieces: list[Piece]
    events: list[tuple[int, Located]] = field(default_factory=list)
    status: Status = Status.RUNNING
    first: np.ndarray | None = None

    def __len__(self) -> int:
        total = 0
        for piece in self.pieces:
            total += len(piece.values)
        return total

    @property
    def end(self) -> float:
        """Parameter value of the last point."""
        piece = self.pieces[-1]
        return float(piece.values[0 if piece.turned else -1])

    def reversed(self) -> HalfBranch:
        """The same points in opposite order, tangents turned round."""
        last = len(self) - 1
        events = [
            (last - i, replace(e, point=e.point._replace(tangent=-e.point.tangent)))
            for i, e in self.events[::-1]
        ]
        return HalfBranch(
            self.engine,
            [piece._replace(turned=not piece.turned) for piece in self.pieces[::-1]],
            events,
            self.status,
            self.first,
        )

    def extended(self, other: HalfBranch, skip: int = 0) -> HalfBranch:
        """This half, then the other one without its first ``skip`` points."""
        shift = len(self) - skip
        events = self.events + [(i + shift, e) for i, e in other.events]
        return HalfBranch(self.engine, self.pieces + other._slice(skip, len(other)), events, other.status)

    def since(self, u: np.ndarray) -> HalfBranch:
        """From the first point with these unknowns on."""
        skip = next(i for i in range(len(self)) if np.array_equal(self.at(i)[0], u))
        events = [(i - skip, e) for i, e in self.events if i >= skip]
        return HalfBranch(self.engine, self._slice(skip, len(self)), events, self.status)

    def inserted(self, points: list[tuple[int, Solved]]) -> HalfBranch:
        """With more points, each before the point that has its index now; in increasing order."""
        pieces: list[Piece] = []
        here = 0
        for i, point in points:
            pieces += [*self._slice(here, i), piece_of(self.engine, point)]
            here = i
        where = [i for i, _ in points]
        events = [(i + int(np.searchsorted(where, i, side="right")), e) for i, e in self.events]
        return HalfBranch(self.engine, pieces + self._slice(here, len(self)), events, self.status)

    def put(self, i: int, point: Solved) -> None:
        """Another point in the place of point i."""
        self.pieces = [*self._slice(0, i), piece_of(self.engine, point), *self._slice(i + 1, len(self))]

    def without(self, places: list[int]) -> HalfBranch:
        """Without some points, and their events."""
        gone = sorted(set(places))
        pieces: list[Piece] = []
        here = 0
        for i in gone:
            pieces += self._slice(here, i)
            here = i + 1
        events = [(i - int(np.searchsorted(gone, i)), e) for i, e in self.events if i not in gone]
        return HalfBranch(self.engine, pieces + self._slice(here, len(self)), events, self.status, self.first)

    def joined(self) -> Piece:
        """All points as one piece, in order."""
        if len(self.pieces) == 1 and not self.pieces[0].turned:
            return self.pieces[0]
        total = len(self)
        whole = Piece(
            *[np.empty((total, *array.shape[1:]), array.dtype) for array in self.pieces[0][:5]], turned=False
        )
        here = 0
        for piece in self.pieces:
            there = here + len(piece.values)
            for to, array in zip(whole[:5], piece[:5]):
                to[here:there] = array[::-1] if piece.turned else array
            if piece.turned:
                np.negative(whole.tangents[here:there], out=whole.tangents[here:there])
            here = there
        self.pieces = [whole]
        return whole

    def at(self, i: int) -> tuple[np.ndarray, float, np.ndarray]:
        """(u, p, tangent) of point i."""
        piece = self._slice(i, i + 1)[0]
        return (
            piece.points[0],
            float(piece.values[0]),
            -piece.tangents[0] if piece.turned else piece.tangents[0],
        )

    def _slice(self, start: int, stop: int) -> list[Piece]:
        found, before = [], 0
        for piece in self.pieces:
            n = len(piece.values)
            a, b = max(start - before, 0), min(stop - before, n)
            if a < b:
                found.append(piece if (a, b) == (0, n) else piece.part(a, b))
            before += n
        return found


def single(engine: Engine, point: Solved) -> HalfBranch:
    """A half of one point."""
    return HalfBranch(engine, [piece_of(engine, point)])


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
    for i, name in enumerate(record["kind"]):
        kind = RENAMED.get(str(name), str(name))
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
