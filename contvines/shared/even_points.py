"""Points that fill a cube evenly, however many there are."""

from __future__ import annotations

import numpy as np

GOLDEN = 60  # steps to the root


def low_discrepancy(dimension: int, count: int, seed: int, first: int = 0) -> np.ndarray:
    """Points of the unit cube, shape (count, dimension): an additive recurrence, shifted by the seed.

    Parameters
    ----------
    dimension, count : int
    seed : int
        Of the shift (Cranley and Patterson 1976); each seed is another, equally even, set of points.
    first : int
        Number of the first point, so that draws can go on.

    Notes
    -----
    Point n is ``shift + n (1/g, 1/g^2, ...) mod 1`` with ``g^(d+1) = g + 1`` (M. Roberts 2018; in one dimension the golden
    ratio, whose gaps have at most three lengths for every count: the three-distance theorem). Sobol's points of `scipy.stats` would take
    longer to import than many a diagram takes.
    """
    root = 2.0
    for _ in range(GOLDEN):
        root = (1.0 + root) ** (1.0 / (dimension + 1))
    shift = np.random.default_rng(seed).random(dimension)
    steps = root ** -np.arange(1.0, dimension + 1)
    return (shift + np.arange(first, first + count)[:, None] * steps) % 1.0
