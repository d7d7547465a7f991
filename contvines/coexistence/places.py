"""Parameter values at which an atlas simulates, besides the given ones.

They lie in every stretch between two changes of stability, evenly scattered over the interval, and just beyond the ends of stable
stretches, where a simulation that begins on the motion that is lost leads to the attractor that replaces it (the handover).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.sparse.csgraph import connected_components

from ..branches import Branch
from ..circles.section import section_of
from ..graph import Graph
from ..graph.run import Run
from ..graph.stretches import MEETING
from ..problems.abilities import Population
from .census import UNBRANCHED, CountedMotion, motions_from
from .settings import ATLAS

# part of the interval to which the ends of a kind of motion without a branch are resolved
RESOLVED = 0.01
TURN = 0.5 * (np.sqrt(5.0) - 1.0)  # increment of the additive recurrence in `scattered_value`
# distances beyond the end of a stable stretch at which the motion is followed, relative to the stretch's width:
JUST_BEYOND = 0.01  # just beyond the end;
# beyond a cascade of doublings, which is over after 0.27 of the stretch before it (Feigenbaum's 1 / (4.669 - 1));
BEYOND_CASCADE = 1.0
FARTHER = 4.0  # relative to the largest distance, if all motions there settle too slowly to be recognised


def scattered_value(within: tuple[float, float], seed: int, k: int) -> float:
    """Return the k-th of a sequence of values that fills an interval evenly, whatever the number of values.

    ``shift + k (sqrt(5) - 1) / 2 mod 1``; among its first n values no gap is wider than 1.9 / n of the interval (the
    three-distance theorem; L. Ramshaw, J. Number Theory 13 (1981) 138).
    """
    low, high = within
    shift = float(np.random.default_rng(seed).random())
    return float(low + (high - low) * ((shift + (k + 1) * TURN) % 1.0))


def changes(graph: Graph) -> np.ndarray:
    """Return the values at which a known real motion gains or loses stability, and the interval's ends, in increasing order."""
    ends = {e for b in graph.branches.values() if b.real for pair in b.stable_intervals() for e in pair}
    return np.array(sorted({*graph.within, *ends}))


def untested_values(graph: Graph, asked: Sequence[float], most: int) -> list[float]:
    """Return values at which the attractors may differ from those found at the simulated values.

    Each stretch between two neighbouring changes of stability may have other attractors. The values returned are the middle of each
    stretch without a simulated value, and a value close to each end of each stretch, the interval's ends included, without one near.

    Parameters
    ----------
    graph : Graph
    asked : sequence of float
        The simulated values.
    most : int
        Largest number of values returned, those of wide stretches first.
    """
    size = graph.within[1] - graph.within[0]
    simulated = np.sort(np.asarray(asked, dtype=float))
    marks = changes(graph)
    wanted: list[tuple[float, float]] = []
    for first, last in pairwise(marks):
        width = float(last - first)
        if width <= ATLAS.narrow * size:
            continue
        inside = simulated[(simulated > first) & (simulated < last)]
        if not inside.size:
            wanted.append((width, float(0.5 * (first + last))))
        step = ATLAS.beyond * size
        if width <= 4.0 * step:
            continue
        for p in (first + step, last - step):
            if not np.any(np.abs(inside - p) <= 2.0 * step):
                wanted.append((0.25 * width, float(p)))
    wanted.sort(key=lambda entry: (-entry[0], entry[1]))
    return list(dict.fromkeys(p for _, p in wanted[:most]))


def unresolved(
    met: Mapping[str, Sequence[float]], asked: Sequence[float], within: tuple[float, float], most: int
) -> list[float]:
    """Return the middles between two neighbouring values of which only one has a kind of motion without a branch.

    Parameters
    ----------
    met : mapping
        For each kind of motion the values at which it was found.
    asked : sequence of float
        All simulated values.
    within : (float, float)
        The interval.
    most : int
        Largest number of values returned, those between distant neighbours first.
    """
    wanted: dict[float, float] = {}
    for kind in UNBRANCHED:
        holders = set(met.get(kind, ()))
        for first, last in pairwise(sorted(holders | set(asked)) if holders else ()):
            if (first in holders) != (last in holders) and last - first > RESOLVED * (within[1] - within[0]):
                wanted[0.5 * (first + last)] = last - first
    return sorted(wanted, key=lambda p: (-wanted[p], p))[:most]


def unknown(graph: Graph, asked: Sequence[float]) -> list[tuple[float, float]]:
    """Return the stretches of the interval, wider than `RESOLVED` of it, without a stable branch and without a simulated value (`asked`)."""
    low, high = graph.within
    covered = [pair for b in graph.branches.values() if b.real for pair in b.stable_intervals()]
    marks = sorted({low, high, *asked, *(end for pair in covered for end in pair)})
    return [
        (float(first), float(last))
        for first, last in pairwise(marks)
        if last - first > RESOLVED * (high - low) and not any(a <= first and last <= b for a, b in covered)
    ]


# ------------------------------------------------------------------ past the ends of stable stretches
@dataclass(frozen=True)
class End:
    """One end of a stable stretch of a real branch, beyond which no other stable stretch begins.

    Attributes
    ----------
    label : str
        Of the branch.
    value : float
        Of the parameter at the end.
    side : float
        1.0 for an upper end, -1.0 for a lower one.
    width : float
        Of the stretch.
    places : tuple of int
        Indices of the branch's points there, the end itself first, then its neighbours.
    """

    label: str
    value: float
    side: float
    width: float
    places: tuple[int, ...]

    @property
    def key(self) -> tuple[str, float, float]:
        """Identifier of the end."""
        return self.label, self.value, self.side


class Handover:
    """Follow motions beyond the ends of their stable stretches by simulation, each end once.

    Parameters
    ----------
    run : Run
        The run whose graph has the stretches.
    population : Population
    """

    def __init__(self, run: Run, population: Population) -> None:
        self.run, self.population = run, population
        self.done: set[tuple[str, float, float]] = set()

    def left(self) -> list[End]:
        """Return the ends that have not been followed, those of wide stretches first."""
        found = [end for end in loose_ends(self.run.graph) if end.key not in self.done]
        return sorted(found, key=lambda end: (-end.width, end.value, end.side, end.label))

    def follow(self, end: End) -> list[CountedMotion]:
        """Simulate just beyond an end, from starts to either side of the motion at the end; return the motions reached."""
        self.done.add(end.key)
        low, high = self.run.graph.within
        near, far = (
            min(part * end.width, ATLAS.farthest * (high - low)) for part in (JUST_BEYOND, BEYOND_CASCADE)
        )
        found: list[CountedMotion] = []
        for distance in dict.fromkeys((near, float(np.sqrt(near * far)), far, FARTHER * far)):
            if distance not in (near, far) and any(counted.attractor.kind != "slow" for counted in found):
                continue
            p = end.value + end.side * distance
            starts = self._starts_beside(end, p) if low < p < high else None
            if starts is not None:
                self.run.tell(f"{end.label} followed to {self.population.parameter} = {p:.6g}", p)
                key = f"handover/{end.label}/{end.value!r}/{end.side}/{p!r}"
                found += motions_from(self.population, p, starts, key, self.run.journal)
        return [counted for counted in found if counted.attractor.kind != "impossible"]

    def _starts_beside(self, end: End, p: float) -> np.ndarray | None:
        """Return two starts beside the motion at an end, shape (2, n); None if it cannot be simulated."""
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
            shift = ATLAS.offset * (high - low) * np.cos(np.arange(len(point)))
            starts = np.zeros((2, len(self.population.names)))
            starts[:, columns] = np.clip(
                [point + shift, point - shift], np.minimum(low, point), np.maximum(high, point)
            )
            return starts
        return None


def loose_ends(graph: Graph) -> list[End]:
    """Return the ends of stable stretches of real branches inside the interval, beyond which no other stable stretch begins."""
    low, high = graph.within
    size = high - low
    stretches = [stretch for b in graph.branches.values() if b.real for stretch in _stretches(b)]
    stretches = [s for s in stretches if s[1].value - s[0].value > ATLAS.narrow * size]
    firsts = np.array([first.value for first, _ in stretches])
    lasts = np.array([last.value for _, last in stretches])
    wide = _chain_widths(firsts, lasts, MEETING * size) > ATLAS.narrow_chain * size
    stretches = [s for s, is_wide in zip(stretches, wide, strict=True) if is_wide]
    found: dict[tuple[str, float, float], End] = {}
    for first, last in stretches:
        for end, others in ((first, lasts), (last, firsts)):
            inside = low + MEETING * size < end.value < high - MEETING * size
            if inside and not np.any(np.abs(others - end.value) <= MEETING * size):
                found.setdefault(end.key, end)
    return list(found.values())


def _chain_widths(firsts: np.ndarray, lasts: np.ndarray, near: float) -> np.ndarray:
    """Return for each stretch the width of the chain of stretches, meeting end to end, to which it belongs; shape (n,)."""
    meeting = np.abs(firsts[None, :] - lasts[:, None]) <= near
    low, high = np.full((2, len(firsts)), np.inf)
    _, part = connected_components(meeting, directed=False)
    np.minimum.at(low, part, firsts)
    np.minimum.at(high, part, -lasts)
    return (-high - low)[part]


def _stretches(branch: Branch) -> Iterator[tuple[End, End]]:
    """Yield the lower and the upper end of every stable stretch of a branch."""
    for first, last, stable in branch.pieces():
        if stable and branch.problem is not None:
            values = branch.values[first : last + 1]
            width = float(np.ptp(values))
            lower, upper = (
                End(
                    branch.label,
                    float(values[place]),
                    side,
                    width,
                    tuple(first + i for i in (place, place - 1, place + 1) if 0 <= i < len(values)),
                )
                for side, place in ((-1.0, int(values.argmin())), (1.0, int(values.argmax())))
            )
            yield lower, upper
