"""The built-in absorber declared on a page: the same words and the same special points, found by other means."""

import pytest

import contvines as cv
import orbits
from tests.orbits.declared.pages import page
from tests.orbits.declared.same_graph import both, compared

COUPLED = {"damping": 1.0, "mass_ratio": 0.006, "restitution": 0.76, "friction": 0.5, "gravity": 0.211}


def test_the_absorber_has_the_same_graph():
    kind, graphs = both("friction", within=(0.5, 0.88), depth=1)
    found = compared(kind, *graphs)
    assert found.sentences == []
    assert found.points == len(graphs[0].special) > 5


def test_the_absorber_on_its_oscillator_that_begins_to_slip_has_the_same_graph():
    # motions without impacts may sit anywhere in the cavity: those that meet at a border need not sit at one place
    word, settings = "ss", {"over": "frequency", "within": (1.03, 1.09), "depth": 1}
    own = orbits.Coupled(forcing=2.47, frequency=1.05, **COUPLED).orbit(word)
    graphs = [cv.diagram(orbit, **settings) for orbit in (own, page("coupled").orbit(word, frequency=1.05))]
    found = compared("coupled", *graphs)
    assert found.sentences == []
    assert [p.kind for p in graphs[1].special.values()].count("stick") == 2


def test_periods_are_added_at_the_same_border():
    # orbits of six and seven rounds with one more impact: their words and special points are the built-in machine's
    values = {
        "restitution": 0.15840379606858848,
        "friction": 0.27062304650022073,
        "gravity": 0.08085179925290478,
    }
    word, settings = "LttRtt", {"over": "amplitude", "within": (1.2875, 1.2887), "depth": 1}
    own = orbits.Absorber(**values, mass_ratio=0.006).orbit(word, amplitude=1.288)
    graphs = [
        cv.diagram(orbit, **settings)
        for orbit in (own, page("absorber").orbit(word, amplitude=1.288, mass_ratio=0.006, **values))
    ]
    found = compared("absorber", *graphs)
    assert found.sentences == [] and found.points >= 7
    assert {6, 7} < {branch.description["periods"] for branch in graphs[1]}


def test_the_coupled_absorber_has_the_same_orbits():
    own = orbits.Coupled(forcing=2.47, frequency=1.01, **COUPLED).orbit("LR")
    orbit = page("coupled").orbit("LR")
    assert sorted(map(abs, orbit.multipliers)) == pytest.approx(sorted(map(abs, own.multipliers)), abs=1e-9)
    speeds = (
        own.events.B_post[0] - own.events.B_pre[0],
        (1 + 1 / 0.76) * abs(orbit.nodes[0, 3] - orbit.nodes[0, 4]),
    )
    assert abs(speeds[0]) == pytest.approx(speeds[1], abs=1e-10)
