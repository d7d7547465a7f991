"""Cycles of the Lorenz equations from r = 280 down to 100: contvines and AUTO-07p, if it is installed (AUTO_DIR, and a Fortran compiler).

Both have the same start, the same number of collocation intervals of degree 4, and multipliers at each point; each chooses its own steps. The
processor time per point is printed. `python -m tools.benchmarks.flows [INTERVALS ...]`
"""

import importlib.util
import os
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

import contvines as cv
from contvines.flows import mesh
from contvines.flows.kernels import solved

from .auto import Auto

EXAMPLE = Path(__file__).parents[2] / "examples" / "compiled" / "lorenz.py"
START, END = 280.0, 100.0
CONSTANTS = """\
dat = 'lorenz'
NDIM = 3, IPS = 2, IRS = 0, ILP = 1
ICP = [1, 11]
NTST = {intervals}, NCOL = 4, IAD = 3, ISP = 2, ISW = 1, IPLT = 0, NBC = 0, NINT = 0
NMX = 500, NPR = 1000, MXBF = 0, IID = 0, ITMX = 8, ITNW = 7, NWTN = 3, JAC = 0
EPSL = 1e-7, EPSU = 1e-7, EPSS = 1e-4
DS = -0.5, DSMIN = 0.01, DSMAX = 25.0, IADS = 1
NPAR = 3, THL = {{11: 0.0}}, THU = {{}}
UZSTOP = {{1: 100.0}}
"""


def lorenz(x, p):
    return [10.0 * (x[1] - x[0]), p.r * x[0] - x[1] - x[0] * x[2], x[0] * x[1] - 8.0 / 3.0 * x[2]]


def in_python():
    """Return the flow with a right-hand side in numpy, differentiated by complex steps."""
    return cv.FlowProblem(lorenz, [1.0, 1.0, 1.0], {"r": START})


def in_c(folder):
    """Return the flow with a compiled right-hand side; None without a compiler."""
    if shutil.which("cc") is None:
        return None
    spec = importlib.util.spec_from_file_location("lorenz", EXAMPLE)
    assert spec is not None and spec.loader is not None
    example = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(example)
    return example.flow(example.compiled(folder))


class Ours:
    """A branch by `contvines.trace`."""

    def __init__(self, flow, intervals):
        orbit = flow.attractor([1.0, 1.0, 1.0], r=START)
        problem = orbit._problem
        x, period, widths = problem.parts(orbit.u, START)
        even = np.full(intervals, 1.0 / intervals)
        at_nodes = mesh.evaluate(problem.rule, widths, x, mesh.node_places(problem.rule, even))
        u = np.concatenate([at_nodes.ravel(), [period], even])
        self.problem = problem.against("r", {"r": START}).with_unknowns(u, START, intervals, 1)
        self.problem.u0 = solved(self.problem, u, START)

    def run(self):
        """Follow the branch; return processor time and number of points."""
        begin = time.process_time()
        points = list(cv.trace(self.problem, within=(END, START), direction=-1.0))
        return time.process_time() - begin, points

    def data(self):
        """Return times and states of the start in the form that AUTO reads."""
        orbit = self.problem.orbit(self.problem.u0, START)
        return np.column_stack([orbit.times, orbit.states])


class AutoFlow:
    """A branch by the executable of AUTO in a separate directory."""

    def __init__(self, data, intervals):
        self.directory = Path(tempfile.mkdtemp(prefix="contvines-auto-"))
        home, source = os.environ["AUTO_DIR"], Path(__file__).with_name("lorenz_auto.f90")
        objects = sorted(str(path) for path in (Path(home) / "lib").glob("*.o"))
        command = ["gfortran", "-O3", "-march=native", "-w", f"-I{home}/include", str(source), *objects]
        subprocess.run(
            [*command, "-fopenmp", "-o", "lorenz"], cwd=self.directory, check=True, capture_output=True
        )
        np.savetxt(self.directory / "lorenz.dat", data, fmt="%.16e")
        (self.directory / "fort.2").write_text(CONSTANTS.format(intervals=intervals))

    def run(self):
        """Follow the branch; return processor time and its rows."""
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        environment = {**os.environ, "OMP_NUM_THREADS": "1"}
        subprocess.run(["./lorenz"], cwd=self.directory, check=True, capture_output=True, env=environment)
        seconds = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
        rows = [line.split() for line in (self.directory / "fort.7").read_text().splitlines()]
        return seconds, [row for row in rows if row and row[0] in ("1", "-1")]


def competitors(intervals):
    """Return all programs that are installed here, by name."""
    found: dict[str, Any] = {"numpy": Ours(in_python(), intervals)}
    compiled = in_c(tempfile.mkdtemp(prefix="contvines-lorenz-"))
    if compiled is not None:
        found["compiled"] = Ours(compiled, intervals)
    if Auto().available:
        found["AUTO"] = AutoFlow(found["numpy"].data(), intervals)
    return found


def main(rounds=7):
    """Print medians over interleaved rounds, in milliseconds per point, and ratios to AUTO."""
    for intervals in map(int, sys.argv[1:] or (20, 80, 320)):
        runs = competitors(intervals)
        times = {name: [] for name in runs}
        for _ in range(rounds):
            for name, run in runs.items():
                seconds, points = run.run()
                times[name].append(1e3 * seconds / len(points))
        medians = {name: float(np.median(values)) for name, values in times.items()}
        base = medians.get("AUTO")
        words = [
            f"{name} {value:.3f} ms" + (f" ({value / base:.2f})" if base else "")
            for name, value in medians.items()
        ]
        print(f"{intervals:4d} intervals: {', '.join(words)}")


if __name__ == "__main__":
    main()
