"""Plain C programs as lower bounds of times ("floor"), compiled with the system's compiler and called through ctypes."""

import ctypes
import hashlib
import os
import shutil
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from . import case

FORWARD, ORTHOGONAL = 0, 1
PLAIN = ("-O3", "-march=native")
VECTOR = ("-O3", "-march=native", "-ffast-math", "-DVECTOR")


@cache
def library(source="continuation.c", flags=PLAIN):
    """Compile and load a library; return None without a C compiler."""
    compiler = shutil.which(os.environ.get("CC", "cc"))
    if compiler is None or sys.platform == "win32":
        return None
    path = Path(__file__).with_name(source)
    digest = hashlib.blake2b(
        path.read_bytes() + " ".join((*flags, "linked apart")).encode(), digest_size=8
    ).hexdigest()
    target = Path(tempfile.gettempdir()) / f"contvines-benchmark-{os.getuid()}-{digest}.so"
    if not target.exists():
        partial = target.with_suffix(f".{os.getpid()}")
        # Link without the flags: with -ffast-math the linker would add start-up code that disables subnormal numbers
        # in the whole process.
        made = Path(f"{partial}.o")  # one file per process
        for command in (
            [compiler, *flags, "-fPIC", "-c", "-o", str(made), str(path)],
            [compiler, "-shared", "-o", str(partial), str(made), "-lm"],
        ):
            subprocess.run(command, check=True, capture_output=True, text=True)
        made.unlink()
        partial.replace(target)
    return ctypes.CDLL(str(target))


def _pointer(array):
    return array.ctypes.data_as(ctypes.POINTER(ctypes.c_double))


@dataclass
class Run:
    """Points of a branch in the common form of all programs that are compared."""

    points: np.ndarray
    values: np.ndarray
    rows: np.ndarray
    sweeps: int
    tried: int


class Floor:
    """Continuation in C for one length of the word; arrays are allocated once."""

    def __init__(self, l, eliminate=FORWARD, flags=PLAIN, count=2000, step=case.STEP):
        self.library = library("continuation.c", flags)
        self.l, self.eliminate, self.count = l, eliminate, count
        n = 2 * l
        self.points, self.values = np.empty((count, n)), np.empty(count)
        self.tangents, self.rows = np.empty((count, n + 1)), np.zeros((count, 4 + 4 * l))
        self.points[0], self.values[0], self.tangents[0] = case.start(l)
        self.memory = np.zeros(60 * l + 100)
        metric_u, metric_p = case.metric(l)
        self.control = np.array([metric_u, metric_p, case.ANGLE, 1e-9, step, case.TOLERANCE, *case.INTERVAL])
        self.done = np.zeros(2, np.int64)
        self.step = step
        function = self.library.floor_march
        function.restype = ctypes.c_int
        number = ctypes.POINTER(ctypes.c_double)
        function.argtypes = [ctypes.c_int] * 3 + [number] * 2 + [ctypes.c_int] + [number] * 5
        function.argtypes += [ctypes.c_double, ctypes.POINTER(ctypes.c_long)]
        arrays = (self.points, self.values, self.tangents, self.rows, self.memory)
        self.arguments = (l, eliminate, 8, _pointer(case.PARAMS), _pointer(self.control), count)
        self.arguments += tuple(map(_pointer, arrays))
        self.arguments += (step, self.done.ctypes.data_as(ctypes.POINTER(ctypes.c_long)))
        self.function = function

    def run(self):
        """Follow the branch; return the number of points."""
        return self.function(*self.arguments)

    def result(self):
        """Return the points of the run (the first is the start, without a row)."""
        filled = self.run()
        return Run(self.points[:filled], self.values[:filled], self.rows[:filled], *map(int, self.done))
