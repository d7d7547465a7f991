"""An attractor that simulation has met, as a graph keeps it."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

from ..shared.motions import called


@dataclass
class Attractor:
    """One attractor at one value.

    Attributes
    ----------
    value : float
    word : str
    periods : int
    kind : str
        ``periodic``, ``sliding``, ``stuck``, ``chatter``, ``chaotic``, ``quasi-periodic``, ``slow``, ``escaped``, ``stopped`` or
        ``impossible`` (the start lies inside a wall).
    branch : str or None
        Label of the branch on which it lies.
    share : float
        Of the starts that reach it or its mirror image.
    mirror_share : float
        Of the starts that reach the image other than the one found first.
    starts : int
        How many were simulated at this value; 0 where another motion was followed here past the end of its stability, so that it has no share.
    exponent, error : float
        Largest Lyapunov exponent per period and its standard error, where it does not recur.
    """

    value: float
    word: str
    periods: int
    kind: str
    branch: str | None
    share: float
    mirror_share: float = 0.0
    starts: int = 0
    exponent: float = float("nan")
    error: float = float("nan")

    @property
    def name(self) -> str:
        """Name that is shown: its word, or what kind of motion has none."""
        return called(self.word, self.kind)

    def to_dict(self) -> dict[str, Any]:
        """The entry in the JSON of a graph."""
        return asdict(self)
