"""Scales: what counts as large in each unknown, in the parameter and in each equation."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

APART = 30.0  # of many unknowns those whose sizes differ by less belong to one field
MANY = 20  # unknowns of fewer have each its own scale


@dataclass(frozen=True)
class Scales:
    """Typical sizes.

    Attributes
    ----------
    unknowns : ndarray, shape (N,)
    parameter : float
    rows : ndarray, shape (N,)
        Change of each equation when every unknown and the parameter change by their scale.
    rate : float
        Typical size of an eigenvalue of dF/du.
    noise : float
        Accuracy to which unknowns can be obtained, relative to their scale; 0: to roundoff.
    untold : tuple of int
        Unknowns of which nothing tells how large they become; their scale is 1.
    """

    unknowns: np.ndarray
    parameter: float
    rows: np.ndarray
    rate: float = 1.0
    noise: float = 0.0
    untold: tuple[int, ...] = ()

    @cached_property
    def vector(self) -> np.ndarray:
        """Scales of (u, p)."""
        return np.append(self.unknowns, self.parameter)

    def head(self, n: int) -> Scales:
        """Of the first n unknowns only."""
        return Scales(self.unknowns[:n], self.parameter, self.rows[:n], self.rate, self.noise)

    def tiled(self, times: int) -> Scales:
        """For a problem that consists of that many copies of the unknowns."""
        return Scales(
            np.tile(self.unknowns, times), self.parameter, np.tile(self.rows, times), self.rate, self.noise
        )


def flat_start(u0: ArrayLike, name: str = "u0") -> np.ndarray:
    """A user's start as a flat array of its own.

    Parameters
    ----------
    u0 : array_like
    name : str
        What it is called, for messages.

    Raises
    ------
    ValueError
        If it is empty, no numbers, or has several axes.
    """
    try:
        start = np.array(u0, dtype=float)
    except (TypeError, ValueError) as error:
        raise ValueError(f"{name} = {u0!r} must be numbers, one for each unknown: {error}") from None
    if start.size == 0:
        raise ValueError(f"{name} is empty; give a start for each unknown")
    if start.ndim > 1:
        raise ValueError(
            f"{name} has shape {start.shape}; the equations see their unknowns in a row: give {name} of shape ({start.size},)"
        )
    return start.reshape(-1)


def given_scale(scale: ArrayLike | None, n: int) -> np.ndarray | None:
    """A user's ``scale`` as an array of n positive numbers; None stays None.

    Raises
    ------
    ValueError
        If it is anything else.
    """
    if scale is None:
        return None
    try:
        values = np.array(np.broadcast_to(np.asarray(scale, dtype=float), (n,)))
    except (TypeError, ValueError):
        raise ValueError(
            f"scale = {scale!r} must be a positive number, or {n} of them, one per unknown"
        ) from None
    if not (np.isfinite(values).all() and (values > 0.0).all()):
        raise ValueError(f"scale = {scale!r} must be positive and finite")
    return values


def in_fields(sizes: np.ndarray) -> np.ndarray:
    """Sizes of many unknowns, those of one field made equal: a field is what no gap in the sorted sizes parts.

    The value of a field next to a wall is small, but what counts as large there is what counts as large elsewhere.
    """
    if len(sizes) <= MANY:
        return sizes
    order = np.argsort(sizes)
    gaps = np.flatnonzero(sizes[order][1:] > APART * sizes[order][:-1])
    result = np.empty_like(sizes)
    for part in np.split(order, gaps + 1):
        result[part] = np.sqrt((sizes[part] ** 2).mean())
    return result
