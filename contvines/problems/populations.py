"""Starts in a box, of maps and flows."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np


class StartsInBox:
    """Starts in a box; see the contract in `contvines.problems.abilities.Population`.

    Parameters
    ----------
    name : str
        Of the map or flow.
    parameter : str
    box : sequence of (low, high), optional
        One pair per state; by default round the points, widened by their extent on every side.
    points : ndarray, shape (n, d)
        States that are known.
    lengths : float or ndarray, shape (d,)
        By so much the box is widened at least.

    Raises
    ------
    ValueError
        If the box has not one pair low < high per state.
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
        """Steps of a map, or periods of a flow, so far, those that solve for cycles included."""
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
        """The name of the map or flow."""
        return {"name": self.name}

    def box(self, p: float) -> np.ndarray:
        """Ranges of the starts, shape (d, 2)."""
        return self._box

    def closed(self, p: float) -> list[tuple[Any, np.ndarray]]:
        """Motions known in closed form: none."""
        return []

    def observed(self, state: np.ndarray | None, p: float, periods: float = 0.0) -> dict[str, float]:
        """Measures of a motion that recurs nowhere: none."""
        return {}
