"""Where heyoka is missing scipy integrates declared machines: the same orbits and borders, told in one line."""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from tools.pages.pages import page

pytestmark = pytest.mark.slow

SCRIPT = """
import json, sys
import contvines as cv
from tools.pages.pages import page
found = {}
for name in ("impact_oscillator", "belt_slider", "den_hartog"):
    orbit = page(name).attractor().found
    found[name] = [orbit.word.text, orbit.nodes.tolist(), [abs(m) for m in orbit.multipliers]]
graph = cv.diagram(page("impact_oscillator").orbit("R", frequency=2.3), over="frequency", within=(2.2, 2.8), depth=0)
found["flips"] = [p.value for p in graph.of_kind("period-doubling")]
json.dump(found, sys.stdout)
"""


@pytest.fixture(scope="module")
def by_scipy():
    run = subprocess.run(
        [sys.executable, "-c", SCRIPT],
        env={**os.environ, "CONTVINES_PAGES": "scipy"},
        cwd=Path(__file__).parents[3],
        capture_output=True,
        text=True,
        check=True,
        timeout=600,
    )
    return json.loads(run.stdout)


@pytest.mark.parametrize("name", ["impact_oscillator", "belt_slider", "den_hartog"])
def test_attractors_are_the_same(by_scipy, name):
    word, nodes, multipliers = by_scipy[name]
    orbit = page(name).attractor().found
    assert orbit.word.text == word
    assert np.array(nodes) == pytest.approx(orbit.nodes, abs=1e-10)
    assert multipliers == pytest.approx(np.abs(orbit.multipliers), abs=1e-9)


def test_a_period_doubling_is_where_it_is_in_closed_form(by_scipy):
    """Of an undamped oscillator on its wall with restitution e, driven at W: see `test_closed_forms`."""
    import contvines as cv

    graph = cv.diagram(
        page("impact_oscillator").orbit("R", frequency=2.3), over="frequency", within=(2.2, 2.8), depth=0
    )
    told = [point.value for point in graph.of_kind("period-doubling")]
    assert told and by_scipy["flips"] == pytest.approx(told, abs=1e-8)


def test_an_unknown_integrator_is_refused():
    run = subprocess.run(
        [sys.executable, "-c", "from orbits.integrators.engine import engine; engine()"],
        env={**os.environ, "CONTVINES_PAGES": "rk4"},
        cwd=Path(__file__).parents[3],
        capture_output=True,
        text=True,
    )
    assert "CONTVINES_PAGES=rk4: say heyoka or scipy" in run.stderr
