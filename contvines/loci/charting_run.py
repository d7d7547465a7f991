"""Charting: the state of a chart while it is computed, with a queue of starts of loci; and the crossings of loci."""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import partial
from itertools import combinations
from time import monotonic
from typing import Any, NamedTuple, TypeVar

import numpy as np

from ..bifurcation.kind import Kind
from ..bifurcation.kinds import kind_named
from ..branches.solutions import on_segment
from ..branches.special_point import SpecialPoint
from ..continuation.engine import Engine
from ..continuation.settings import Settings
from ..graph import Graph
from ..graph.identity import same_form
from ..journal import Journal
from ..long_work import time_left
from ..problems.protocol import Problem
from ..shared.numbers import TINY
from .chart import Chart
from .codimension_two import mark
from .departures import leaving
from .kernels import BRANCH, FOLD, MARGIN, OWN, PERIOD, condition
from .linear import Linearisation
from .locus import Locus, PlanePoint
from .problem import LocusProblem
from .regions import KnownMotions, divide, together
from .settings import PLACES
from .starts import Candidate, candidate_of, check_start, with_period
from .tracing import trace_locus

T = TypeVar("T")
# largest distance, in sides of the plane, of a point from the chord of an arc that may contain it
ARC_HEIGHT = 0.1
LARGEST = 120  # most loci of a chart; its message reports when it is reached


class ChartProgress(NamedTuple):
    """Progress of a chart: a message and counts.

    Attributes
    ----------
    message : str
    loci : int
        Finished loci.
    points : int
        Points of codimension two found on them.
    waiting : int
        Starts in the queue; several may lie on one locus.
    done, known : int
        Starts that are done; all starts known so far.
    seconds : float
        Estimated time for the waiting starts, from the time of those done; later that of the regions, then of the crossings. NaN before the
        first one is done.
    """

    message: str
    loci: int
    points: int
    waiting: int
    done: int = 0
    known: int = 0
    seconds: float = float("nan")

    @property
    def sentence(self) -> str:
        """Text of a progress line."""
        return (
            f"{self.message}  |  {self.done} of {self.known} starts of loci known so far{time_left(self.seconds)}; "
            f"{self.loci} {'locus' if self.loci == 1 else 'loci'}, {self.points} points"
        )


def has_pair(problem: LocusProblem, U: np.ndarray, q: float, candidate: Candidate) -> bool:
    """Whether a locus, at a point next to a candidate with two critical pairs, has the candidate's pair."""
    u, p = problem.split(U)
    one = Linearisation(problem.at(q)).at(u, float(p)).positions()[:1]
    two = Linearisation(candidate.problem).at(candidate.u, candidate.p).positions()[:2]
    return min(len(one), len(two) - 1) < 1 or int(np.argmin(np.abs(two - one))) == candidate.pair


class Charting:
    """The state of a chart while it is computed; for the arguments see :func:`contvines.loci.charting.chart`."""

    def __init__(
        self,
        graph: Graph,
        over: str,
        within: tuple[float, float],
        bounds: tuple[float, float],
        virtual: bool,
        settings: Settings,
        journal: Journal,
        progress: Callable[[ChartProgress], None] | None,
        kinds: Sequence[Kind] = (),
    ) -> None:
        self.kinds = {kind.name: kind for kind in kinds}
        self.graph, self.over, self.within, self.bounds = graph, over, within, bounds
        self.widths = np.array([bounds[1] - bounds[0], within[1] - within[0]])
        self.virtual, self.settings, self.progress = virtual, settings, progress
        self.journal = journal
        self.chart = Chart(
            (graph.parameter, over),
            (bounds, within),
            model=dict(graph.model),
            settings={**settings.to_dict(), "virtual": virtual},
            units={name: unit for name, unit in graph.units.items() if name in (graph.parameter, over)},
            notation={name: text for name, text in graph.notation.items() if name in (graph.parameter, over)},
        )
        self.queue: deque[tuple[Candidate, int]] = deque()
        self.numbers = Counter[str]()  # last number used with each prefix of labels
        for taken in graph.special:
            prefix = taken.rstrip("0123456789")
            self.numbers[prefix] = max(self.numbers[prefix], int(taken[len(prefix) :] or 0))
        self.forms: dict[str, Engine] = {}
        self.refused: list[str] = []
        self.done, self.tracing, self.began = 0, False, monotonic()

    def tell(self, message: str, seconds: float | None = None) -> None:
        """Report progress; by default the remaining time is estimated from the starts done."""
        if self.progress is not None:
            waiting, loci, points = len(self.queue), len(self.chart.loci), len(self.chart.points)
            if seconds is None:
                seconds = (monotonic() - self.began) * waiting / self.done if self.done else float("nan")
            total = self.done + waiting + self.tracing
            self.progress(ChartProgress(message, loci, points, waiting, self.done, total, seconds))

    def counted(self, name: str, pieces: Sequence[T]) -> Iterator[T]:
        """Generate pieces of work (regions, crossings), and report each with the estimated remaining time."""
        began = monotonic()
        for i, piece in enumerate(pieces):
            left = (monotonic() - began) * (len(pieces) - i) / i if i else float("nan")
            self.tell(f"{name} {i + 1} of {len(pieces)}", left)
            yield piece

    def label(self, prefix: str) -> str:
        """Return the next label with a prefix."""
        self.numbers[prefix] += 1
        return f"{prefix}{self.numbers[prefix]}"

    # ------------------------------------------------------------------ loci
    def add_special(self, point: SpecialPoint) -> None:
        """Queue the locus of a special point of the graph."""
        check_start(point, self.over, self.within)
        try:
            self.queue.append((candidate_of(point, self.over, self.kinds.values()), 0))
        except (MemoryError, OSError):
            raise
        except Exception as error:
            self.refused.append(f"{point.label}: {type(error).__name__}: {error}")

    def work(self, depth: int) -> None:
        """Trace the loci of all queued starts, and queue the starts of loci that leave new points, up to `depth` generations."""
        while self.queue:
            if len(self.chart.loci) >= LARGEST:
                self.chart.message = f"stopped at {LARGEST} loci with {len(self.queue)} waiting"
                break
            candidate, generation = self.queue.popleft()
            self.tracing, before = True, len(self.chart.loci)
            fresh = self.follow(candidate)
            self.tracing, self.done = False, self.done + 1
            if len(self.chart.loci) > before:
                self.tell(f"{next(reversed(self.chart.loci))} finished")
            for point, locus in fresh if generation < depth else ():
                self.queue += [(c, generation + 1) for c in leaving(point, locus, self.bounds, self.over)]
        else:
            self.chart.message = "finished"

    def follow(self, candidate: Candidate) -> list[tuple[PlanePoint, Locus]]:
        """Trace the locus of a candidate unless it lies on a known one; return the new points on it, each with the locus."""
        traced = self.locus_through(candidate)
        if traced is not None:
            point = self.chart.points.get(candidate.seed)
            if point is not None and traced.label not in point.on:
                point.on.append(traced.label)
            return []
        locus = self.trace(candidate)
        if locus is None:
            return []
        self.chart.loci[locus.label] = locus
        self.tell(f"{locus.label}: points of codimension two")
        fresh = self.mark(locus)
        done, waiting = self.done + 1, len(self.queue)
        self.chart.message = f"{done} of {done + waiting} starts of loci known so far are done"
        self.journal.checkpoint(self.chart)
        return [(point, locus) for point in fresh]

    def trace(self, candidate: Candidate) -> Locus | None:
        """Return the locus of a candidate; None if it cannot be traced, with the reason added to ``refused``."""
        # a locus has the label of the special point at which it starts
        from_diagram = candidate.seed in self.graph.special
        prefix = kind_named(candidate.kind, self.kinds).label
        label = candidate.seed if from_diagram else self.label(prefix)
        arguments = self.over, self.within, self.bounds, self.settings, label, self.virtual, self.journal
        try:
            locus = trace_locus(candidate, *arguments, self.tell_points)
        except ValueError as error:
            self.refused.append(f"{candidate.seed}: {error}")
            locus = None
        if locus is None or len(locus) < 3:
            self.numbers[prefix] -= 0 if from_diagram else 1
            return None
        locus.kinds = tuple(self.kinds.values())
        return locus

    def tell_points(self, label: str, count: int, value: float) -> None:
        """Report the number of points that a locus has so far."""
        self.tell(f"{label}: {count} points")

    def locus_through(self, candidate: Candidate) -> Locus | None:
        """Return the traced locus on which a candidate lies, or None."""
        wanted = OWN if candidate.own_kind else condition(candidate.problem, candidate.kind)
        for locus in self.chart.loci.values():
            problem, start = locus.problem, candidate
            if problem is None:
                continue
            # a fold may also lie on a locus of branch points, where branches cross instead of folding
            if locus.kind != candidate.kind and (wanted, problem.condition) != (FOLD, BRANCH):
                continue
            if wanted == PERIOD:  # cycles of another long period represent the same homoclinic orbits
                try:
                    start = with_period(candidate, problem.reference)
                except ValueError:
                    continue
            if self.passes(locus, problem, start, border=wanted == MARGIN):
                return locus
        return None

    def passes(self, locus: Locus, problem: LocusProblem, candidate: Candidate, border: bool) -> bool:
        """Whether a locus passes through the (p, q) of a candidate with the same motion (at borders: with any word)."""
        values, size, unit = locus.values, locus.size, self.widths
        place = np.array([candidate.p, candidate.q])
        near = np.abs((values - place) / unit).max(axis=1)
        if not near.min() < 0.2:
            return False
        repeats = size > len(candidate.u) and size % len(candidate.u) == 0
        if repeats and min(near[0], near[-1]) < PLACES.end:
            return False  # the locus of a doubled motion ends where it becomes the motion itself, whose locus continues
        form = candidate.problem.canonical(candidate.u, candidate.p)
        engine = self.forms.setdefault(locus.label, Engine(problem, self.within, self.settings))
        steps, offset = np.diff(values, axis=0) / unit, (place - values[:-1]) / unit
        shares = (offset * steps).sum(axis=1) / np.maximum((steps**2).sum(axis=1), TINY)
        nearby = (np.abs(shares - 0.5) <= 0.6) & (
            np.abs(offset - shares[:, None] * steps).max(axis=1) < ARC_HEIGHT
        )
        for i in np.flatnonzero(nearby | (near[:-1] < PLACES.end) | (near[1:] < PLACES.end)):
            share = float(np.clip(shares[i], 0.0, 1.0))
            guess = (1.0 - share) * locus.branch.points[i] + share * locus.branch.points[i + 1]
            q = float((1.0 - share) * values[i, 1] + share * values[i + 1, 1])
            # solve for the point of the locus on the line through the place, perpendicular to the segment
            along = np.zeros(len(guess) + 1)
            along[size], along[-1] = steps[i] / unit * (problem.unit, 1.0)
            found = engine.solve(guess, q, along, float(steps[i] / unit @ place)) if along.any() else None
            U, q = (guess, q) if found is None else (found.u, found.p)
            u, p = problem.split(U)
            if np.abs(([p, q] - place) / unit).max() > (PLACES.end if found is None else PLACES.same):
                continue
            if border or same_form(problem.base.canonical(u, float(p)), form, engine.scale):
                end = i + int(np.argmax(np.abs((values[i : i + 2] - place) / unit).max(axis=1)))
                return candidate.pair is None or has_pair(
                    problem, locus.branch.points[end], float(values[end, 1]), candidate
                )
        return False

    # ------------------------------------------------------------------ points
    def mark(self, locus: Locus) -> list[PlanePoint]:
        """Find the points of codimension two on a locus; return the new ones."""
        count = len(self.chart.points)
        locus.marked = mark(locus, self.chart.points, self.label, self.same)
        return list(self.chart.points.values())[count:]

    def same(self, one: PlanePoint, other: PlanePoint) -> bool:
        """Whether two points are equal: the same kind at the same place."""
        difference = np.abs(np.subtract(one.value, other.value))
        return one.kind == other.kind and bool((difference <= PLACES.same * self.widths).all())

    # ------------------------------------------------------------------ regions and crossings
    def divide(self) -> None:
        """Compute the regions between the real parts of the loci, and simulate in each."""
        graph, loci = self.graph, self.chart.loci.values()
        curves = [np.where(locus.real[:, None], locus.values, np.nan) for locus in loci]
        problem = next(iter(graph.branches.values())).attached
        regions = divide(curves, self.chart.within)
        known_motions = KnownMotions(graph.branches.values(), loci, self.over, self.chart.within)
        for region in self.counted("region", regions):
            region.attractors = self.attractors_at(problem, region.at, known_motions)
            for place in region.elsewhere:
                place["attractors"] = self.attractors_at(
                    problem, (place["at"][0], place["at"][1]), known_motions
                )
        self.chart.regions = regions

    def attractors_at(
        self, problem: Problem, place: tuple[float, float], motions: KnownMotions
    ) -> list[dict[str, Any]]:
        """Return the stable motions at (p, q), by simulation and by continuation; empty if the problem cannot be simulated."""
        key = f"region/{place[0]!r}/{place[1]!r}"
        entry = self.journal.recall(key)
        if entry is None:
            there_problem = problem.against(problem.parameter, {self.over: place[1]})
            size = 0.0 if problem.scales is None else float(problem.scales.unknowns.max())
            entry = {
                "attractors": together(there_problem.simulated_attractors(place[0]), motions.at(place), size)
            }
            self.journal.record(key, entry)
        return list(entry["attractors"])

    def finish(self) -> None:
        """Compute the crossings of loci, mark the chart as finished and record it.

        Raises
        ------
        ValueError
            If no locus could be traced.
        """
        self.chart.crossings = crossings(self.chart, partial(self.counted, "crossing"))
        self.chart.finished = True
        if self.refused and not self.chart.loci:
            raise ValueError("no locus could be followed: " + "; ".join(dict.fromkeys(self.refused)))
        self.journal.checkpoint(self.chart)
        self.tell(self.chart.message)


# ------------------------------------------------------------------ crossings
# labels of two loci, a segment of each, and the crossing of these segments
Met = tuple[str, str, int, int, np.ndarray]


def crossings(chart: Chart, each: Callable[[list[Met]], Iterable[Met]]) -> list[dict[str, Any]]:
    """Find crossings of the real parts of two loci that are no common point of codimension two: they belong to different motions, or to independent directions of one motion.

    Parameters
    ----------
    chart : Chart
    each : callable
        Iterates over possible crossings; it may report progress.

    Returns
    -------
    list of dict
        "on", the labels of the two loci; "value", both parameters by name; "error", the uncertainty of the place relative to the plane.
    """
    lows, widths = np.array(chart.within)[:, 0], np.diff(chart.within)[:, 0]
    curves = {label: (locus.values - lows) / widths for label, locus in chart.loci.items()}
    candidates: list[Met] = []
    for one, other in combinations(chart.loci, 2):
        real, others = chart.loci[one].real, chart.loci[other].real
        candidates += [
            (one, other, i, j, lows + place * widths)
            for i, j, place in segments(curves[one], curves[other])
            if real[i : i + 2].all() and others[j : j + 2].all()
        ]
    found: list[dict[str, Any]] = []
    for one, other, i, j, place in each(candidates):
        p, q, error = _crossing(chart.loci[one], chart.loci[other], i, j, place)
        meetings = [p.value for p in chart.points.values() if one in p.on and other in p.on]
        if any(np.abs((np.array([p, q]) - m) / widths).max() < max(PLACES.end, error) for m in meetings):
            continue
        found.append(
            {"on": [one, other], "value": dict(zip(chart.parameters, (p, q))), "error": float(error)}
        )
    return found


def segments(a: np.ndarray, b: np.ndarray) -> list[tuple[int, int, np.ndarray]]:
    """Return the crossings of two polygonal curves, shapes (n, 2) and (m, 2): (segment of a, segment of b, place)."""
    if len(a) < 2 or len(b) < 2:
        return []
    d, e = np.diff(a, axis=0), np.diff(b, axis=0)
    gap = b[None, :-1] - a[:-1, None]
    turn = d[:, None, 0] * e[None, :, 1] - d[:, None, 1] * e[None, :, 0]
    with np.errstate(all="ignore"):
        s = (gap[..., 0] * e[None, :, 1] - gap[..., 1] * e[None, :, 0]) / turn
        t = (gap[..., 0] * d[:, None, 1] - gap[..., 1] * d[:, None, 0]) / turn
        inside = (s >= 0.0) & (s < 1.0) & (t >= 0.0) & (t < 1.0)
    return [(int(i), int(j), a[i] + s[i, j] * d[i]) for i, j in np.argwhere(inside)]


def _crossing(first: Locus, second: Locus, i: int, j: int, place: np.ndarray) -> tuple[float, float, float]:
    """(p, q, error) of a crossing: by the secant method in q if both loci can be solved at given q, else the crossing of the segments."""
    p, q = float(place[0]), float(place[1])
    low, high = first.within
    curves = [(first, i), (second, j)]
    size = max(float(abs(np.diff(locus.branch.values[k : k + 2])[0])) for locus, k in curves)
    rough = p, q, size / (high - low)
    if first.problem is None or second.problem is None:
        return rough
    engines = [Engine(locus.branch.attached, first.within, Settings()) for locus, _ in curves]

    def gap(value: float) -> tuple[float, float] | None:
        solved = [on_segment(engine, locus.branch, k, value) for engine, (locus, k) in zip(engines, curves)]
        ends = [float(point.u[locus.size]) for point, (locus, _) in zip(solved, curves) if point is not None]
        return None if len(ends) < 2 else (ends[0] - ends[1], ends[0])

    before, value = q, q + Settings.aside * size + Settings.located * (high - low)
    last = gap(before)
    for _ in range(20):
        reached = gap(value)
        if last is None or reached is None or reached[0] == last[0]:
            break
        step = -reached[0] * (value - before) / (reached[0] - last[0])
        if not abs(value + step - q) <= 2.0 * size:
            break
        before, last, value = value, reached, value + step
        if abs(step) < Settings.rounding * (high - low):
            return reached[1], float(value), float(abs(step) / (high - low))
    return rough
