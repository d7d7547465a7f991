"""Rows: multipliers and margins of points, as the kernel ``inspect`` writes them, and what they say."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..problems.protocol import Problem


def _of_rows(extreme: np.ufunc, rows: np.ndarray) -> np.ndarray:
    """The smallest or largest of each row; of few columns a column at a time, which takes a tenth of a reduction's time."""
    if rows.ndim == 1 or rows.shape[-1] > 16:
        return np.asarray(extreme.reduce(rows, axis=-1))
    found = rows[..., 0].copy()
    for j in range(1, rows.shape[-1]):
        extreme(found, rows[..., j], out=found)
    return found


class Rows:
    """The part of an engine that reads rows: ``m`` multipliers as (re, im) pairs, then the margins.

    Attributes
    ----------
    problem : Problem
    m, row_size : int
    """

    problem: Problem
    m: int
    row_size: int
    _rows: np.ndarray

    def rows(self, count: int) -> np.ndarray:
        """Room for rows, the same one every time: large, written once and read once."""
        if len(self._rows) < count:
            self._rows = np.zeros((count, self.row_size))
        return self._rows[:count]

    def spectrum(self, rows: np.ndarray) -> NDArray[np.complex128]:
        """Raw multipliers of some rows, shape (..., m)."""
        pairs = np.ascontiguousarray(rows[..., : 2 * self.m])
        return pairs.view(np.complex128) + 0.0  # a copy, without negative zeros

    def margins(self, rows: np.ndarray) -> np.ndarray:
        """Margins of some rows, shape (..., n_margins); NaN counts as not applicable."""
        return np.fmin(rows[..., 2 * self.m :], np.inf)

    def smallest_margin(self, rows: np.ndarray) -> np.ndarray:
        """Smallest margin of each row, +inf where there are none."""
        margins = rows[..., 2 * self.m :]  # fmin passes over NaN
        if margins.ndim == 1 or not margins.shape[-1]:
            return np.fmin.reduce(margins, axis=-1, initial=np.inf)
        return np.fmin(_of_rows(np.fmin, margins), np.inf)

    def multipliers(self, rows: np.ndarray) -> np.ndarray:
        """Multipliers of the full period, shape (..., m)."""
        return np.asarray(self.problem.to_multipliers(self.spectrum(rows)), dtype=complex)

    @property
    def tells_stability(self) -> bool:
        """Whether the problem has a spectrum that tells stability; else it is not computed."""
        return self.problem.spectrum in ("map", "flow")

    def stable(self, rows: np.ndarray) -> np.ndarray:
        """Whether all multipliers are inside the unit circle (left of the imaginary axis for flows); False where nothing says."""
        return self.outermost(rows) < 0.0

    def outermost(self, rows: np.ndarray) -> np.ndarray:
        """How far the outermost multiplier is outside the unit circle (right of the imaginary axis for flows); NaN where nothing says."""
        if not self.tells_stability:
            return np.full(rows.shape[:-1], np.nan)
        if not self.m:
            return np.full(rows.shape[:-1], -np.inf)
        spectrum = self.spectrum(rows)
        if self.problem.spectrum == "flow":
            return _of_rows(np.maximum, spectrum.real)
        return _of_rows(np.maximum, np.abs(spectrum)) - 1.0
