"""A problem of your own in compiled code: a table of C functions in a shared library, followed by the compiled continuation loop.

`reaction.c` holds F, its derivatives, a bordered solve and the eigenvalues: the first three functions of the contract at the top of
`contvines.problems.protocol`. They may be written in any language that makes a shared library, or be a numba `cfunc`. This file compiles it, wraps the
library as a problem and draws the diagram: two folds and a Hopf point.
"""

import ctypes
import subprocess
import sys
from pathlib import Path

import numpy as np

import contvines as cv
from contvines.core.table import TableKernels

SOURCE = Path(__file__).with_name("reaction.c")


class Numbers(tuple):
    """Views of one array, ``memory``, at whose address the C functions find them; the first one is F."""

    def __new__(cls, memory, *pieces):
        made = super().__new__(cls, pieces)
        made.memory = memory
        return made


class Reaction(cv.ProblemDefaults):
    """Equilibria of the reaction against p."""

    dimension, n_multipliers, parameter = 2, 2, "p"
    spectrum = detection = "flow"
    u0, p0 = np.zeros(2), 0.0

    def __init__(self, library, b=3.0, heat=14.0):
        self.library = ctypes.CDLL(str(library))  # kept: the functions live in it
        self.kernels = TableKernels(ctypes.addressof((ctypes.c_void_p * 6).in_dll(self.library, "table")))
        self.data = Numbers(np.array([b, heat]))

    def workspace(self):
        memory = np.zeros(8)
        return Numbers(memory, memory[:2], memory[2:6].reshape(2, 2), memory[6:])


def compiled(folder):
    """The library, compiled into a folder."""
    library = Path(folder).resolve() / "reaction.so"
    subprocess.run(["cc", "-O2", "-shared", "-fPIC", "-o", library, SOURCE, "-lm"], check=True)
    return library


if __name__ == "__main__":
    graph = cv.diagram(Reaction(compiled(sys.argv[1] if len(sys.argv) > 1 else ".")), within=(0.0, 0.15))
    print(graph)
    graph.plot(y="u0").savefig("reaction.png")
