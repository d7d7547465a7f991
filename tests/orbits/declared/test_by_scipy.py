"""Where heyoka is missing scipy integrates declared machines: the same orbits and borders."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

import contvines as cv
from tools.pages.pages import page

pytestmark = pytest.mark.slow


def found():
    """Words, nodes and multipliers of attractors, and where a period doubles."""
    orbits = [page(name).attractor().found for name in ("impact_oscillator", "belt_slider", "den_hartog")]
    start = page("impact_oscillator").orbit("R", frequency=2.3)
    graph = cv.diagram(start, over="frequency", within=(2.2, 2.8), depth=0)
    numbers = [number for orbit in orbits for number in [*orbit.nodes.ravel(), *map(abs, orbit.multipliers)]]
    flips = [point.value for point in graph.of_kind("period-doubling")]
    return [[orbit.word.text for orbit in orbits], len(flips), [*numbers, *flips]]


def by(integrator):
    script = "import json; from tests.orbits.declared.test_by_scipy import found; print(json.dumps(found()))"
    return subprocess.run(
        [sys.executable, "-c", script],
        env={**os.environ, "CONTVINES_PAGES": integrator},
        cwd=Path(__file__).parents[3],
        capture_output=True,
        text=True,
        timeout=600,
    )


def test_orbits_and_a_period_doubling_are_the_same():
    *words, numbers = json.loads(by("scipy").stdout)
    *known, expected = found()
    assert words == known and known[1] and numbers == pytest.approx(expected, abs=1e-8)


def test_an_unknown_integrator_is_refused():
    assert "CONTVINES_PAGES=rk4: say heyoka or scipy" in by("rk4").stderr
