"""Rows: multipliers and margins of points, as the kernel ``inspect`` writes them, and what they say."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..problems.protocol import Problem


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
        m = self.m
        return rows[..., 0 : 2 * m : 2] + 1j * rows[..., 1 : 2 * m : 2]

    def margins(self, rows: np.ndarray) -> np.ndarray:
        """Margins of some rows, shape (..., n_margins); NaN counts as not applicable."""
        return np.fmin(rows[..., 2 * self.m :], np.inf)

    def smallest_margin(self, rows: np.ndarray) -> np.ndarray:
        """Smallest margin of each row, +inf where there are none."""
        if rows.shape[-1] <= 2 * self.m:
            return np.full(rows.shape[:-1], np.inf)
        margins = rows[..., 2 * self.m :]  # fmin passes over NaN
        if margins.ndim == 1:
            smallest = float(np.fmin.reduce(margins))
            return np.asarray(smallest if smallest == smallest else np.inf)
        if margins.shape[-1] > 16:
            smallest = np.fmin.reduce(margins, axis=-1)
        else:  # few columns, many rows
            smallest = margins[..., 0].copy()
            for j in range(1, margins.shape[-1]):
                np.fmin(smallest, margins[..., j], out=smallest)
        return np.where(np.isnan(smallest), np.inf, smallest)

    def multipliers(self, rows: np.ndarray) -> np.ndarray:
        """Multipliers of the full period, shape (..., m)."""
        return np.asarray(self.problem.to_multipliers(self.spectrum(rows)), dtype=complex)

    def stable(self, rows: np.ndarray) -> np.ndarray:
        """Whether all multipliers are inside the unit circle (left of the imaginary axis for flows)."""
        spectrum = self.spectrum(rows)
        if self.problem.spectrum == "map":
            return np.all(np.abs(spectrum) < 1.0, axis=-1)
        if self.problem.spectrum == "flow":
            return np.all(spectrum.real < 0.0, axis=-1)
        return np.zeros(rows.shape[:-1], dtype=bool)

    def marginal(self, rows: np.ndarray, tolerance: float) -> np.ndarray:
        """Whether the outermost multiplier is on the unit circle (the imaginary axis) up to a tolerance."""
        if self.problem.spectrum == "none" or not self.m:
            return np.zeros(rows.shape[:-1], dtype=bool)
        spectrum = self.spectrum(rows)
        outermost = (
            spectrum.real.max(axis=-1)
            if self.problem.spectrum == "flow"
            else np.abs(spectrum).max(axis=-1) - 1.0
        )
        return np.abs(outermost) <= tolerance
