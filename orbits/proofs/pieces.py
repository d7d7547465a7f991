"""Pieces of branches: an interval of the parameter covered by tiles, with one verdict on all orbits of it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from orbits.proofs.admissible import examine
from orbits.proofs.balls import Given, ball, decimal, library, precision
from orbits.proofs.enclosing import enclose, refine
from orbits.proofs.equations import Motif, System
from orbits.proofs.obstacles import Obstacle, Remedy, Step
from orbits.proofs.proof import FORMAT
from orbits.proofs.stability import stable_in_basis
from orbits.proofs.tiles import Tile, joined, lay

BITS = 128
FIRST = 1 / 16  # first tile's share of the piece
ROOM = 0.8  # by which a tile is widened where its stability is judged
LEAST = 1e-6  # smallest tile's share


@dataclass(frozen=True)
class Piece:
    """What is proved of a piece of a branch.

    Attributes
    ----------
    motif : Motif
    parameters : dict
        All but the one that varies.
    parameter : str
    asked : (float, float)
        The interval that was to be covered.
    tiles : tuple of Tile
        In ascending order, neighbours overlapping; empty where not even the first was proved.
    joints : tuple of (str, list)
        A value of the parameter common to neighbouring tiles, and the box of an orbit there that lies in both.
    real, stable : bool or None
        Of all orbits of the piece; None where the verdict is not the same, or not proved, everywhere.
    obstacles : tuple of Obstacle
        Why the cover ends before the interval does.
    """

    motif: Motif
    parameters: Mapping[str, Any]
    parameter: str
    asked: tuple[float, float]
    tiles: tuple[Tile, ...] = ()
    joints: tuple[tuple[str, Any], ...] = ()
    real: bool | None = None
    stable: bool | None = None
    obstacles: tuple[Obstacle, ...] = ()
    bits: int = BITS
    kind: str = field(default="piece", init=False)

    @property
    def existence(self) -> bool:
        """Whether the whole interval is covered."""
        return bool(self.tiles) and not self.obstacles

    @property
    def covered(self) -> tuple[str, str] | None:
        """The interval that is covered, as exact decimals."""
        if not self.tiles:
            return None
        last = self.tiles[-1]
        reached = min(self.asked[1], float(last.center) + float(last.half) * (1 - 1e-3))
        return repr(self.asked[0]), repr(reached)

    @property
    def radius(self) -> float | None:
        """The largest radius of a tile at one value of the parameter."""
        return max((tile.radius for tile in self.tiles), default=None)

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
            "tiles": len(self.tiles),
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
        if not self.tiles:
            raise ValueError(
                "nothing was proved, so there is no certificate: " + "; ".join(map(str, self.obstacles))
            )
        motif = self.motif
        return {
            "format": FORMAT,
            "kind": "piece",
            "machine": motif.machine,
            "parameters": {name: v if isinstance(v, str) else list(v) for name, v in self.parameters.items()},
            "parameter": self.parameter,
            "events": "".join(motif.events),
            "modes": list(motif.modes),
            "periods": motif.periods,
            "half": motif.half,
            "frictionless": motif.frictionless,
            "tiles": [[tile.center, tile.half, tile.nodes, tile.basis] for tile in self.tiles],
            "joints": [[value, nodes] for value, nodes in self.joints],
            "covered": list(self.covered or ()),
            "claims": {"existence": True, "real": self.real, "stable": self.stable},
            "bits": self.bits,
        }

    def __str__(self) -> str:
        from orbits.proofs.wording import piece_sentence

        return piece_sentence(self)


def prove_piece(
    motif: Motif,
    guess: Callable[[float], np.ndarray],
    parameters: Mapping[str, Given],
    parameter: str,
    low: float,
    high: float,
) -> Piece:
    """Cover an interval of the parameter by tiles on which all orbits are real (or virtual) and stable (or unstable) alike.

    Parameters
    ----------
    motif : Motif
    guess : function of the parameter's value
        Computed nodes (l, n) near the branch there.
    parameters : dict
        Of the machine; the one that varies is left out of account.
    parameter : str
    low, high : float
        low < high.
    """
    given = {name: decimal(value) for name, value in parameters.items() if name != parameter}
    tiles: list[Tile] = []
    joints: list[tuple[str, Any]] = []
    verdict: tuple[bool | None, bool | None] | None = None
    length = high - low
    place, width = low, length * FIRST
    obstacle = None
    with precision(BITS):
        p = {name: ball(value) for name, value in given.items()}
        while place < high:
            width = min(width, 1.02 * (high - place) + 1e-12)
            made = _made(motif, p, parameter, guess, place, width, verdict, tiles[-1] if tiles else None)
            if isinstance(made, Obstacle):
                if width < LEAST * length:
                    obstacle = made
                    break
                width /= 2
                continue
            tile, verdict, joint = made
            tiles.append(tile)
            joints += [joint] if joint else []
            place = float(tile.center) + float(tile.half) * (1 - 1e-3)
            width *= 1.6
    real, steady = verdict or (None, None)
    return Piece(
        motif,
        given,
        parameter,
        (low, high),
        tuple(tiles),
        tuple(joints),
        real,
        steady,
        (obstacle,) if obstacle else (),
    )


def _made(
    motif: Motif,
    p: Mapping[str, Any],
    name: str,
    guess: Callable[[float], np.ndarray],
    place: float,
    width: float,
    verdict: tuple[bool | None, bool | None] | None,
    before: Tile | None,
) -> tuple[Tile, tuple[bool | None, bool | None], tuple[str, Any] | None] | Obstacle:
    """The next tile and the verdict on it, or what was in the way."""
    where = f"{name} = {place:.6g}"
    # a little to the left of `place`, so that neighbours overlap
    start = place - 0.01 * width
    center, half = f"{start + width / 2:.15g}", f"{width / 2:.6g}"
    try:
        middle = _point(motif, p, name, center, guess)
    except Obstacle as obstacle:
        return obstacle
    tile = lay(motif, p, name, center, half, middle)
    if tile is None:
        return Obstacle(Step.PIECE, Remedy.SMALLER, detail=where)
    joint = _joint(motif, p, name, before, tile, guess, place) if before is not None else None
    if before is not None and joint is None:
        return Obstacle(Step.PIECE, Remedy.SMALLER, detail=f"{where}, joint")
    here = {**p, name: tile.values()}
    balls = tile.balls()
    # with room to spare, so that another arithmetic comes to the same verdict
    roomy = {**p, name: _wider(tile.values())}
    steady, basis = stable_in_basis(System(motif, roomy), [[_wider(v) for v in node] for node in balls])
    found = (examine(motif, here, balls).real, steady)
    tile = replace(tile, basis=basis)
    if verdict is None and None in found and width > 1e-4 * abs(place):
        return Obstacle(Step.PIECE, Remedy.SMALLER, detail=where)
    if None in found or (verdict is not None and found != verdict):
        return Obstacle(
            Step.ADMISSIBILITY if found[0] is None else Step.STABILITY, Remedy.SMALLER, detail=where
        )
    return tile, found, joint


def _wider(value: Any) -> Any:
    return value + library().arb(0, value.rad() * ROOM)


def _point(
    motif: Motif, p: Mapping[str, Any], name: str, value: str, guess: Callable[[float], np.ndarray]
) -> Any:
    system = System(motif, {**p, name: ball(value)})
    start = [[ball(float(v)) for v in node] for node in guess(float(value))]
    return refine(system, start, [], BITS)[0]


def _joint(
    motif: Motif,
    p: Mapping[str, Any],
    name: str,
    before: Tile,
    tile: Tile,
    guess: Callable[[float], np.ndarray],
    place: float,
) -> tuple[str, Any] | None:
    """A common value of the parameter and the box of an orbit there that lies in both tiles; None if none is proved."""
    value = repr(place)
    at = ball(value)
    if not (before.values().contains(at) and tile.values().contains(at)):
        return None
    try:
        system = System(motif, {**p, name: at})
        box = enclose(system, _point(motif, p, name, value, guess), [], BITS)
    except Obstacle:
        return None
    return (value, box.nodes) if joined(before, tile, box.balls()[0], at) else None


@dataclass(frozen=True)
class Pieces:
    """A branch, stretch by stretch between its special points.

    Attributes
    ----------
    pieces : tuple of Piece
    """

    pieces: tuple[Piece, ...]
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

    def certificate(self) -> dict[str, Any]:
        """The certificates of the pieces of which something is proved."""
        made = [piece.certificate() for piece in self.pieces if piece.tiles]
        return {"format": FORMAT, "kind": "branch", "pieces": made, "claims": {"existence": self.existence}}

    def __str__(self) -> str:
        return "\n".join(str(piece) for piece in self.pieces) or "no stretch of the branch to prove"


def _common(verdicts: list[bool | None]) -> bool | None:
    return verdicts[0] if verdicts and len(set(verdicts)) == 1 else None
