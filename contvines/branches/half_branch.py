"""HalfBranch: the points of a branch on one side of its start, as pieces in order; they are joined, and stability determined, at the end.

If the mesh becomes too coarse, the points so far are transferred to a finer mesh, and the branch continues there. A polynomial on an interval is the
same polynomial on both halves of it, so points are transferred without solving again, and keep the error of their mesh, which was small enough
for them; special points are located again.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Container, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Any, NamedTuple, TypeVar

import numpy as np

from ..bifurcation.detect import Detector
from ..bifurcation.kinds import RENAMED
from ..bifurcation.locate import Located, Role, Segment
from ..continuation.engine import Engine, Solved
from ..continuation.layout import Status, packed
from ..continuation.trace import MeshMotion
from ..problems.abilities import Adaptive
from ..problems.protocol import Problem
from . import Branch, Ending

# kinds at which stability can change
STABILITY_CHANGES = {"fold", "period-doubling", "symmetry-breaking", "neimark-sacker", "hopf"}
BEGINNING = ("fold",)  # kind that stands for the beginning of a branch: a multiplier is 1 there
Start = TypeVar("Start")
LARGEST_CHANGE = 1e-3  # largest change of a point, in the metric, when it is solved on the finer mesh


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
        """Return the points from start up to, and without, stop."""
        return Piece(*(array[start:stop] for array in self))


def piece_of(engine: Engine, *points: Solved) -> Piece:
    """Return some points as a piece."""
    u, p, tangents, rows = (
        np.array([getattr(q, name) for q in points]) for name in ("u", "p", "tangent", "row")
    )
    return Piece(u, p, tangents, rows[:, : 2 * engine.m], engine.smallest_margin(rows))


@dataclass
class HalfBranch:
    """Points of a branch in order, with events.

    Attributes
    ----------
    detector : Detector
        Detector of all points; after a mesh became too coarse, that of the finer mesh.
    pieces : list of Piece
        The points.
    events : list of (int, Located)
        Index of the point, and the event.
    status : Status
        Reason why the half branch ended.
    first : ndarray or None
        Unknowns at the start of the continuation loop.
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
        """Return all points as one piece, in order."""
        if len(self.pieces) > 1:
            self.pieces = [Piece(*map(np.concatenate, zip(*self.pieces, strict=True)))]
        return self.pieces[0]

    def at(self, i: int) -> tuple[np.ndarray, float, np.ndarray]:
        """Return (u, p, tangent) of point i."""
        whole = self.joined()
        return whole.points[i], float(whole.values[i]), whole.tangents[i]

    def reversed(self) -> HalfBranch:
        """Return the same points in opposite order, with tangents reversed."""
        last, whole = len(self) - 1, Piece(*(array[::-1] for array in self.joined()))
        events = [
            (last - i, replace(e, point=e.point._replace(tangent=-e.point.tangent)))
            for i, e in self.events[::-1]
        ]
        return replace(self, pieces=[whole._replace(tangents=-whole.tangents)], events=events)

    def extended(self, other: HalfBranch, skip: int = 0) -> HalfBranch:
        """Return this half branch followed by the other one without its first ``skip`` points."""
        shift = len(self) - skip
        events = self.events + [(i + shift, e) for i, e in other.events]
        return HalfBranch(self.detector, [*self.pieces, other.joined().part(skip)], events, other.status)

    def since(self, u: np.ndarray) -> HalfBranch:
        """Return the half branch from the first point with these unknowns on."""
        skip = int((self.joined().points == u).all(axis=1).argmax())
        events = [(i - skip, e) for i, e in self.events if i >= skip]
        return replace(self, pieces=[self.joined().part(skip)], events=events)

    def inserted(self, points: list[tuple[int, Solved]]) -> HalfBranch:
        """Return the half branch with more points (index, point), in increasing order; each is put before the current point of its index."""
        indices = [i for i, _ in points]
        more = piece_of(self.engine, *(point for _, point in points))
        whole = Piece(*(np.insert(a, indices, b, axis=0) for a, b in zip(self.joined(), more, strict=True)))
        events = [(i + int(np.searchsorted(indices, i, side="right")), e) for i, e in self.events]
        return replace(self, pieces=[whole], events=events)

    def put(self, i: int, point: Solved) -> None:
        """Replace point i."""
        whole = self.joined()
        pieces = whole.part(0, i), piece_of(self.engine, point), whole.part(i + 1)
        self.pieces = [piece for piece in pieces if len(piece.values)]

    def without(self, places: list[int]) -> HalfBranch:
        """Return the half branch without some points and their events."""
        removed = sorted(set(places))
        whole = Piece(*(np.delete(array, removed, axis=0) for array in self.joined()))
        events = [(i - int(np.searchsorted(removed, i)), e) for i, e in self.events if i not in removed]
        return replace(self, pieces=[whole], events=events)


def pack(events: list[Located], engine: Engine) -> dict[str, Any]:
    """Return located events as arrays and JSON scalars, for a journal."""
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
    """Rebuild located events from the result of `pack`."""
    events = []
    for i, name in enumerate(record["kind"]):
        kind = RENAMED.get(str(name), str(name))
        position, error, low, high, p, *numbers = (float(x) for x in record["numbers"][i])
        u, tangent, row = (np.array(record[part][i]) for part in ("u", "tangent", "row"))
        point, role = Solved(u, p, tangent, row, *numbers), Role(record["role"][i])
        index, bracket = int(record["index"][i]), (low, high)
        events.append(Located(position, point, kind, index, role, error, bracket, record["name"][i]))
    return events


def with_points_between(half: HalfBranch, origin: int | None = None) -> HalfBranch:
    """Return the half branch with a solved point inserted between neighbouring special points, or ends, without a point between.

    The stability between two special points needs such a point. `origin` is the index of the special point from which the branch was reached.
    """
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
        narrow = may_be_stable_between(kinds.get(i, BEGINNING), kinds.get(i + 1, BEGINNING))
        if not segment.length > (engine.settings.sliver if narrow else engine.settings.one_place):
            continue
        middle = next((found for s in (0.5, 0.4, 0.6) if (found := segment.at(s)) is not None), None)
        if middle is not None:
            inserted.append((i + 1, middle))
    return half.inserted(inserted) if inserted else half


def may_be_stable_between(one: Collection[str], other: Collection[str]) -> bool:
    """Whether solutions between neighbouring points of these kinds may be stable although those on both outer sides are not."""
    return any(a != b and {a, b} & STABILITY_CHANGES for a in one for b in other)


def stability(
    engine: Engine, spectrum: np.ndarray, special: list[int], twins: Sequence[int] = ()
) -> np.ndarray | None:
    """Return which points count as stable, shape (n,); None if the problem has no spectrum.

    A special point is stable if one of its neighbours is. A point with a multiplier on the circle to rounding, as at the
    end of an interval or where a multiplier crosses, takes the stability of the nearest point without one that no special point
    separates from it.

    Parameters
    ----------
    engine : Engine
    spectrum : ndarray, shape (n, 2 m)
        Multipliers as (re, im) pairs.
    special : list of int
        Indices of the special points.
    twins : sequence of int
        Indices of points that coincide with a special point, as a fold where a branch turns at a branch point; their stability is not used.
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
    run, certain = np.cumsum(~ordinary), np.flatnonzero(ordinary & ~doubtful)[::-1]
    for i in np.flatnonzero(doubtful):
        near = certain[run[certain] == run[i]]
        stable[i] = (
            len(near) > 0 and stable[near[np.abs(near - i).argmin()]]
        )  # unstable if there is no such point
    ahead = stable & ordinary
    by_neighbour = np.zeros(len(stable), dtype=bool)
    by_neighbour[1:] = ahead[:-1]
    by_neighbour[:-1] |= ahead[1:]
    return np.where(ordinary, stable, by_neighbour)


def make_branch(
    label: str,
    half: HalfBranch,
    real: bool,
    endings: tuple[Ending, Ending],
    closed: bool,
    seed: str | None,
) -> Branch:
    """Return a Branch with the points of a half branch; the caller sets ``marks``, and ``stable``, which depends on them."""
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


class Meshes:
    """The meshes of one branch, each with twice as many intervals as the one before.

    Parameters
    ----------
    detector : Detector
        Detector of the first mesh.
    detector_of : callable
        problem -> Detector.
    vanishes : callable, optional
        half branch -> whether its cycles shrink to an equilibrium at its end, where equations are singular on every mesh; no finer mesh is tried then.
    """

    def __init__(
        self,
        detector: Detector,
        detector_of: Callable[[Problem], Detector],
        vanishes: Callable[[HalfBranch], bool] = lambda half: False,
    ) -> None:
        self.detector_of, self.vanishes = detector_of, vanishes
        self.detectors = [detector]  # in order of the meshes

    def finer(self, detector: Detector) -> Detector:
        """Return the detector of the next finer mesh."""
        place = self.detectors.index(detector) + 1
        if place == len(self.detectors):
            self.detectors.append(self.detector_of(_adaptive(detector.engine).refined()))
        return self.detectors[place]

    def followed(
        self,
        start: Start,
        halves: Callable[[Detector, Start, Container[str]], dict[str, HalfBranch]],
        restarted: Callable[[Detector, Detector, Start], Start | None],
        real: bool,
    ) -> tuple[dict[str, HalfBranch], Detector, Start]:
        """Follow both sides of a branch, and bring them to one mesh, the finest that is needed.

        A side that cannot be transferred to the finer mesh of the other one, or meets a mesh that is too coarse, is followed again on the finer mesh.

        Parameters
        ----------
        start
            Start on the first mesh.
        halves : callable
            (detector, start, sides to leave out) -> half branches by side.
        restarted : callable
            (detector, detector of the finer mesh, start) -> start on the finer mesh; None if there is none.
        real : bool
            Whether the branch has positive margins.

        Returns
        -------
        halves : dict of str -> HalfBranch
            Half branches by side.
        detector : Detector
        start
            Detector and start of the sides that were followed last.
        """
        done, detector = dict[str, HalfBranch](), self.detectors[0]
        while True:
            found = {**done, **halves(detector, start, done)}
            coarse = [half.detector for half in found.values() if half.status == Status.COARSE]
            meshes = [half.detector for half in found.values()] + [self.finer(each) for each in coarse]
            wanted = max(meshes, key=self.detectors.index)
            level = {side: self._level(half, wanted, real) for side, half in found.items()}
            done = {side: half for side, half in level.items() if half is not None}
            begin = None if len(done) == len(found) else restarted(detector, wanted, start)
            if begin is None:
                whole = {side: done.get(side) or self.read(half, wanted) for side, half in found.items()}
                return whole, detector, start
            detector, start = wanted, begin

    def _level(self, half: HalfBranch, wanted: Detector, real: bool) -> HalfBranch | None:
        """Return a half branch on a finer mesh; None if it must be followed again there."""
        if half.status == Status.COARSE:
            return None
        while half.detector is not wanted:
            onward = self.onward(half, real)
            if onward is None:
                return None
            half = onward[0]
        return half

    def moved(
        self, detector: Detector, wanted: Detector, point: Solved | None, solve: bool = True
    ) -> Solved | None:
        """Transfer a point to a finer mesh, and solve for it there if `solve`; None if it cannot be solved."""
        while point is not None and detector is not wanted:
            before, detector = detector, self.finer(detector)
            point = _transferred(point, before.engine, detector.engine)
            point = MeshMotion(detector.engine).solved(point) if solve else point
        return point

    def read(self, half: HalfBranch, wanted: Detector) -> HalfBranch:
        """Transfer a half branch to a finer mesh without solving."""
        while half.detector is not wanted:
            detector, engine, problem = self.finer(half.detector), half.engine, _adaptive(half.engine)
            finer, whole = detector.engine, half.joined()
            directions, slopes = problem.halved(whole.tangents[:, :-1], True), whole.tangents[:, -1]
            tangents = np.array([finer.unit(finer.join(v, float(s))) for v, s in zip(directions, slopes)])
            events = [(i, replace(e, point=_transferred(e.point, engine, finer))) for i, e in half.events]
            first = None if half.first is None else problem.halved(half.first)
            pieces = [whole._replace(points=problem.halved(whole.points), tangents=tangents)]
            half = HalfBranch(detector, pieces, events, half.status, first)
        return half

    def onward(self, half: HalfBranch, real: bool) -> tuple[HalfBranch, Callable[[Solved], Solved]] | None:
        """Transfer a half branch to the next mesh, and locate its special points again.

        Returns the half branch and a function that transfers points of its old mesh; None if it has other special points on the new mesh.
        """
        if _adaptive(half.engine).parts_of_refined != 1:
            return None  # the new mesh does not contain the old one
        coarse, detector = half.detector, self.finer(half.detector)
        found = self.read(half, detector)
        ended = half.status != Status.LEFT_INTERVAL or _at_the_end(found)
        same = ended and _end_unchanged(found, real) and _located_again(found, real)
        detector.parts = coarse.parts

        def image(point: Solved) -> Solved:
            read = self.moved(coarse, detector, point)
            return read or _transferred(point, coarse.engine, detector.engine)

        return (found, image) if same else None


def _adaptive(engine: Engine) -> Adaptive:
    assert engine.adaptive is not None
    return engine.adaptive


def _transferred(point: Solved, engine: Engine, finer: Engine) -> Solved:
    """Transfer a point to the next mesh without solving."""
    problem = _adaptive(engine)
    direction = problem.halved(point.tangent[:-1], True)
    tangent = finer.unit(finer.join(direction, float(point.tangent[-1])))
    return point._replace(u=problem.halved(point.u), tangent=tangent)


def _guess(half: HalfBranch, i: int) -> Solved:
    """Return point i as a guess, without row and sign."""
    return Solved(*half.at(i), np.zeros(0), 0.0, 0.0, 0.0)


def _end_unchanged(half: HalfBranch, real: bool) -> bool:
    """Whether the last point, solved on this mesh, is nearly the same as before, and not behind a border.

    It may be far away for a cycle that passes a saddle within rounding.
    """
    guess = _guess(half, len(half) - 1)
    last = MeshMotion(half.engine).solved(guess)
    if last is None:
        return True
    near = half.engine.distance(guess, last) <= LARGEST_CHANGE
    return near and not (real and bool(half.engine.smallest_margin(last.row) < 0.0))


def _at_the_end(half: HalfBranch) -> bool:
    """Solve for the last point on its mesh, at the end of the parameter interval; whether it was found."""
    finer, last = half.engine, len(half) - 1
    u, p, tangent = half.at(last)
    _adaptive(finer).anchor(u, p)
    found = finer.at_value(u, p, tangent)
    _adaptive(finer).anchor(None)
    if found is not None:
        half.put(last, found)
    return found is not None


def _located_again(half: HalfBranch, real: bool) -> bool:
    """Locate the special points of a half branch again on its mesh, between their neighbours; whether they are the same ones."""
    detector, events, half.events = half.detector, half.events, []
    places = sorted({i for i, _ in events})
    breaks = [k + 1 for k, (one, other) in enumerate(pairwise(places)) if other > one + 1]
    for group in np.split(np.array(places, dtype=int), breaks) if places else []:
        low, high = int(group[0]) - 1, int(group[-1]) + 1
        if low < 1 or high >= len(half):
            return False  # an end may be singular itself
        solved = [MeshMotion(half.engine).solved(_guess(half, i)) for i in (low, high)]
        ends = [end for end in solved if end is not None]
        if len(ends) < 2:
            return False
        _adaptive(half.engine).anchor(ends[0].u, ends[0].p)  # as during detection on a chunk
        chunk = packed(ends, Status.RUNNING)
        found = [e for e in detector.look(chunk, detector.scan(chunk), real) if e.role is not Role.PLAIN]
        _adaptive(half.engine).anchor(None)
        earlier = [(i, e) for i, e in events if low < i < high]
        if not found:  # unresolved marks from rounding on the old mesh
            earlier = [(i, e) for i, e in earlier if e.role is not Role.UNRESOLVED]
        if [(e.kind, e.role, e.name) for e in found] != [(e.kind, e.role, e.name) for _, e in earlier]:
            return False
        for (i, event), relocated in zip(earlier, found):
            half.put(i, relocated.point)
            half.events.append((i, replace(relocated, position=event.position)))
    return True
