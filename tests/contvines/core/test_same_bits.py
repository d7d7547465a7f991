"""The two variants of the native core give the same bits: whole studies, and a simulation, in a process for each variant."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from contvines.core.build import variants
from contvines.core.library import native

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[3]
DIGESTS = """
import hashlib
import numpy as np
import contvines as cv
from contvines.core.library import variant
from orbits import Coupled
from orbits.simulation.runs import simulate
from tests.golden.studies import first_orbit, starts

def digest(arrays):
    return hashlib.sha256(b"".join(np.ascontiguousarray(a).tobytes() for a in arrays)).hexdigest()

print(variant())
for name in ("friction", "friction_low", "frequency", "inclined", "cavity 3"):
    start = starts()[name]
    graph = cv.diagram(first_orbit(start), **{**start["options"], "depth": 1})
    arrays = [a for b in graph for a in (b.values, b.points, b.tangents, b.multipliers, b.margin)]
    print(name, digest([*arrays, [point.value for point in graph.special.values()]]))
machine = Coupled(
    restitution=0.76, friction=0.5, gravity=0.211, mass_ratio=0.006, damping=1.0, forcing=2.47, frequency=0.985
)
print("simulation", digest([simulate(machine, {"w_rate": 0.7, "v": 0.4}, events=2000).states]))
"""


@pytest.mark.skipif(not native() or "avx2" not in variants(), reason="one variant only")
def test_studies_and_a_simulation_give_the_same_bits():
    lines = []
    for name in ("baseline", "avx2"):
        found = subprocess.run(
            [sys.executable, "-c", DIGESTS],
            cwd=ROOT,
            env=os.environ | {"CONTVINES_CORE": name},
            capture_output=True,
            text=True,
            check=True,
            timeout=300,
        ).stdout.splitlines()
        if found[0] != name:
            pytest.skip("this processor has no AVX2")
        lines.append(found[1:])
    assert len(lines[0]) == 6 and lines[0] == lines[1]
