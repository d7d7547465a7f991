"""The gallery's special orbits against an independent integrator, and drawn machines against simulation; a few of each.

All of them: `python -m tools.pages.gallery` and `python -m tools.pages.draws`.
"""

import numpy as np
import pytest

from tools.pages.draws import RANGES, drawn, examined
from tools.pages.gallery import deviations, gallery
from tools.pages.pages import PAGES

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def drawing():
    return gallery()


def test_every_page_is_in_the_gallery_and_drawn_from(drawing):
    pages = {path.stem for path in PAGES.glob("*.py")} - {"draw"}
    assert set(drawing.RUNS) == set(RANGES) == pages


@pytest.mark.parametrize("name", ["bouncing_ball", "belt_slider", "elastic_stop"])
def test_special_orbits_of_the_gallery(name, drawing):
    _, graph = drawing.diagram(name)
    found = deviations(graph)
    assert found and max(found.values()) < 1e-8


@pytest.mark.parametrize("name", sorted(set(RANGES) - {"two_absorbers"}))
def test_drawn_machines(name):
    generator = np.random.default_rng(7)
    for _ in range(2):
        _, wrong = examined(name, *drawn(name, generator))
        assert not wrong
