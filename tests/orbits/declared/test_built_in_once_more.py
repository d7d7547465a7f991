"""The built-in absorber declared in a machine file: the same words and the same special points, found by other means."""

import pytest

import orbits
from tools.pages.pages import page
from tools.pages.same_graph import both, compared, drawn

pytestmark = pytest.mark.slow

COUPLED = {"damping": 1.0, "mass_ratio": 0.006, "restitution": 0.76, "friction": 0.5, "gravity": 0.211}


def test_the_absorber_has_the_same_graph():
    kind, graphs = both("friction", within=(0.5, 0.88), depth=1)
    found = compared(kind, *graphs)
    assert found.sentences == []
    assert found.points == len(graphs[0].special) > 5


@pytest.mark.parametrize("seed", [14, 18])
def test_drawn_absorbers_have_the_same_graph(seed):
    graphs = drawn("absorber", 410, seed)
    found = compared("absorber", *graphs)
    assert found.sentences == []
    assert found.points == len(graphs[0].special) > 1


def test_the_coupled_absorber_has_the_same_orbits():
    own = orbits.Coupled(forcing=2.47, frequency=1.01, **COUPLED).orbit("LR")
    orbit = page("coupled").orbit("LR")
    assert sorted(map(abs, orbit.multipliers)) == pytest.approx(sorted(map(abs, own.multipliers)), abs=1e-9)
    speeds = (
        own.events.B_post[0] - own.events.B_pre[0],
        (1 + 1 / 0.76) * abs(orbit.nodes[0, 3] - orbit.nodes[0, 4]),
    )
    assert abs(speeds[0]) == pytest.approx(speeds[1], abs=1e-10)
