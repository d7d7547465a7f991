"""Stability by multipliers of maps and eigenvalues of flows, and where it is undecided: one of them on the boundary, none beyond."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from .floating_point import ROUNDED

KNOWN = 10.0  # times the distance at which the nearest was computed: how well the others are known that are to be on the boundary, too


def attracts(sizes: np.ndarray, boundary: float) -> bool | None:
    """Whether all are below the boundary; None where the largest is on it but for rounding.

    Parameters
    ----------
    sizes : ndarray
        Moduli of multipliers, or real parts of eigenvalues.
    boundary : float
        One, or zero.
    """
    largest = float(np.max(sizes, initial=-np.inf))
    return None if abs(largest - boundary) <= ROUNDED * boundary else largest < boundary


def onto_circle(multipliers: np.ndarray, near: float) -> np.ndarray:
    """Multipliers of a special point, those put on the unit circle that are there by definition: the nearest, and what is not told from it.

    None is, if the nearest is further from the circle than `near`: as where an event of a virtual orbit grazes.
    """
    sizes = np.abs(multipliers)
    there = _nearest(sizes - 1.0, near)
    return np.where(there, multipliers / np.where(there, sizes, 1.0), multipliers)


def onto_axis(eigenvalues: np.ndarray) -> np.ndarray:
    """The same for eigenvalues and the imaginary axis, on which one always is."""
    return np.where(_nearest(np.real(eigenvalues), np.inf), 1j * np.imag(eigenvalues), eigenvalues)


def _nearest(gaps: np.ndarray, near: float) -> np.ndarray:
    gaps = np.nan_to_num(np.abs(gaps), nan=np.inf)
    nearest = float(gaps.min(initial=np.inf))
    return (gaps <= KNOWN * nearest + ROUNDED) & np.isfinite(gaps) & (nearest <= near)


def marginal_text(multipliers: Iterable[complex], flow: bool = False) -> str:
    """Why stability is undecided, from multipliers of which some are on the boundary, and none beyond.

    >>> marginal_text([1.0, 0.3]), marginal_text([-1.0]), marginal_text([0.0, -2.0], flow=True)
    ('marginal: a multiplier is 1', 'marginal: a multiplier is -1', 'marginal: an eigenvalue is 0')
    """
    values = np.asarray(list(multipliers), dtype=complex)
    critical = values[int(np.argmax(np.real(values) if flow else np.abs(values)))]
    if flow:
        what = "an eigenvalue is 0" if critical.imag == 0.0 else "a pair of eigenvalues is imaginary"
    elif critical.imag == 0.0:
        what = f"a multiplier is {'1' if critical.real > 0.0 else '-1'}"
    else:
        what = "a pair of multipliers is on the unit circle"
    return f"marginal: {what}"
