"""The solution of a special point, as users hold it: its stability is undecided where a multiplier is on the boundary by definition."""

from __future__ import annotations

from ..continuation.settings import Settings
from ..problems.abilities import Critical
from .kinds import CRITICAL


def critical(found: object, kind: str) -> object:
    """The solution with its critical multipliers on the unit circle (eigenvalues on the axis), if the special point is of a kind that has them."""
    if kind in CRITICAL and isinstance(found, Critical):
        return found.critical(Settings.critical)
    return found
