"""One machine in other units is one machine: special points do not depend on what a length or a time is counted in."""

import numpy as np
import pytest

import contvines as cv
from orbits import Absorber, Cavity
from orbits.attractors import find_attractor
from orbits.starts.find import polish


def points(graph, unit=1.0):
    return sorted((point.kind, point.real, point.value / unit) for point in graph.special.values())


def same(ours, theirs):
    assert [point[:2] for point in ours] == [point[:2] for point in theirs]
    np.testing.assert_allclose([point[2] for point in ours], [point[2] for point in theirs], rtol=1e-9)


@pytest.fixture(scope="module")
def slow():
    machine = Absorber(restitution=0.41, friction=0.68, gravity=0.44, mass_ratio=0.006)
    graph = cv.diagram(machine.orbit("LR", amplitude=0.75), over="amplitude", within=(0.3, 1.4), depth=1)
    assert len(graph.special) >= 6
    return machine, graph


@pytest.mark.parametrize("rate", [300.0, 10.0, 1.0 / 300.0])
def test_times_may_be_counted_in_anything(slow, rate):
    """Only C, r and a/Omega^2 matter: with the frequency grow the friction's acceleration, as its square, and all speeds."""
    machine, graph = slow
    fast = Absorber(restitution=0.41, friction=0.68, gravity=0.44 * rate**2, mass_ratio=0.006, frequency=rate)
    nodes = machine.orbit("LR", amplitude=0.75).nodes * [1.0, rate]
    orbit = fast.orbit("LR", amplitude=0.75, guess=nodes)
    assert orbit.nodes == pytest.approx(nodes, rel=1e-12)
    again = cv.diagram(orbit, over="amplitude", within=(0.3, 1.4), depth=1)
    same(points(again), points(graph))
    for point in again.of_kind("stick"):
        assert point.replay < 1e-8


@pytest.mark.parametrize("length", [300.0, 10.0, 1.0 / 300.0])
def test_lengths_may_be_counted_in_anything(length):
    sizes = {"gravity": 0.211, "distance_left": 1.0, "distance_right": 1.1}

    def machine(unit):
        scaled = {name: value * unit for name, value in sizes.items()}
        return Cavity(restitution=0.6, friction=0.5, slope=0.1, mass_ratio=0.006, **scaled)

    found = find_attractor(machine(1.0), {"w_rate": 1.0}, amplitude=0.9)
    orbit = polish(found.orbit)
    graph = cv.diagram(orbit, over="amplitude", within=(0.6, 1.2), depth=1)
    speeds = [letter in "LR" for letter in orbit.word.events]
    assert any(speeds) and len(graph.special) >= 4
    longer = machine(length).orbit(
        orbit.word, periods=orbit.periods, guess=orbit.nodes * [1.0, length], amplitude=0.9 * length
    )
    again = cv.diagram(longer, over="amplitude", within=(0.6 * length, 1.2 * length), depth=1)
    same(points(again, length), points(graph))
