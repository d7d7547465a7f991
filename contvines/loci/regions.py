"""Regions: the parts into which loci cut the plane of two parameters, and what is stable in each."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

import numpy as np

CELLS = 360  # of the raster, each way
SMALLEST = 60  # cells; smaller regions are slivers between loci
FEWEST, MOST = 2, 5  # places of a region
PER_PLACE = 0.05  # of the plane: so much more asks for one more
INNER = 0.3  # of the largest distance from the loci, at least, is that of every place


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
        What simulation found there: "word", "periods" and "kind" of each motion; of a modulated one "modulation" and its band, too.
    elsewhere : list of dict
        Further places of the region, far from one another: "at" and "attractors" of each.
    cells : ndarray of bool
        Its cells in a raster of the plane; rows are values of p, columns of q.
    """

    at: tuple[float, float]
    share: float
    attractors: list[dict[str, Any]] = field(default_factory=list)
    cells: np.ndarray = field(default_factory=lambda: np.zeros((0, 0), bool), repr=False)
    elsewhere: list[dict[str, Any]] = field(default_factory=list)

    @property
    def words(self) -> list[str]:
        """The words of the motions that are stable at the middle place; "chaotic", "modulated" and the like where there is no word."""
        return words_of(self.attractors)

    @property
    def others(self) -> list[tuple[tuple[float, float], list[str]]]:
        """The places at which other motions are stable than at the middle one, and their words: something that no locus shows happens between."""
        told = [((place["at"][0], place["at"][1]), words_of(place["attractors"])) for place in self.elsewhere]
        return [(at, words) for at, words in told if sorted(words) != sorted(self.words)]

    def to_dict(self, parameters: tuple[str, str]) -> dict[str, Any]:
        """The entry of this region in the JSON of a chart."""
        return {
            "at": dict(zip(parameters, map(float, self.at))),
            "share": float(self.share),
            "words": self.words,
            "attractors": self.attractors,
            "agrees": not self.others,
            "elsewhere": [
                {
                    **place,
                    "at": dict(zip(parameters, map(float, place["at"]))),
                    "words": words_of(place["attractors"]),
                }
                for place in self.elsewhere
            ],
        }


def words_of(attractors: list[dict[str, Any]]) -> list[str]:
    """Names of attractors, with their number where several have the same one."""
    names = [name_of(found) for found in attractors]
    return [
        name if names.count(name) == 1 else f"{names.count(name)} x {name}" for name in dict.fromkeys(names)
    ]


def name_of(found: dict[str, Any]) -> str:
    """The word of an attractor, with its periods where they are more than one; its modulation or its kind where it has no word."""
    if modulation := found.get("modulation"):
        return str(modulation)
    word, periods = found.get("word"), int(found.get("periods") or 0)
    if found.get("kind") == "stuck":
        return "stuck"
    if not word:
        return str(found.get("kind") or "?")
    return word if periods <= 1 or found.get("kind") == "cycle" else f"{word} k={periods}"


def divide(
    curves: Iterable[np.ndarray], within: tuple[tuple[float, float], tuple[float, float]]
) -> list[Region]:
    """The regions between curves, largest first, without what is stable there.

    Parameters
    ----------
    curves : iterable of ndarray, shape (n, 2)
        (p, q) along each.
    within : ((float, float), (float, float))
        Intervals of p and q.
    """
    from scipy.ndimage import distance_transform_edt, label

    free = np.ones((CELLS, CELLS), dtype=bool)
    lows = np.array([within[0][0], within[1][0]])
    widths = np.array([within[0][1] - within[0][0], within[1][1] - within[1][0]])
    for curve in curves:
        scaled = (np.asarray(curve) - lows) / widths * CELLS
        for a, b in pairwise(scaled):
            if not (np.isfinite(a).all() and np.isfinite(b).all()):
                continue
            steps = int(np.ceil(2.0 * np.abs(b - a).max())) + 1
            places = np.floor(a + np.linspace(0.0, 1.0, steps + 1)[:, None] * (b - a)).astype(int)
            inside = ((places >= 0) & (places < CELLS)).all(axis=1)
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
        (p, q), *more = lows + (_places(inner, size / CELLS**2) + 0.5) / CELLS * widths
        further = [{"at": [float(a), float(b)], "attractors": []} for a, b in more]
        regions.append(Region((float(p), float(q)), size / CELLS**2, [], own, further))
    return sorted(regions, key=lambda region: -region.share)


def _places(depth: np.ndarray, share: float) -> np.ndarray:
    """Cells of a region, shape (n, 2): the one farthest from its edges, then those farthest from the ones before and not near an edge."""
    count = int(np.clip(FEWEST + share / PER_PLACE, FEWEST, MOST))
    inner = np.argwhere(depth >= max(INNER * depth.max(), 1.0))
    chosen = [np.array(np.unravel_index(int(np.argmax(depth)), depth.shape))]
    away = np.full(len(inner), np.inf)
    while len(chosen) < count:
        away = np.minimum(away, np.hypot(*(inner - chosen[-1]).T))
        if not away.max() > 0.0:
            break
        chosen.append(inner[int(np.argmax(away))])
    return np.array(chosen)
