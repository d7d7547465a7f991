"""The built-in absorber declared on a page: the same words and the same special points, found by other means."""

import pytest

import contvines as cv
import orbits
from tests.orbits.declared.pages import page


def special(graph):
    return sorted((point.kind, point.value) for point in graph.special.values())


def test_the_absorber_has_the_same_graph():
    own = orbits.Absorber(restitution=0.76, friction=0.5, gravity=0.211, mass_ratio=0.006, frequency=1.0)
    settings = {"over": "amplitude", "within": (0.5, 0.88), "depth": 1}
    built_in = cv.diagram(own.orbit("LR", amplitude=0.55), **settings)
    declared = cv.diagram(page("absorber").orbit("LR", amplitude=0.55), **settings)
    mine, theirs = special(declared), special(built_in)
    assert [kind for kind, _ in mine] == [kind for kind, _ in theirs]
    assert [value for _, value in mine] == pytest.approx([value for _, value in theirs], abs=1e-10)
    read = page("absorber").word  # a mirror image, or another first event, is the same word
    words = [
        sorted(read(b.description["word"]).canonical().events for b in graph.branches.values())
        for graph in (declared, built_in)
    ]
    assert words[0] == words[1]


def test_the_coupled_absorber_has_the_same_orbits():
    settings = {"damping": 1.0, "mass_ratio": 0.006, "restitution": 0.76, "friction": 0.5, "gravity": 0.211}
    own = orbits.Coupled(forcing=2.47, frequency=1.01, **settings).orbit("LR")
    orbit = page("coupled").orbit("LR")
    assert sorted(map(abs, orbit.multipliers)) == pytest.approx(sorted(map(abs, own.multipliers)), abs=1e-9)
    speeds = (
        own.events.B_post[0] - own.events.B_pre[0],
        (1 + 1 / 0.76) * abs(orbit.nodes[0, 3] - orbit.nodes[0, 4]),
    )
    assert abs(speeds[0]) == pytest.approx(speeds[1], abs=1e-10)
