"""A flow whose right-hand side is compiled: the cycles of Lorenz's equations from the Hopf point to the homoclinic orbit.

`lorenz.c` holds f, df/dx and df/dp for many points at once. This file compiles it and draws the diagram.
"""

import subprocess
import sys
from pathlib import Path

import numpy as np

import contvines as cv

SOURCE = Path(__file__).with_name("lorenz.c")


def compiled(folder):
    """The library, compiled into a folder."""
    library = Path(folder) / "lorenz.so"
    subprocess.run(["cc", "-O2", "-shared", "-fPIC", "-o", library, SOURCE], check=True)
    return library


def flow(library):
    """The flow, at the equilibrium in one of the wings."""
    side = np.sqrt(8 / 3 * 19)
    return cv.FlowProblem(
        cv.flows.CompiledRates(library),
        [side, side, 19.0],
        {"r": 20.0, "s": 10.0, "b": 8 / 3},
        mirror=lambda x: x * np.array([-1, -1, 1]),
    )


if __name__ == "__main__":
    graph = cv.diagram(
        flow(compiled(sys.argv[1] if len(sys.argv) > 1 else ".")), over="r", within=(13.0, 26.0)
    )
    print(graph)
    graph.plot(y="period").savefig("lorenz.png")
