"""Regions: the parts into which loci cut the plane of two parameters, and what is stable in each."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

import numpy as np

CELLS = 360  # of the raster, each way
SMALLEST = 60  # cells; smaller regions are slivers between loci


@dataclass(eq=False)
class Region:
    """A connected part of the plane that no locus crosses.

    Attributes
    ----------
    at : (float, float)
        (p, q) of a point well inside, where the motions were simulated.
    share : float
        Part of the plane that it takes.
    attractors : list of dict
        What simulation found there: "word", "periods" and "kind" of each motion.
    cells : ndarray of bool
        Its cells in a raster of the plane; rows are values of p, columns of q.
    """

    at: tuple[float, float]
    share: float
    attractors: list[dict[str, Any]] = field(default_factory=list)
    cells: np.ndarray = field(default_factory=lambda: np.zeros((0, 0), bool), repr=False)

    @property
    def words(self) -> list[str]:
        """The words of the motions that are stable there; "chaotic", "modulated" and the like where there is no word."""
        names = [name_of(found) for found in self.attractors]
        return [
            name if names.count(name) == 1 else f"{names.count(name)} x {name}"
            for name in dict.fromkeys(names)
        ]

    def to_dict(self, parameters: tuple[str, str]) -> dict[str, Any]:
        """The entry of this region in the JSON of a chart."""
        return {
            "at": dict(zip(parameters, map(float, self.at))),
            "share": float(self.share),
            "words": self.words,
            "attractors": self.attractors,
        }


def name_of(found: dict[str, Any]) -> str:
    """The word of an attractor, with its periods where they are more than one; its kind where it has no word."""
    word, periods = found.get("word"), int(found.get("periods") or 0)
    if found.get("kind") == "stuck":
        return "stuck"
    if not word:
        return str(found.get("kind") or "?")
    return word if periods <= 1 or found.get("kind") == "cycle" else f"{word} k={periods}"


def divide(
    curves: Iterable[np.ndarray], within: tuple[tuple[float, float], tuple[float, float]], cells: int = CELLS
) -> list[Region]:
    """The regions between curves, largest first, without what is stable there.

    Parameters
    ----------
    curves : iterable of ndarray, shape (n, 2)
        (p, q) along each.
    within : ((float, float), (float, float))
        Intervals of p and q.
    cells : int
        Of the raster, each way.
    """
    from scipy.ndimage import distance_transform_edt, label

    free = np.ones((cells, cells), dtype=bool)
    lows = np.array([within[0][0], within[1][0]])
    widths = np.array([within[0][1] - within[0][0], within[1][1] - within[1][0]])
    for curve in curves:
        scaled = (np.asarray(curve) - lows) / widths * cells
        for a, b in pairwise(scaled):
            if not (np.isfinite(a).all() and np.isfinite(b).all()):
                continue
            steps = int(np.ceil(2.0 * np.abs(b - a).max())) + 1
            places = np.floor(a + np.linspace(0.0, 1.0, steps + 1)[:, None] * (b - a)).astype(int)
            inside = ((places >= 0) & (places < cells)).all(axis=1)
            free[places[inside, 0], places[inside, 1]] = False
    marked, count = label(free)  # type: ignore[misc]
    padded = np.pad(free, 1, constant_values=False)
    depth = distance_transform_edt(padded)[1:-1, 1:-1]  # type: ignore[index]
    regions = []
    for number in range(1, count + 1):
        own = marked == number
        size = int(own.sum())
        if size < SMALLEST:
            continue
        inner = np.where(own, depth, -1.0)
        i, j = np.unravel_index(int(np.argmax(inner)), inner.shape)
        p, q = lows + (np.array([i, j]) + 0.5) / cells * widths
        regions.append(Region((float(p), float(q)), size / cells**2, [], own))
    return sorted(regions, key=lambda region: -region.share)
