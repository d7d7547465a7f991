"""The package in the benchmarks: the compiled loop alone, and the public API with all its searches."""

import numpy as np

import contvines as cv
from contvines.command.compose import first_orbit, run_diagram
from contvines.command.study import read_study
from contvines.continuation.layout import SIZE, Chunk, Control, Metric, Scratch, Status
from contvines.continuation.native import NativeLoop
from contvines.continuation.settings import BY_ANGLE
from orbits import Absorber
from orbits.problem import OrbitProblem
from orbits.words import Word

from . import case
from .floor import Run

MACHINE = Absorber(
    **dict(zip(("restitution", "friction", "gravity", "mass_ratio", "frequency"), case.PARAMS[1:].tolist()))
)


class AsWritten(OrbitProblem):
    """Orbits that are followed with their whole word, although it repeats a shorter one."""

    def root(self, u, p):
        """Return None, so that the word is not shortened."""
        return None


def problem(l):
    """Return the problem of the word repeated l/2 times, without reduction by symmetry."""
    found = AsWritten(MACHINE, Word.parse("LR").repeat(l // 2), l // 2, "amplitude", case.PARAMS)
    found.u0, found.p0, _ = case.start(l)
    return found


class Core:
    """The compiled loop; arrays are allocated once, and one call computes the whole branch."""

    def __init__(self, l, count=2000, step=case.STEP):
        self.problem = problem(l)
        n, rows = self.problem.dimension, 2 * self.problem.n_multipliers + self.problem.n_margins
        self.points, self.values = np.empty((count, n)), np.empty(count)
        self.tangents, self.rows = np.empty((count, n + 1)), np.zeros((count, rows))
        self.points[0], self.values[0], self.tangents[0] = case.start(l)
        control = Control(
            case.ANGLE, 1e-9, step, case.TOLERANCE, *case.INTERVAL, 0, 8, 2 * self.problem.n_multipliers, 0.0
        )
        arrays = self.points, self.values, self.tangents, self.rows
        chunk = Chunk(*arrays, *np.zeros((2, count)), Status.RUNNING)
        metric = Metric(np.ones(n + 1), np.ones(n + 1), *map(float, case.metric(l)))
        scratch = Scratch(np.zeros(n), *np.zeros((4, n + 1)))
        made = self.problem
        self.arguments = chunk, 1, step, control
        self.loop = NativeLoop(
            made.kernels.table,
            made.data,
            made.workspace(),
            (n, rows),
            metric,
            0.0,
            np.zeros(SIZE),
            scratch,
            BY_ANGLE,
        )

    def run(self):
        """Follow the branch; return the number of points."""
        return self.loop.march(*self.arguments)[0]

    def result(self):
        """Return the points of the run; the last one may lie at the end of the interval."""
        filled = self.run()
        return Run(self.points[:filled], self.values[:filled], self.rows[:filled], 0, 0)


class PublicAPI:
    """`cv.diagram` of one branch: both directions, special points, stability, margins, the complete graph."""

    def __init__(self, l, step=case.STEP):
        self.problem = problem(l)
        self.settings = {"max_step": step, "first_step": 0.5 * step, "max_points": 1_000_000}

    def run(self):
        """Compute the diagram; return the number of points on the branch."""
        self.graph = cv.diagram(self.problem, within=case.INTERVAL, depth=0, settings=self.settings)
        return sum(len(branch) for branch in self.graph)


class Diagram:
    """The whole diagram of a study in a warm process: all branches, beyond borders, special points compared with simulation."""

    def __init__(self, path):
        self.study = read_study(path)
        self.seed = first_orbit(self.study)

    def run(self):
        """Compute the diagram; return the number of points on all branches."""
        self.graph = run_diagram(self.study, self.seed)
        return sum(len(branch) for branch in self.graph)
