"""HalfBranch: what has been found of a branch, as pieces in order; put together, with its stability, at the end."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np

from ..bifurcation.detect import Detector
from ..bifurcation.kinds import RENAMED
from ..bifurcation.locate import Located, Role, Segment
from ..continuation.engine import Engine, Solved
from ..continuation.layout import Status
from .branch import Branch, Ending

LOST = {"fold", "period-doubling", "symmetry-breaking", "neimark-sacker", "hopf"}
BEGINNING = ("fold",)  # where a branch begins at a bifurcation of another one, a multiplier is 1 as at a fold


class Piece(NamedTuple):
    """Consecutive points: arrays of shapes (n, N), (n,), (n, N + 1), (n, 2 m) and (n,).

    ``spectrum`` has the multipliers as (re, im) pairs, ``smallest`` the smallest margins.
    """

    points: np.ndarray
    values: np.ndarray
    tangents: np.ndarray
    spectrum: np.ndarray
    smallest: np.ndarray

    def part(self, start: int, stop: int | None = None) -> Piece:
        """Points start to stop."""
        return Piece(*(array[start:stop] for array in self))


def piece_of(engine: Engine, *points: Solved) -> Piece:
    """A piece of some points."""
    u, p, tangents, rows = (
        np.array([getattr(q, name) for q in points]) for name in ("u", "p", "tangent", "row")
    )
    return Piece(u, p, tangents, rows[:, : 2 * engine.m], engine.smallest_margin(rows))


@dataclass
class HalfBranch:
    """Points of a branch in order, and the events with their indices among them; `first` are the unknowns where the loop began.

    `detector` has found all points: where a mesh became too coarse on the way, that of the finer one.
    """

    detector: Detector
    pieces: list[Piece]
    events: list[tuple[int, Located]] = field(default_factory=list)
    status: Status = Status.RUNNING
    first: np.ndarray | None = None

    def __len__(self) -> int:
        return sum(len(piece.values) for piece in self.pieces)

    @property
    def engine(self) -> Engine:
        return self.detector.engine

    @property
    def end(self) -> float:
        """Parameter value of the last point."""
        return float(self.pieces[-1].values[-1])

    def joined(self) -> Piece:
        """All points as one piece, in order."""
        if len(self.pieces) > 1:
            self.pieces = [Piece(*map(np.concatenate, zip(*self.pieces, strict=True)))]
        return self.pieces[0]

    def at(self, i: int) -> tuple[np.ndarray, float, np.ndarray]:
        """(u, p, tangent) of point i."""
        whole = self.joined()
        return whole.points[i], float(whole.values[i]), whole.tangents[i]

    def reversed(self) -> HalfBranch:
        """The same points in opposite order, tangents turned round."""
        last, whole = len(self) - 1, Piece(*(array[::-1] for array in self.joined()))
        events = [
            (last - i, replace(e, point=e.point._replace(tangent=-e.point.tangent)))
            for i, e in self.events[::-1]
        ]
        return replace(self, pieces=[whole._replace(tangents=-whole.tangents)], events=events)

    def extended(self, other: HalfBranch, skip: int = 0) -> HalfBranch:
        """This half, then the other one without its first ``skip`` points."""
        shift = len(self) - skip
        events = self.events + [(i + shift, e) for i, e in other.events]
        return HalfBranch(self.detector, [*self.pieces, other.joined().part(skip)], events, other.status)

    def since(self, u: np.ndarray) -> HalfBranch:
        """From the first point with these unknowns on."""
        skip = int((self.joined().points == u).all(axis=1).argmax())
        events = [(i - skip, e) for i, e in self.events if i >= skip]
        return replace(self, pieces=[self.joined().part(skip)], events=events)

    def inserted(self, points: list[tuple[int, Solved]]) -> HalfBranch:
        """With more points, each before the point that has its index now; in increasing order."""
        where = [i for i, _ in points]
        more = piece_of(self.engine, *(point for _, point in points))
        whole = Piece(*(np.insert(a, where, b, axis=0) for a, b in zip(self.joined(), more, strict=True)))
        events = [(i + int(np.searchsorted(where, i, side="right")), e) for i, e in self.events]
        return replace(self, pieces=[whole], events=events)

    def put(self, i: int, point: Solved) -> None:
        """Another point in the place of point i."""
        whole = self.joined()
        pieces = whole.part(0, i), piece_of(self.engine, point), whole.part(i + 1)
        self.pieces = [piece for piece in pieces if len(piece.values)]

    def without(self, places: list[int]) -> HalfBranch:
        """Without some points, and their events."""
        gone = sorted(set(places))
        whole = Piece(*(np.delete(array, gone, axis=0) for array in self.joined()))
        events = [(i - int(np.searchsorted(gone, i)), e) for i, e in self.events if i not in gone]
        return replace(self, pieces=[whole], events=events)


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
                (e.position, e.error, *e.bracket, p.p, p.sign, p.residual, p.correction)
                for e, p in zip(events, points)
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
        position, error, low, high, p, *numbers = (float(x) for x in record["numbers"][i])
        u, tangent, row = (np.array(record[part][i]) for part in ("u", "tangent", "row"))
        point, role = Solved(u, p, tangent, row, *numbers), Role(record["role"][i])
        index, bracket = int(record["index"][i]), (low, high)
        events.append(Located(position, point, kind, index, role, error, bracket, record["name"][i]))
    return events


def filled(half: HalfBranch, origin: int | None = None) -> HalfBranch:
    """The half with a solved point between neighbouring special points, or ends, that have none between them."""
    engine, special = half.engine, {i for i, _ in half.events} | {0, len(half) - 1}
    if origin is not None:
        special.add(origin)
    kinds: dict[int, list[str]] = {}
    for i, event in half.events:
        kinds.setdefault(i, []).append(event.kind)
    inserted: list[tuple[int, Solved]] = []
    for i in sorted(special):
        if i + 1 not in special or not (i in kinds or i + 1 in kinds):
            continue
        one, other = (
            Solved(u, p, tangent, np.zeros(0), 0.0, 0.0, 0.0) for u, p, tangent in map(half.at, (i, i + 1))
        )
        segment = Segment(engine, one, other)
        narrow = a_sliver(kinds.get(i, BEGINNING), kinds.get(i + 1, BEGINNING))
        if not segment.length > (engine.settings.sliver if narrow else engine.settings.one_place):
            continue
        middle = next((found for s in (0.5, 0.4, 0.6) if (found := segment.at(s)) is not None), None)
        if middle is not None:
            inserted.append((i + 1, middle))
    return half.inserted(inserted) if inserted else half


def a_sliver(one: Collection[str], other: Collection[str]) -> bool:
    """Whether solutions between neighbouring points of these kinds may be stable although those on both sides are not."""
    return any(a != b and {a, b} & LOST for a in one for b in other)


def stability(
    engine: Engine, spectrum: np.ndarray, special: list[int], twins: Sequence[int] = ()
) -> np.ndarray | None:
    """Which points count as stable; None where the problem has no spectrum that tells.

    A special point is stable when one of its neighbours is. A point with a multiplier on the circle to roundoff, as at the
    end of an interval or where a multiplier crosses, takes the stability of the nearest point that can tell, up to the next
    special point.

    Parameters
    ----------
    engine : Engine
    spectrum : ndarray, shape (n, 2 m)
        Multipliers as (re, im) pairs.
    special : list of int
        Indices of the special points.
    twins : sequence of int
        Indices of points that are a special point once more, as where a branch turns at a branch point: they do not tell.
    """
    if not engine.tells_stability:
        return None
    outermost = engine.outermost(spectrum)
    stable = outermost < 0.0
    if len(stable) < 2:
        return stable
    ordinary = np.ones(len(stable), dtype=bool)
    ordinary[special] = False
    doubtful = np.abs(outermost) <= engine.settings.marginal
    doubtful[list(twins)] = True
    doubtful &= ordinary
    run, known = np.cumsum(~ordinary), np.flatnonzero(ordinary & ~doubtful)[::-1]
    for i in np.flatnonzero(doubtful):
        near = known[run[known] == run[i]]
        stable[i] = (
            len(near) > 0 and stable[near[np.abs(near - i).argmin()]]
        )  # where none tells nothing is attracted
    ahead = stable & ordinary
    beside = np.zeros(len(stable), dtype=bool)
    beside[1:] = ahead[:-1]
    beside[:-1] |= ahead[1:]
    return np.where(ordinary, stable, beside)


def make_branch(
    label: str,
    half: HalfBranch,
    real: bool,
    endings: tuple[Ending, Ending],
    closed: bool,
    seed: str | None,
) -> Branch:
    """A Branch from what was found; ``marks``, and ``stable`` that depends on them, are left to the caller."""
    engine, whole = half.engine, half.joined()
    return Branch(
        label=label,
        problem=engine.problem,
        points=whole.points,
        values=whole.values,
        tangents=whole.tangents,
        multipliers=engine.multipliers(whole.spectrum),
        margin=whole.smallest,
        stable=None,
        real=real,
        endings=endings,
        closed=closed,
        seed=seed,
        description=dict(engine.problem.describe()),
        parameter=engine.problem.parameter,
    )
