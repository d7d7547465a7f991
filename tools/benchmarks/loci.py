"""Compare the processor time of a point of a locus with that of a point of the branch on which the locus begins.

Both are computed through the public API with the same largest step; the time of a short run is subtracted from that of a long one, so that
one-time work does not count. The words are repeated many times: the symmetric motion with two impacts for the fold; the asymmetric one,
followed beyond its borders, for the period doubling and the velocity graze. With an odd number of repetitions a multiplier -1 stays -1.
"""

import statistics
import time

import numpy as np

import contvines as cv
from orbits.words import Word

from . import case
from .ours import MACHINE, AsWritten

REPETITIONS = (1, 17, 65, 257)  # l = 2, 34, 130, 514
STEP = 1e-3
SPANS = {"symmetric": (0.2, 0.7), "asymmetric": (0.727, 1.0)}
KINDS = {"symmetric": ("fold",), "asymmetric": ("period-doubling", "velocity-graze")}
OVER, WITHIN = "friction", (0.1, 0.9)


class Uncrossed(AsWritten):
    """Orbits whose branch does not continue with other words at borders."""

    def beyond(self, *arguments, **options):
        """Return no continuation."""
        return []


def written(times, symmetric):
    """Return the problem of the motion with two impacts, repeated `times` times."""
    if symmetric:
        u, _, _ = case.start(2 * times)
        value = case.start(2)[1]
    else:
        seed = MACHINE.symmetric_orbit(amplitude=0.7)
        graph = cv.diagram(seed, over="amplitude", within=(0.69, 0.8), depth=1)
        branch = next(branch for branch in graph if branch.seed == "SB1")
        u, value = branch.points[-1], float(branch.values[-1])
        u = (u.reshape(-1, 2) + [[[2.0 * np.pi * k, 0.0]] for k in range(times)]).ravel()
    found = Uncrossed(MACHINE, Word.parse("LR").repeat(times), times, "amplitude", case.PARAMS)
    found.u0, found.p0 = u, value
    return found


class Loci:
    """A branch and the loci of its special points, at one length of the word."""

    def __init__(self, times, sort):
        self.problem, self.within = written(times, sort == "symmetric"), SPANS[sort]
        graph = self.graph(1.0)
        self.starts = {kind: graph.of_kind(kind)[0] for kind in KINDS[sort]}

    def settings(self, longer):
        """Return the settings of a run with steps `longer` times as long."""
        return {"max_step": STEP * longer, "first_step": 0.5 * STEP * longer, "max_points": 1_000_000}

    def graph(self, longer):
        """Compute the branch as a diagram."""
        return cv.diagram(
            self.problem, within=self.within, depth=0, virtual=True, settings=self.settings(longer)
        )

    def branch(self, longer):
        """Compute the branch; return its number of points."""
        return sum(len(branch) for branch in self.graph(longer))

    def locus(self, kind, longer):
        """Compute the locus of a kind."""
        return cv.locus(
            self.starts[kind], over=OVER, within=WITHIN, virtual=True, settings=self.settings(longer)
        )

    def runs(self):
        """Return name -> function of the step's factor that returns a number of points."""
        found = {"branch": self.branch}
        for kind in self.starts:
            found[kind] = lambda longer, kind=kind: len(self.locus(kind, longer))
        return found


def seconds_per_point(run):
    """Processor seconds per point, with those of a short run subtracted."""
    marks, points = [time.process_time()], []
    for longer in (1.0, 4.0):
        points.append(run(longer))
        marks.append(time.process_time())
    return ((marks[1] - marks[0]) - (marks[2] - marks[1])) / (points[0] - points[1])


def ratios(rounds, repetitions=REPETITIONS):
    """Return {kind: {l: seconds per point}}, {kind: {l: ratio to a point of its branch}} and {kind: exponent of growth from l = 32 on}, from interleaved rounds."""
    seconds, times = {}, {}
    for count in repetitions:
        for sort in SPANS:
            runs = Loci(count, sort).runs()
            found = {name: [] for name in runs}
            for _ in range(rounds):
                for name, run in runs.items():
                    found[name].append(seconds_per_point(run))
            middle = {name: statistics.median(values) for name, values in found.items()}
            base = middle.pop("branch")
            for name, value in middle.items():
                seconds.setdefault(name, {})[2 * count] = value
                times.setdefault(name, {})[2 * count] = value / base
    exponents = {}
    for name, found in seconds.items():
        lengths = [l for l in found if l >= 32]
        if len(lengths) > 1:
            slope = np.polyfit(np.log(lengths), np.log([found[l] for l in lengths]), 1)[0]
            exponents[name] = float(slope)
    return seconds, times, exponents


def chart_in_diagrams(rounds):
    """Median over interleaved rounds of the time of the chart of amplitude and friction, relative to a diagram."""
    orbit = MACHINE.symmetric_orbit(amplitude=0.55)
    found = []
    for k in range(rounds + 1):
        marks = [time.process_time()]
        graph = cv.diagram(orbit, over="amplitude", within=(0.2, 1.3))
        marks.append(time.process_time())
        cv.chart(graph, over="friction", within=(0.02, 0.9))
        marks.append(time.process_time())
        if k:  # the first round compiles
            found.append((marks[2] - marks[1]) / (marks[1] - marks[0]))
    return statistics.median(found)
