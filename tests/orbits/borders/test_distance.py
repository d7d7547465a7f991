"""Motions compared as motions, whatever event or forcing period their descriptions begin with."""

from dataclasses import replace

import numpy as np
import pytest

from orbits import Absorber
from orbits.borders.alignment import read_alike
from orbits.borders.distance import distance, tends_to
from orbits.orbit import Orbit
from orbits.protocol import Seed
from orbits.words import Word

MACHINE = Absorber(restitution=0.7, friction=0.4, gravity=0.3, mass_ratio=0.02)
PARAMS = MACHINE.vector({"amplitude": 0.8})


def moved(orbit, phase=0.0, w=0.0):
    nodes = orbit.nodes + np.array([phase, 0.0])
    nodes[:, 1] += w
    return replace(orbit, nodes=nodes)


@pytest.fixture(scope="module")
def long():
    """Two forcing periods, unlike each other; it need not solve anything."""
    nodes = [[0.3, 0.9], [1.5, 0.4], [6.9, 0.5], [8.6, 0.1]]
    return Orbit(MACHINE, Word.parse("LtLt"), 2, np.array(nodes), PARAMS)


def test_a_forcing_period_later_it_is_the_same_motion(long):
    for other in (moved(long, 2.0 * np.pi), moved(long, -6.0 * np.pi), long.rotate(2)):
        assert distance(long, other) == pytest.approx(0.0, abs=1e-9)
        assert distance(other, long) == pytest.approx(0.0, abs=1e-9)
    assert distance(long, moved(long, 1.0)) > 0.05  # not so a part of a period later


def test_mirror_images_only_where_asked(long):
    assert distance(long, long.mirror()) > 0.5
    assert distance(long, long.mirror(), mirror=True) == pytest.approx(0.0, abs=1e-6)


def test_motions_without_impacts_may_lie_anywhere():
    sliding = MACHINE.orbit("tt", 1, amplitude=0.5)
    assert distance(sliding, moved(sliding, w=0.2)) == pytest.approx(0.0, abs=1e-9)
    hits = MACHINE.symmetric_orbit(amplitude=0.8)
    near = replace(hits, nodes=hits.nodes + np.array([0.01, 0.0]))
    assert distance(hits, near) > 1e-3


def test_a_distance_that_does_not_shrink_is_no_limit():
    """Orbits that tend to a border orbit come nearer on the way; others are as far there as before."""
    border = MACHINE.orbit("tt", 1, amplitude=0.5)
    at = {step: MACHINE.orbit("tt", 1, amplitude=0.5 + step) for step in (1e-3, 1e-2, 1.1e-2)}
    assert tends_to(border, at[1e-3], at[1e-2])
    assert not tends_to(border, at[1e-2], at[1.1e-2])
    assert tends_to(border, border, border)


def test_seeds_are_read_from_the_event_of_the_orbit_before():
    before = MACHINE.symmetric_orbit(amplitude=0.8)
    other = moved(before.rotate(1), 4.0 * np.pi)
    problem = other.problem("amplitude", symmetric=False)
    seed = Seed(problem, problem.reduce(other.nodes), 0.8, None, "border", "", True)
    found = read_alike(seed, before)
    assert found.problem.word == before.word
    assert found.u == pytest.approx(before.nodes.ravel(), abs=1e-12)
