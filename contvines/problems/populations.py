"""StartsInBox: base class of populations of maps and flows, with starts in a fixed box."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np


class StartsInBox:
    """Base class of populations with starts in a fixed box; the contract is that of `contvines.problems.abilities.Population`.

    Parameters
    ----------
    name : str
        Name of the map or flow.
    parameter : str
    box : sequence of (low, high), optional
        One pair per state; by default the bounding box of the points, widened by its extent on every side.
    points : ndarray, shape (n, d)
        Known states.
    lengths : float or ndarray, shape (d,)
        The default box is widened by at least this.

    Raises
    ------
    ValueError
        If the box does not have one pair low < high per state.
    """

    price = 1.0

    def __init__(
        self,
        name: str,
        parameter: str,
        box: Sequence[tuple[float, float]] | None,
        points: np.ndarray,
        lengths: float | np.ndarray,
    ) -> None:
        self.name, self.parameter, self.node = name, parameter, points.shape[1]
        self.work = 0.0
        """Steps of a map, or periods of a flow, simulated so far, including those of Newton's method for cycles."""
        if box is None:
            reach = np.maximum(np.ptp(points, axis=0), np.maximum(lengths, np.abs(points).max(axis=0)))
            self._box = np.column_stack([points.min(axis=0) - reach, points.max(axis=0) + reach])
            return
        try:
            self._box = np.array(box, dtype=float).reshape(-1, 2)
        except (TypeError, ValueError):
            self._box = np.empty(0)
        if (
            self._box.shape != (self.node, 2)
            or not np.isfinite(self._box).all()
            or not (self._box[:, 0] < self._box[:, 1]).all()
        ):
            raise ValueError(
                f"box = {box!r}: give {self.node} pairs (low, high) with low < high, one per state"
            )

    @property
    def about(self) -> dict[str, Any]:
        """Name of the map or flow."""
        return {"name": self.name}

    def box(self, p: float) -> np.ndarray:
        """Ranges of the starts, shape (d, 2)."""
        return self._box

    def closed(self, p: float) -> list[tuple[Any, np.ndarray]]:
        """Return the motions known in closed form: none."""
        return []

    def observed(self, state: np.ndarray | None, p: float, periods: float = 0.0) -> dict[str, float]:
        """Return measures of a simulated motion: none."""
        return {}
