"""Pieces of branches: an interval of the parameter covered by tiles, with one verdict on all orbits of it."""

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


BITS = 192
FIRST = 1 / 16  # first tile's share of the piece
ROOM = 0.8  # by which a tile is widened where its stability is judged
GRADE = 0.35  # near a special point a tile's width over the distance


@dataclass(frozen=True)
class Piece:
    """What is proved of a piece of a branch.

    Attributes
    ----------
    motif : Motif
    parameters : dict
        All but those that vary.
    varying : Varying
    asked : (float, float)
        The interval that was to be covered.
    boxes : tuple of dict
        For the certificate: orbits and tiles in turn, in ascending order.
    covered : (str, str) or None
        The interval that is covered by orbits with one verdict, as exact decimals.
    count : int
        Of tiles.
    radius : float or None
        The largest radius of a tile at one value of the parameter.
    ends : (str or None, str or None)
        The kinds of the special points up to which it goes.
    real, stable : bool or None
        Of all orbits of the piece; None where the verdict is not the same, or not proved, everywhere.
    obstacles : tuple of Obstacle
        Why the cover ends before the interval does.
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
        """Name of the parameter that varies."""
        return self.varying.name

    def to_dict(self) -> dict[str, Any]:
        """The piece as JSON."""
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
        """All that a checker needs; JSON.

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
) -> Piece:
    """Cover an interval of the parameter by tiles on which all orbits are real (or virtual) and stable (or unstable) alike.

    Parameters
    ----------
    motif : Motif
    guess : function of the parameter's value
        Computed nodes (l, n) near the branch there.
    parameters : dict
        Of the machine; those that vary are left out of account.
    varying : Varying
    low, high : float
        low < high.
    ends : (Proof or None, Proof or None)
        Special points at which the piece begins and ends: then it goes up to the points themselves.
    """
    given = {name: decimal(value) for name, value in parameters.items() if name not in varying.numbers}
    check_symmetry(motif, given, varying)
    with precision(BITS):
        cover = _Cover(Family(motif, {name: ball(value) for name, value in given.items()}, varying))
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
        tuple(end.kind if end and met else None for end, met in zip(ends, (bool(first), cover.arrived))),
        real,
        steady,
        (obstacle,) if obstacle else (),
    )


def _chain(end: Proof, guess: Callable[[float], np.ndarray], inside: float) -> list[Entry]:
    """The chain of a special point, its last orbit the one on the piece's side."""
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
    """Tiles laid one after another from the left to the right end, and the orbits that join them."""

    def __init__(self, family: Family) -> None:
        self.family = family
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
        """Cover from `low`, or from the special point `first`, to `high`, or to `last`; what was in the way."""
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
            made = self._next(at, box, width, 2 * least, goal, last)
            if isinstance(made, Obstacle):
                if width < least:
                    self.reached = (start, at)
                    return made
                width /= 2
                continue
            at, box = made
            width *= 1.6
        self.reached = (start, at)
        if last:
            self.boxes += last[1::-1]
            self.arrived = True
        return None

    def _orbit(self, value: str, start: Sequence[Sequence[float]] | np.ndarray) -> Box:
        nodes = as_balls(start)
        return orbit_at(self.family, value, nodes, BITS)

    def _next(
        self, at: str, box: Box, width: float, least: float, goal: str, last: list[Entry] | None
    ) -> tuple[str, Box] | Obstacle:
        """Lay a tile of this width from the orbit `box` at `at` on, and prove the orbit near its right end.

        The first tile may leave a verdict open only where it is narrower than `least`.
        """
        family = self.family
        where = f"{family.varying.name} = {float(at):.6g}"
        smaller = Obstacle(Step.PIECE, Remedy.SMALLER, detail=where)
        # a little to the left of `at`, so that the orbit lies within
        center = repr(float(at) + 0.49 * width)
        half = f"{width / 2:.6g}"
        before = np.array([[float(mid) for mid, _ in node] for node in box.nodes])
        nodes = self.tiles[-1].end(float(center)) if self.tiles else before
        along = Along(family, None, ball(center))
        try:
            system = family.system(ball(center))
            z, _ = refine(system, as_balls(nodes), [], BITS)
            tile = lay(along, center, half, z, ball(center))
            if tile is None or not tile.holds(at, box):
                return smaller
            verdict, tile = self._judged(tile)
            if self.verdict is not None and verdict != self.verdict:
                step = Step.STABILITY if verdict[0] == self.verdict[0] else Step.ADMISSIBILITY
                return Obstacle(step, Remedy.SMALLER, detail=where)
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
        """Whether all orbits of a tile are real, and stable, with room to spare: another arithmetic must come to the same."""
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
    """A branch, stretch by stretch between its special points.

    Attributes
    ----------
    pieces : tuple of Piece
    places : tuple of (int, int)
        The points of the branch between which each of them lies.
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
        """The verdict on all stretches, None where they differ."""
        return _common([piece.real for piece in self.pieces])

    @property
    def stable(self) -> bool | None:
        """The verdict on all stretches, None where they differ."""
        return _common([piece.stable for piece in self.pieces])

    @property
    def radius(self) -> float | None:
        """The largest radius of a tile."""
        return max((piece.radius for piece in self.pieces if piece.radius is not None), default=None)

    @property
    def obstacles(self) -> tuple[Obstacle, ...]:
        """Those of all stretches."""
        return tuple(obstacle for piece in self.pieces for obstacle in piece.obstacles)

    def to_dict(self) -> dict[str, Any]:
        """The pieces as JSON."""
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
        """The certificates of the pieces of which something is proved."""
        return [piece.certificate() for piece in self.pieces if piece.count]

    def __str__(self) -> str:
        return "\n".join(str(piece) for piece in self.pieces) or "no stretch of the branch to prove"


def _common(verdicts: list[bool | None]) -> bool | None:
    return verdicts[0] if verdicts and len(set(verdicts)) == 1 else None
