"""Atlases against brute force in C that shares nothing with the package; `truth.py` has the long runs."""

import shutil

import pytest

import contvines as cv
from orbits import Cavity
from tests.machines import ABSORBER, COUPLED
from tools.attractors.drawn import drawn
from tools.attractors.truth import listed_twice, on_atlas, shares, witness

pytestmark = [pytest.mark.slow, pytest.mark.skipif(shutil.which("gcc") is None, reason="gcc is needed")]


@pytest.mark.parametrize(
    ("machine", "over", "within", "values", "starts"),
    [
        (ABSORBER, "amplitude", (0.5, 1.2),
         (0.5758, 0.9058, 1.0892), 400),
        (Cavity(restitution_left=0.6, restitution_right=0.8, friction_left=0.1, friction_right=0.3, gravity=0.2, slope=0.1,
                mass_ratio=0.006), "amplitude", (0.5, 1.2), (0.55, 0.8, 1.05), 200),
        (COUPLED, "frequency", (0.990, 0.994), (0.9905, 0.9935), 24),
    ],
    ids=["absorber", "cavity", "coupled"],
)  # fmt: skip
def test_everything_that_brute_force_meets_is_on_the_atlas(machine, over, within, values, starts):
    met = witness(machine, over, values, starts)
    assert sum(len(here.attractors) for here in met) >= len(values)
    graph = cv.atlas(machine, over=over, within=within, values=4, starts=64, depth=0, scan=32)
    said = []
    tally = on_atlas(graph, met, not isinstance(machine, Cavity), said.append)
    assert not tally.missing and not tally.unnamed, said
    assert not listed_twice(graph)
    counted = shares(machine.population(over), met, starts, not isinstance(machine, Cavity), said.append)
    assert counted.compared and not counted.apart, said


def test_brute_force_tells_no_saddle_that_it_passes_for_an_attractor():
    """At a fifth of the starts it once told three impacts in a period: those of the second period of the motion of six in two."""
    machine, over, _ = drawn("coupled", 19)
    (here,) = witness(machine, over, [0.99522273], 60, tries=4)
    assert sorted((periods, hits) for periods, hits, *_ in here.attractors) == [(1, 2), (2, 6)]
