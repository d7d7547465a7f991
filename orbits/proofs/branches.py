"""What is proved of a whole branch: its pieces, stretch by stretch between its special points."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from orbits.proofs.obstacles import Obstacle
from orbits.proofs.pieces import Piece


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
