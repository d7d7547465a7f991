"""The state of a chart while it is made: a queue of places where loci may start, and what is known already."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from time import monotonic
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

import numpy as np

from ..bifurcation.kinds import kind_named
from ..branches.special_point import SpecialPoint
from ..continuation.engine import Engine
from ..continuation.settings import Settings
from ..graph.graph import Graph
from ..graph.identity import same_form
from ..journal import NullJournal
from ..problems.protocol import Problem
from ..problems.registry import without_problem
from ..progress import time_left
from ..shared.floating_point import TINY
from .born import Candidate
from .chart import Chart
from .codimension_two import find
from .coefficients_at import coefficients
from .crossings import crossings
from .departures import leaving
from .kinds import PREFIXES, condition
from .known_motions import KnownMotions, together
from .layout import BRANCH, FOLD, MARGIN, PERIOD
from .locus import Locus
from .long_period import lengthened, with_suited_period
from .on_mesh import on_mesh
from .plane_point import PlanePoint
from .problem import LocusProblem
from .regions import divide
from .settings import PLACES
from .starts import begin, regular_side
from .tracing import checked_ends, trace_locus

if TYPE_CHECKING:
    from ..journal import Journal

T = TypeVar("T")
BESIDE = 0.1  # of the sides of the plane: a segment so far away may belong to an arc through a place
LARGEST = 120  # loci; a chart that was cut there says so


class ChartProgress(NamedTuple):
    """Where a chart is: a sentence, and how much there is so far.

    Attributes
    ----------
    message : str
    loci : int
        Finished.
    points : int
        Of codimension two, found on them.
    waiting : int
        Starts of further loci that are known so far; some may lie on one locus.
    done, known : int
        Starts of loci done, and known so far.
    seconds : float
        Estimate of the time that the waiting starts will take, from the time of those done; behind the loci that of the regions, then of the
        crossings. NaN before the first one is done.
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
        """For a progress line."""
        return (
            f"{self.message}  |  {self.done} of {self.known} starts of loci known so far{time_left(self.seconds)}; "
            f"{self.loci} {'locus' if self.loci == 1 else 'loci'}, {self.points} points"
        )


class Charting:
    """The state of a chart while it is made."""

    def __init__(
        self,
        graph: Graph,
        over: str,
        within: tuple[float, float],
        bounds: tuple[float, float],
        virtual: bool,
        settings: Settings,
        journal: Journal | None,
        progress: Callable[[ChartProgress], None] | None,
    ) -> None:
        self.graph, self.over, self.within, self.bounds = graph, over, within, bounds
        self.virtual, self.settings, self.progress = virtual, settings, progress
        self.journal = NullJournal() if journal is None else journal
        self.chart = Chart(
            (graph.parameter, over),
            (bounds, within),
            model=dict(graph.model),
            settings={**settings.to_dict(), "virtual": virtual},
            units={name: unit for name, unit in graph.units.items() if name in (graph.parameter, over)},
            notation={name: text for name, text in graph.notation.items() if name in (graph.parameter, over)},
        )
        self.queue: deque[tuple[Candidate, int]] = deque()
        self.numbers: dict[str, int] = {}
        for taken in graph.special:
            prefix = taken.rstrip("0123456789")
            self.numbers[prefix] = max(self.numbers.get(prefix, 0), int(taken[len(prefix) :] or 0))
        self.forms: dict[str, Engine] = {}
        self.refused: list[str] = []
        self.done, self.tracing, self.begun = 0, False, monotonic()

    def tell(self, message: str, seconds: float | None = None) -> None:
        """Report progress; the time left, if nothing else is known, from that of the starts done."""
        if self.progress is not None:
            waiting, loci, points = len(self.queue), len(self.chart.loci), len(self.chart.points)
            if seconds is None:
                seconds = (monotonic() - self.begun) * waiting / self.done if self.done else float("nan")
            known = self.done + waiting + self.tracing
            self.progress(ChartProgress(message, loci, points, waiting, self.done, known, seconds))

    def counted(self, what: str, pieces: Sequence[T]) -> Iterator[T]:
        """Pieces of work that follow the loci, one by one, each told with the time that it and the later ones will take."""
        begun = monotonic()
        for i, piece in enumerate(pieces):
            left = (monotonic() - begun) * (len(pieces) - i) / i if i else float("nan")
            self.tell(f"{what} {i + 1} of {len(pieces)}", left)
            yield piece

    def label(self, prefix: str) -> str:
        """The next label with this prefix."""
        self.numbers[prefix] = self.numbers.get(prefix, 0) + 1
        return f"{prefix}{self.numbers[prefix]}"

    # ------------------------------------------------------------------ loci
    def add_special(self, point: SpecialPoint) -> None:
        """Queue the locus of a special point of the graph."""
        if point.problem is None:
            raise ValueError(without_problem(point.label))
        value = point.problem.parameters.get(self.over)
        if value is None or self.over == point.problem.parameter:
            begin(point.problem, point.kind, point.u, point.value, self.over)  # says why
            return
        if not self.within[0] <= value <= self.within[1]:
            raise ValueError(
                f"the diagram was made at {self.over} = {value:.10g}, outside of within = [{self.within[0]:.10g}, "
                f"{self.within[1]:.10g}]; widen the interval"
            )
        if not self.queue and not self.chart.loci:
            checked_ends(point.problem, self.over, self.within)
        try:
            point = with_suited_period(regular_side(point))
        except (MemoryError, OSError):
            raise
        except Exception as error:
            self.refused.append(f"{point.label}: {type(error).__name__}: {error}")
            return
        candidate = Candidate(
            point.attached, point.kind, point.u, point.value, value, point.margin_index or 0, point.label
        )
        self.queue.append((candidate, 0))

    def work(self, depth: int) -> None:
        """Trace what is queued, and what is found, until nothing is new."""
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
        """Trace the locus of a candidate unless it is known; returns the new points on it, each with the locus."""
        known = self.known(candidate)
        if known is not None:
            point = self.chart.points.get(candidate.seed)
            if point is not None and known.label not in point.on:
                point.on.append(known.label)
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
        """The locus of a candidate; None, with a remark, where it cannot be followed."""
        own = (
            candidate.seed in self.graph.special
        )  # a locus is called like the special point from which it comes
        label = candidate.seed if own else self.label(kind_named(candidate.kind).label)
        try:
            problem = begin(
                candidate.problem,
                candidate.kind,
                candidate.u,
                candidate.p,
                self.over,
                candidate.index,
                self.bounds,
            )
            locus = trace_locus(
                problem,
                candidate.u,
                candidate.p,
                candidate.q,
                self.within,
                self.settings,
                label,
                candidate.seed,
                self.virtual,
                self.journal,
                lambda name, count, value: self.tell(f"{name}: {count} points"),
            )
        except ValueError as error:
            self.refused.append(f"{candidate.seed}: {error}")
            locus = None
        if locus is None or len(locus) < 3:
            if not own:
                self.numbers[label.rstrip("0123456789")] -= 1
            return None
        return locus

    def known(self, candidate: Candidate) -> Locus | None:
        """The locus on which a candidate lies already, or None."""
        wanted = condition(candidate.problem, candidate.kind)
        for locus in self.chart.loci.values():
            problem = locus.problem
            if problem is None:
                continue
            # where branches cross they do not fold
            if locus.kind != candidate.kind and (wanted, problem.condition) != (FOLD, BRANCH):
                continue
            there = candidate
            if wanted == PERIOD:  # cycles of another period stand for the same homoclinic orbits
                try:
                    longer = lengthened(
                        on_mesh(candidate.problem), candidate.u, candidate.p, problem.reference
                    )
                except ValueError:
                    continue
                there = replace(candidate, problem=longer[0], u=longer[1], p=longer[2])
            if self.passes(locus, problem, there, border=wanted == MARGIN):
                return locus
        return None

    def passes(self, locus: Locus, problem: LocusProblem, candidate: Candidate, border: bool) -> bool:
        """Whether a locus goes through the place of a candidate, with the same motion (at borders: with any word)."""
        values, size = locus.values, locus.size
        unit = np.array([self.bounds[1] - self.bounds[0], self.within[1] - self.within[0]])
        place = np.array([candidate.p, candidate.q])
        near = np.abs((values - place) / unit).max(axis=1)
        if not near.min() < 0.2:
            return False
        repeats = size > len(candidate.u) and size % len(candidate.u) == 0
        if repeats and min(near[0], near[-1]) < PLACES.end:
            return False  # a doubled motion ends where it is the motion itself, which goes on
        form = candidate.problem.canonical(candidate.u, candidate.p)
        engine = self.forms.setdefault(locus.label, Engine(problem, self.within, self.settings))
        steps, way = np.diff(values, axis=0) / unit, (place - values[:-1]) / unit
        shares = (way * steps).sum(axis=1) / np.maximum((steps**2).sum(axis=1), TINY)
        beside = (np.abs(shares - 0.5) <= 0.6) & (np.abs(way - shares[:, None] * steps).max(axis=1) < BESIDE)
        for i in np.flatnonzero(beside | (near[:-1] < PLACES.end) | (near[1:] < PLACES.end)):
            share = float(np.clip(shares[i], 0.0, 1.0))
            guess = (1.0 - share) * locus.branch.points[i] + share * locus.branch.points[i + 1]
            q = float((1.0 - share) * values[i, 1] + share * values[i + 1, 1])
            # the point of the locus on the line through the place across the segment, whichever way the segment goes
            across = np.zeros(len(guess) + 1)
            across[size], across[-1] = steps[i] / unit * (problem.unit, 1.0)
            found = engine.solve(guess, q, across, float(steps[i] / unit @ place)) if across.any() else None
            U, q = (guess, q) if found is None else (found.u, found.p)
            u, p = problem.split(U)
            if np.abs(([p, q] - place) / unit).max() > (PLACES.end if found is None else PLACES.same):
                continue
            if border:
                return True
            if same_form(problem.base.canonical(u, float(p)), form, engine.scale):
                return True
        return False

    # ------------------------------------------------------------------ points
    def mark(self, locus: Locus) -> list[PlanePoint]:
        """Find the points of codimension two on a locus; returns those that are new."""
        fresh: list[PlanePoint] = []
        marked: list[tuple[int, PlanePoint]] = []
        for index, point in find(locus):
            known = next((other for other in self.chart.points.values() if self.same(point, other)), None)
            if known is None:
                point.label = self.label(PREFIXES[point.kind])
                point.on = [locus.label]
                point.coefficients = point.coefficients or coefficients(point)
                self.chart.points[point.label] = known = point
                fresh.append(point)
            elif locus.label not in known.on:
                known.on.append(locus.label)
            if all(point is not known for _, point in marked):
                marked.append((index, known))
        locus.marked = tuple(marked)
        return fresh

    def same(self, one: PlanePoint, other: PlanePoint) -> bool:
        """Whether two points are one: the same kind at the same place."""
        unit = (self.bounds[1] - self.bounds[0], self.within[1] - self.within[0])
        return one.kind == other.kind and all(
            abs(a - b) <= PLACES.same * w for a, b, w in zip(one.value, other.value, unit)
        )

    # ------------------------------------------------------------------ regions
    def divide(self) -> None:
        """Regions between the real parts of the loci, and what a simulation finds in each."""
        curves = []
        for each in self.chart.loci.values():
            values = each.values.copy()
            values[~each.real] = np.nan
            curves.append(values)
        problem = next(iter(self.graph.branches.values())).attached
        regions = divide(curves, self.chart.within)
        known = KnownMotions(
            self.graph.branches.values(), self.chart.loci.values(), self.over, self.chart.within
        )
        for region in self.counted("region", regions):
            region.attractors = self.attractors_at(problem, region.at, known)
            for place in region.elsewhere:
                place["attractors"] = self.attractors_at(problem, (place["at"][0], place["at"][1]), known)
        self.chart.regions = regions

    def attractors_at(
        self, problem: Problem, place: tuple[float, float], motions: KnownMotions
    ) -> list[dict[str, Any]]:
        """What is stable at a place, by simulation and by continuation; empty where the problem cannot be simulated."""
        key = f"region/{place[0]!r}/{place[1]!r}"
        known = self.journal.recall(key)
        if known is None:
            there = problem.against(problem.parameter, {self.over: place[1]})
            size = 0.0 if problem.scales is None else float(problem.scales.unknowns.max())
            known = {"attractors": together(there.simulated_attractors(place[0]), motions.at(place), size)}
            self.journal.record(key, known)
        return list(known["attractors"])

    def finish(self) -> None:
        """Find where loci cross, close the chart and keep it."""
        self.chart.crossings = crossings(self.chart, partial(self.counted, "crossing"))
        self.chart.finished = True
        if self.refused and not self.chart.loci:
            raise ValueError("no locus could be followed: " + "; ".join(dict.fromkeys(self.refused)))
        self.journal.checkpoint(self.chart)
        self.tell(self.chart.message)
