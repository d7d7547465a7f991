"""The example pages: each has a motion that the simulator follows."""

import pytest

from orbits.simulation import replay
from tools.pages.pages import PAGES, page

STARTS = {
    "bouncing_ball": ({"y": 0.1, "v": 0.33, "phase": -0.8}, {"amplitude": 0.05}),
    "belt_slider": ({"x": 1.0, "v": 0.5}, {}),
    "two_absorbers": ({"s1": 0.3, "s2": 0.3}, {"forcing": 0.03, "frequency": 1.01}),
}
NAMES = sorted(p.stem for p in PAGES.glob("*.py") if p.stem != "draw")


@pytest.mark.parametrize("name", NAMES)
def test_the_machine_of_a_page_moves(name):
    start, parameters = STARTS.get(name, (None, {}))
    found = page(name).attractor(start, **parameters)
    assert found.kind == "periodic" and found.orbit.real and found.orbit.stable
    assert found.orbit.replay() < 1e-9
    assert not found.orbit.forced or replay(found.orbit).error < 1e-8
