"""The built-in absorber declared in a machine file: the same words and the same special points, found by other means."""

import numpy as np
import pytest
from scipy.optimize import brentq

import contvines as cv
import orbits
from orbits.borders.crossing import escapes
from orbits.borders.neighbours import margins_of, placed, turned
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


def test_the_absorber_on_its_oscillator_that_begins_to_slip_has_the_same_graph():
    # motions without impacts may sit anywhere in the cavity: those that meet at a border need not sit at one place
    word, settings = "ss", {"over": "frequency", "within": (1.03, 1.09), "depth": 1}
    own = orbits.Coupled(forcing=2.47, frequency=1.05, **COUPLED).orbit(word)
    graphs = [cv.diagram(orbit, **settings) for orbit in (own, page("coupled").orbit(word, frequency=1.05))]
    found = compared("coupled", *graphs)
    assert found.sentences == []
    assert [p.kind for p in graphs[1].special.values()].count("stick") == 2


def test_periods_are_added_at_a_border_of_the_page_too():
    # orbits of six and seven rounds with one more impact, as `borders.test_doubled_words` has them of the built-in machine
    values = {
        "restitution": 0.15840379606858848,
        "friction": 0.27062304650022073,
        "gravity": 0.08085179925290478,
    }
    machine = page("absorber")

    def solved(amplitude, guess=None):
        return machine.orbit("LttRtt", 1, guess, amplitude=amplitude, mass_ratio=0.006, **values)

    nodes = solved(1.288).nodes
    p = brentq(lambda a: solved(a, nodes).margin, 1.288, 1.289, xtol=1e-14)
    problem = solved(p, nodes).problem("amplitude", symmetric=False)
    here, beside = (solved(a, nodes).seed(problem)[0] for a in (p, p - 1e-5))
    index = int(np.argmin(margins_of(problem, here, p)))
    near = (*turned(problem, beside, p - 1e-5, index)[:2], p - 1e-5)
    added = {}
    for seed in escapes(placed(problem, here, p, index), [near]):
        if "times as long" in seed.note:
            added[seed.problem.periods] = seed.problem.orbit(seed.u, seed.p)
    assert set(added) == {6, 7}
    for orbit in added.values():
        assert orbit.stable and orbit.real and orbit.replay() < 1e-9
        assert orbit.word.impacts == 2 * orbit.periods + 1


def test_the_coupled_absorber_has_the_same_orbits():
    own = orbits.Coupled(forcing=2.47, frequency=1.01, **COUPLED).orbit("LR")
    orbit = page("coupled").orbit("LR")
    assert sorted(map(abs, orbit.multipliers)) == pytest.approx(sorted(map(abs, own.multipliers)), abs=1e-9)
    speeds = (
        own.events.B_post[0] - own.events.B_pre[0],
        (1 + 1 / 0.76) * abs(orbit.nodes[0, 3] - orbit.nodes[0, 4]),
    )
    assert abs(speeds[0]) == pytest.approx(speeds[1], abs=1e-10)
