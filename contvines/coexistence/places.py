"""Where an atlas looks beside the values it was given.

It looks in every stretch between two changes and evenly all over, and past the ends of stable stretches, where the motion is followed that ceases to
be stable there: what it hands over to is simulated.
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
from .census import UNBRANCHED, Counted, followed
from .settings import ATLAS

# of the interval: a kind of motion that has no branch is told of up to so near to where it ends
RESOLVED = 0.01
TURN = 0.5 * (np.sqrt(5.0) - 1.0)  # of the additive recurrence, see `scattered`
PAST = 0.01  # of a stable stretch's width: so far past its end a motion is followed, where it settles too slowly to be told farther, ...
BEYOND_CASCADE = 1.0  # ... and so far, for a cascade of doublings is over after 0.27 of the stretch before it (Feigenbaum's 1 / (4.669 - 1)), ...
FARTHER = 4.0  # times as far again where all that was met is too slow


def scattered(within: tuple[float, float], seed: int, k: int) -> float:
    """The k-th of a sequence of values that fills an interval evenly at every length.

    ``shift + k (sqrt(5) - 1) / 2 mod 1``; among its first n values no gap is wider than 1.9 / n of the interval (the
    three-distance theorem; L. Ramshaw, J. Number Theory 13 (1981) 138).
    """
    low, high = within
    shift = float(np.random.default_rng(seed).random())
    return float(low + (high - low) * ((shift + (k + 1) * TURN) % 1.0))


def changes(graph: Graph) -> np.ndarray:
    """Values at which a known real motion becomes stable or ceases to be, in increasing order, and the interval's ends."""
    ends = {e for b in graph.branches.values() if b.real for pair in b.stable_intervals() for e in pair}
    return np.array(sorted({*graph.within, *ends}))


def unasked(graph: Graph, asked: Sequence[float], most: int) -> list[float]:
    """Values where what attracts may differ from what has been seen at `asked`, at most `most`, those of wide stretches first.

    Between two neighbouring changes of what is stable something else may have taken over: there is one value at least in
    each such stretch, in its middle if none lies there, and one right beyond each change, where a motion that ceases to be stable
    hands over to another, and beside each end of the interval.
    """
    size = graph.within[1] - graph.within[0]
    known = np.sort(np.asarray(asked, dtype=float))
    marks = changes(graph)
    wanted: list[tuple[float, float]] = []
    for first, last in pairwise(marks):
        width = float(last - first)
        if width <= ATLAS.narrow * size:
            continue
        inside = known[(known > first) & (known < last)]
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
    """Values between two neighbours of which one has met a kind of motion without a branch and the other has not.

    At most `most`, those of distant neighbours first.

    Parameters
    ----------
    met : mapping
        The values at which each kind has been met.
    asked : sequence of float
        The values at which it would have been met, had it been there.
    within : (float, float)
    most : int
    """
    wanted: dict[float, float] = {}
    for kind in UNBRANCHED:
        here = set(met.get(kind, ()))
        for first, last in pairwise(sorted(here | set(asked)) if here else ()):
            if (first in here) != (last in here) and last - first > RESOLVED * (within[1] - within[0]):
                wanted[0.5 * (first + last)] = last - first
    return sorted(wanted, key=lambda p: (-wanted[p], p))[:most]


def unknown(graph: Graph, asked: Sequence[float]) -> list[tuple[float, float]]:
    """Stretches of the interval, none narrower than a hundredth, with no stable branch and none of the values `asked`."""
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

    @property
    def key(self) -> tuple[str, float, float]:
        """Equal for one end only."""
        return self.label, self.value, self.side


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
        found = [end for end in loose_ends(self.run.graph) if end.key not in self.done]
        return sorted(found, key=lambda end: (-end.width, end.value, end.side, end.label))

    def follow(self, end: End) -> list[Counted]:
        """Start on the motion at the end of its stretch, to either side of it, and simulate what it becomes just beyond."""
        self.done.add(end.key)
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
                found.setdefault(end.key, end)
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
