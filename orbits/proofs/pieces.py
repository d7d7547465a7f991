"""Proofs of pieces of branches: tiles cover an interval of the parameter, with the same verdict on all its orbits."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from orbits.proofs.admissible import examine
from orbits.proofs.balls import Given, as_balls, ball, decimal, library, precision
from orbits.proofs.checks import check_symmetry
from orbits.proofs.enclosing import Box, refine
from orbits.proofs.equations import Motif, Varying
from orbits.proofs.obstacles import Obstacle, Remedy, Step
from orbits.proofs.proof import Entry, Proof, certificate
from orbits.proofs.special import Family
from orbits.proofs.stability import stable_in_basis
from orbits.proofs.tiles import Along, Tile, lay, orbit_at, orbit_entry, tile_box
from orbits.proofs.wording import SAYS, said, spelling
from orbits.settings import PROVING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from flint import arb


BITS = 192  # precision
FIRST = 1 / 16  # width of the first tile, relative to the piece
ROOM = 0.8  # relative enlargement of a tile's radii when its stability is decided, so that another arithmetic confirms it
GRADE = 0.35  # largest width of a tile, relative to its distance from a special point


@dataclass(frozen=True)
class Piece:
    """Proof for a piece of a branch.

    Attributes
    ----------
    motif : Motif
    parameters : dict
        All parameters except those that vary.
    varying : Varying
        The parameter that varies.
    asked : (float, float)
        The requested interval of the parameter.
    boxes : tuple of dict
        Orbits and tiles of the certificate, alternating, in ascending order.
    covered : (str, str) or None
        The interval that is covered with one verdict, as exact decimals; None if nothing is covered.
    count : int
        Number of tiles.
    radius : float or None
        The largest radius of a tile at one value of the parameter.
    ends : (str or None, str or None)
        Kinds of the special points at which the piece begins and ends; None at an ordinary point.
    real, stable : bool or None
        Verdict on all orbits of the piece; None if it is not proved.
    obstacles : tuple of Obstacle
        Why the covered interval is shorter than the requested one.
    bits : int
        Precision of the ball arithmetic.
    """

    motif: Motif
    parameters: Mapping[str, Any]
    varying: Varying
    asked: tuple[float, float]
    boxes: tuple[Entry, ...] = ()
    covered: tuple[str, str] | None = None
    count: int = 0
    radius: float | None = None
    ends: tuple[str | None, ...] = (None, None)
    real: bool | None = None
    stable: bool | None = None
    obstacles: tuple[Obstacle, ...] = ()
    bits: int = BITS
    kind: str = field(default="piece", init=False)

    @property
    def existence(self) -> bool:
        """Whether the whole interval is covered."""
        return bool(self.count) and not self.obstacles

    @property
    def parameter(self) -> str:
        """Name of the varying parameter."""
        return self.varying.name

    def to_dict(self) -> dict[str, Any]:
        """Return the piece as a dict for JSON."""
        return {
            "kind": "piece",
            "existence": self.existence,
            "real": self.real,
            "stable": self.stable,
            "radius": self.radius,
            "nodes": [],
            "parameter": self.parameter,
            "asked": list(self.asked),
            "covered": list(self.covered) if self.covered else None,
            "tiles": self.count,
            "ends": list(self.ends),
            "obstacles": [obstacle.to_dict() for obstacle in self.obstacles],
            "bits": self.bits,
        }

    def certificate(self) -> dict[str, Any]:
        """Return the certificate of the piece for `orbits.proofs.checker`, as a dict for JSON.

        Raises
        ------
        ValueError
            If nothing was proved.
        """
        if not self.count:
            raise ValueError(
                "nothing was proved, so there is no certificate: " + "; ".join(map(str, self.obstacles))
            )
        return certificate(
            self.motif, self.parameters, self.varying, self.boxes, self.real, self.stable, self.bits
        )

    def __str__(self) -> str:
        word = spelling(self.motif, self.parameters)
        if not self.covered:
            line = f"the orbits of {word} from {self.asked[0]:g} to {self.asked[1]:g}: not proved"
            return said([line], self.obstacles)
        low, high = (
            f"the {kind} at {float(at):.10g}" if kind else f"{float(at):.10g}"
            for kind, at in zip(self.ends, self.covered)
        )
        line = (
            f"the orbits of {word}: exactly one near the branch, {SAYS['real'][self.real]}, {SAYS['stable'][self.stable]}, "
            f"for all {self.parameter} from {low} to {high} ({self.count} boxes)"
        )
        return said([line], self.obstacles)


def prove_piece(
    motif: Motif,
    guess: Callable[[float], np.ndarray],
    parameters: Mapping[str, Given],
    varying: Varying,
    low: float,
    high: float,
    ends: tuple[Proof | None, Proof | None] = (None, None),
    bits: int = BITS,
) -> Piece:
    """Cover an interval of the parameter with tiles whose orbits all have the same verdicts (real or virtual, stable or unstable).

    Parameters
    ----------
    motif : Motif
    guess : callable
        Maps a value of the parameter to computed nodes (l, n) near the branch.
    parameters : dict
        Parameters of the machine; values of those that vary are ignored.
    varying : Varying
        The parameter that varies.
    low, high : float
        The interval, low < high.
    ends : (Proof or None, Proof or None)
        Proofs of the special points at which the piece begins and ends; with them the piece includes these points.
    bits : int
        Precision.
    """
    given = {name: decimal(value) for name, value in parameters.items() if name not in varying.numbers}
    check_symmetry(motif, given, varying)
    with precision(bits):
        cover = _Cover(Family(motif, {name: ball(value) for name, value in given.items()}, varying), bits)
        first, last = ((end and _chain(end, guess, 0.5 * (low + high))) for end in ends)
        obstacle = cover.run(guess, low, high, first, last)
    real, steady = cover.verdict or (None, None)
    return Piece(
        motif,
        given,
        varying,
        (low, high),
        tuple(cover.boxes),
        cover.reached,
        len(cover.tiles),
        max((tile.radius for tile in cover.tiles), default=None),
        tuple(
            end.kind if end and reached else None for end, reached in zip(ends, (bool(first), cover.arrived))
        ),
        real,
        steady,
        (obstacle,) if obstacle else (),
        bits,
    )


def _chain(end: Proof, guess: Callable[[float], np.ndarray], inside: float) -> list[Entry]:
    """Return the chain of a special point, ordered so that its last orbit lies on the side of the piece."""
    one, tile, other = end.chain
    if one["parameter"] != other["parameter"]:
        ascending = float(one["parameter"][0]) < inside
        return [one, tile, other] if ascending else [other, tile, one]
    near = guess(float(one["parameter"][0]) + PROVING.inside * (inside - float(one["parameter"][0])))

    def away(entry: Entry) -> float:
        nodes = [[float(m) for m, _, _ in node] for node in entry["nodes"]]
        return float(np.max(np.abs(np.array(nodes) - near)))

    return [one, tile, other] if away(other) <= away(one) else [other, tile, one]


class _Cover:
    """Construction of the cover: tiles one after another from the left to the right end, and orbits that lie in two neighbouring tiles."""

    def __init__(self, family: Family, bits: int) -> None:
        self.family, self.bits = family, bits
        self.tiles: list[Tile] = []
        self.boxes: list[Entry] = []
        self.verdict: tuple[bool | None, bool | None] | None = None
        self.reached: tuple[str, str] | None = None
        self.arrived = False

    def run(
        self,
        guess: Callable[[float], np.ndarray],
        low: float,
        high: float,
        first: list[Entry] | None,
        last: list[Entry] | None,
    ) -> Obstacle | None:
        """Cover from `low` (or the special point `first`) to `high` (or the special point `last`); return None, or the obstacle at which the cover ends."""
        begin, end = low, high
        try:
            if first:
                self.boxes += first
                at, box = first[-1]["parameter"][0], _box_of(first[-1])
                begin = float(first[1]["parameter"][0])
            else:
                at = repr(low)
                box = self._orbit(at, guess(low))
                self.boxes.append(orbit_entry(self.family, at, box))
        except Obstacle as obstacle:
            return obstacle
        goal = last[-1]["parameter"][0] if last else repr(high)
        if last:
            end = float(last[1]["parameter"][0])
        start = at
        width = (high - low) * FIRST
        least = PROVING.least_tile * (high - low) * (PROVING.graded if first or last else 1.0)
        while float(at) < float(goal):
            place = float(at)
            width = min(width, 1.03 * (float(goal) - place) + PROVING.overlap * least)
            if first:
                width = min(width, GRADE * (place - begin))
            if last:
                width = min(width, max(GRADE * (end - place), 1.03 * (float(goal) - place)))
            tile = self._next(at, box, width, 2 * least, goal, last)
            if isinstance(tile, Obstacle):
                if width < least:
                    self.reached = (start, at)
                    return tile
                width /= 2
                continue
            at, box = tile
            width *= 1.6
        self.reached = (start, at)
        if last:
            self.boxes += last[1::-1]
            self.arrived = True
        return None

    def _orbit(self, value: str, start: Sequence[Sequence[float]] | np.ndarray) -> Box:
        nodes = as_balls(start)
        return orbit_at(self.family, value, nodes, self.bits)

    def _next(
        self, at: str, box: Box, width: float, least: float, goal: str, last: list[Entry] | None
    ) -> tuple[str, Box] | Obstacle:
        """Prove one tile of this width that begins at the orbit `box` with parameter `at`, and the orbit near its right end.

        Return the parameter and the box of that orbit, or an obstacle. An undecided verdict of the first tile is accepted only if the
        tile is narrower than `least`.
        """
        family = self.family
        place = f"{family.varying.name} = {float(at):.6g}"
        smaller = Obstacle(Step.PIECE, Remedy.SMALLER, detail=place)
        # the tile begins slightly to the left of `at`, so that the orbit lies inside
        center = repr(float(at) + 0.49 * width)
        half = f"{width / 2:.6g}"
        before = np.array([[float(mid) for mid, _ in node] for node in box.nodes])
        nodes = self.tiles[-1].end(float(center)) if self.tiles else before
        along = Along(family, None, ball(center))
        try:
            system = family.system(ball(center))
            z, _ = refine(system, as_balls(nodes), [], self.bits)
            tile = lay(along, center, half, z, ball(center))
            if tile is None or not tile.holds(at, box):
                return smaller
            verdict, tile = self._judged(tile)
            if self.verdict is not None and verdict != self.verdict:
                step = Step.STABILITY if verdict[0] == self.verdict[0] else Step.ADMISSIBILITY
                return Obstacle(step, Remedy.SMALLER, detail=place)
            if None in verdict and self.verdict is None and width > least:
                return smaller
            reached = repr(float(center) + 0.499 * width)
            if float(reached) >= float(goal):
                reached = goal
            if reached == goal and last:
                following = _box_of(last[-1])
            else:
                following = self._orbit(reached, tile.end(float(reached)))
        except Obstacle:
            return smaller
        if not tile.holds(reached, following):
            return smaller
        self.tiles.append(tile)
        self.verdict = verdict
        self.boxes += [tile_box(family.motif, tile), orbit_entry(family, reached, following)]
        return reached, following

    def _judged(self, tile: Tile) -> tuple[tuple[bool | None, bool | None], Tile]:
        """Return the verdicts (real, stable) on all orbits of a tile, and the tile with a basis for the checker.

        Radii are enlarged for the stability, so that the checker's arithmetic comes to the same verdict.
        """
        values, balls = tile.values(), tile.balls()
        roomy = self.family.system(_wider(values))
        steady, basis = stable_in_basis(roomy, [[_wider(v) for v in node] for node in balls])
        return (examine(self.family.motif, self.family.numbers(values), balls).real, steady), replace(
            tile, basis=basis
        )


def _box_of(entry: Entry) -> Box:
    return Box([[[mid, rad] for mid, _, rad in node] for node in entry["nodes"]], [])


def _wider(value: arb) -> arb:
    return value + library().arb(0, value.rad() * ROOM)


@dataclass(frozen=True)
class Pieces:
    """Proof for a branch: one piece for each stretch between neighbouring special points.

    Attributes
    ----------
    pieces : tuple of Piece
    places : tuple of (int, int)
        For each piece the indices of the first and last point of its stretch.
    """

    pieces: tuple[Piece, ...]
    places: tuple[tuple[int, int], ...] = ()
    kind: str = field(default="branch", init=False)

    @property
    def existence(self) -> bool:
        """Whether every stretch is covered."""
        return bool(self.pieces) and all(piece.existence for piece in self.pieces)

    @property
    def real(self) -> bool | None:
        """The verdict on all stretches; None if they differ."""
        return _common([piece.real for piece in self.pieces])

    @property
    def stable(self) -> bool | None:
        """The verdict on all stretches; None if they differ."""
        return _common([piece.stable for piece in self.pieces])

    @property
    def radius(self) -> float | None:
        """The largest radius of a tile."""
        return max((piece.radius for piece in self.pieces if piece.radius is not None), default=None)

    @property
    def obstacles(self) -> tuple[Obstacle, ...]:
        """Obstacles of all stretches."""
        return tuple(obstacle for piece in self.pieces for obstacle in piece.obstacles)

    def to_dict(self) -> dict[str, Any]:
        """Return the pieces as a dict for JSON."""
        return {
            "kind": "branch",
            "existence": self.existence,
            "real": self.real,
            "stable": self.stable,
            "radius": self.radius,
            "nodes": [],
            "pieces": [piece.to_dict() for piece in self.pieces],
        }

    def certificate(self) -> list[dict[str, Any]]:
        """Return the certificates of all pieces that are covered at least in part."""
        return [piece.certificate() for piece in self.pieces if piece.count]

    def __str__(self) -> str:
        return "\n".join(str(piece) for piece in self.pieces) or "no stretch of the branch to prove"


def _common(verdicts: list[bool | None]) -> bool | None:
    return verdicts[0] if verdicts and len(set(verdicts)) == 1 else None
