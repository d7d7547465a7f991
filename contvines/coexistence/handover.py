"""What a motion hands over to where it ceases to be stable: it is followed past the ends of its stable stretches."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.sparse.csgraph import connected_components

from ..branches.branch import Branch
from ..circles.section import section_of
from ..graph.graph import Graph
from ..graph.run import Run
from ..graph.stretches import MEETING
from .census import Counted, followed
from .population import Population
from .settings import ATLAS

PAST = 0.01  # of a stable stretch's width: so far past its end a motion is followed, where it settles too slowly to be told farther, ...
BEYOND_CASCADE = 1.0  # ... and so far, for a cascade of doublings is over after 0.27 of the stretch before it (Feigenbaum's 1 / (4.669 - 1)), ...
FARTHER = 4.0  # times as far again where all that was met is too slow


@dataclass(frozen=True)
class End:
    """One end of a stable stretch of a real branch, beyond which no other stretch goes on.

    Attributes
    ----------
    label : str
        Of the branch.
    value : float
    side : float
        1.0 where larger values lie beyond, -1.0 where smaller ones do.
    width : float
        Of the stretch.
    places : tuple of int
        Points of the branch there, stable ones, the end itself first.
    """

    label: str
    value: float
    side: float
    width: float
    places: tuple[int, ...]


class Handover:
    """Ends of stable stretches, each followed once.

    Parameters
    ----------
    run : Run
        Of the atlas.
    population : Population
    """

    def __init__(self, run: Run, population: Population) -> None:
        self.run, self.population = run, population
        self.done: set[tuple[str, float, float]] = set()

    def left(self) -> list[End]:
        """The ends that have not been followed, those of wide stretches first."""
        found = [end for end in loose_ends(self.run.graph) if _key(end) not in self.done]
        return sorted(found, key=lambda end: (-end.width, end.value, end.side, end.label))

    def follow(self, end: End) -> list[Counted]:
        """Start on the motion at the end of its stretch, to either side of it, and simulate what it becomes just beyond."""
        self.done.add(_key(end))
        low, high = self.run.graph.within
        near, far = (min(part * end.width, ATLAS.farthest * (high - low)) for part in (PAST, BEYOND_CASCADE))
        found: list[Counted] = []
        for past in dict.fromkeys((near, float(np.sqrt(near * far)), far, FARTHER * far)):
            if past not in (near, far) and any(counted.attractor.kind != "slow" for counted in found):
                continue
            p = end.value + end.side * past
            starts = self._beside(end, p) if low < p < high else None
            if starts is not None:
                self.run.tell(f"{end.label} followed to {self.population.parameter} = {p:.6g}", p)
                key = f"handover/{end.label}/{end.value!r}/{end.side}/{p!r}"
                found += followed(self.population, p, starts, key, self.run.journal)
        return [counted for counted in found if counted.attractor.kind != "impossible"]

    def _beside(self, end: End, p: float) -> np.ndarray | None:
        """Two starts beside the motion at the end of its stretch, shape (2, n); None if it cannot be simulated."""
        branch = self.run.graph.branches[end.label]
        for place in end.places:
            try:
                section = section_of(branch.attached, float(branch.values[place]))
                point = section.through(branch.points[place])
            except ValueError:
                continue
            if not np.all(np.isfinite(point)):
                continue
            columns = [self.population.names.index(name) for name in section.names]
            low, high = self.population.box(p)[columns].T
            aside = ATLAS.aside * (high - low) * np.cos(np.arange(len(point)))
            starts = np.zeros((2, len(self.population.names)))
            starts[:, columns] = np.clip(
                [point + aside, point - aside], np.minimum(low, point), np.maximum(high, point)
            )
            return starts
        return None


def loose_ends(graph: Graph) -> list[End]:
    """Ends of stable stretches of real branches inside the interval, beyond which no other stretch goes on."""
    low, high = graph.within
    size = high - low
    stretches = [stretch for b in graph.branches.values() if b.real for stretch in _stretches(b)]
    stretches = [s for s in stretches if s[1].value - s[0].value > ATLAS.narrow * size]
    firsts = np.array([first.value for first, _ in stretches])
    lasts = np.array([last.value for _, last in stretches])
    wide = _together(firsts, lasts, MEETING * size) > ATLAS.narrow_chain * size
    stretches = [s for s, enough in zip(stretches, wide, strict=True) if enough]
    found: dict[tuple[str, float, float], End] = {}
    for first, last in stretches:
        for end, others in ((first, lasts), (last, firsts)):
            inside = low + MEETING * size < end.value < high - MEETING * size
            if inside and not np.any(np.abs(others - end.value) <= MEETING * size):
                found.setdefault(_key(end), end)
    return list(found.values())


def _together(firsts: np.ndarray, lasts: np.ndarray, near: float) -> np.ndarray:
    """Width of what each stretch forms with those that it meets, and these with theirs, shape (n,)."""
    meeting = np.abs(firsts[None, :] - lasts[:, None]) <= near
    low, high = np.full((2, len(firsts)), np.inf)
    _, part = connected_components(meeting, directed=False)
    np.minimum.at(low, part, firsts)
    np.minimum.at(high, part, -lasts)
    return (-high - low)[part]


def _stretches(branch: Branch) -> Iterator[tuple[End, End]]:
    """The lower and the upper end of every stable stretch of a branch."""
    for first, last, stable in branch.pieces():
        if not stable or branch.problem is None:
            continue
        values = branch.values[first : last + 1]
        lower, upper = first + int(np.argmin(values)), first + int(np.argmax(values))
        width = float(branch.values[upper] - branch.values[lower])
        yield (
            End(branch.label, float(branch.values[lower]), -1.0, width, _near(lower, first, last)),
            End(branch.label, float(branch.values[upper]), 1.0, width, _near(upper, first, last)),
        )


def _near(place: int, first: int, last: int) -> tuple[int, ...]:
    return tuple(i for i in (place, place - 1, place + 1) if first <= i <= last)


def _key(end: End) -> tuple[str, float, float]:
    return end.label, end.value, end.side
