"""One machine in other units is one machine: special points do not depend on what a length or a time is counted in, nor on where the middle of the cavity is."""

import numpy as np
import pytest

import contvines as cv
from orbits import Absorber, Cavity

WITHIN = np.array([0.3, 1.4])
SLOW = {"restitution": 0.41, "friction": 0.68, "mass_ratio": 0.006}


@pytest.fixture(scope="module")
def slow():
    orbit = Absorber(**SLOW, gravity=0.44).orbit("LR", amplitude=0.75)
    graph = cv.diagram(orbit, over="amplitude", within=tuple(WITHIN), depth=1)
    assert len(graph.special) >= 6
    return orbit, graph


def same(graph, again, unit=1.0):
    ours, theirs = (
        sorted((point.kind, point.real, point.value / size) for point in one.special.values())
        for one, size in ((again, unit), (graph, 1.0))
    )
    assert [point[:2] for point in ours] == [point[:2] for point in theirs]
    np.testing.assert_allclose([point[2] for point in ours], [point[2] for point in theirs], rtol=1e-9)


@pytest.mark.parametrize("rate", [300.0, 10.0, 1.0 / 300.0])
def test_times_may_be_counted_in_anything(slow, rate):
    """Only C, r and a/Omega^2 matter: with the frequency grow the friction's acceleration, as its square, and all speeds."""
    orbit, graph = slow
    nodes = orbit.nodes * [1.0, rate]
    fast = Absorber(**SLOW, gravity=0.44 * rate**2, frequency=rate).orbit("LR", amplitude=0.75, guess=nodes)
    assert fast.nodes == pytest.approx(nodes, rel=1e-12)
    again = cv.diagram(fast, over="amplitude", within=tuple(WITHIN), depth=1)
    same(graph, again)
    assert all(point.replay < 1e-8 for point in again.of_kind("stick"))


def test_level_with_unlike_distances_it_is_the_absorber_in_other_units(slow):
    """All words, and borders where events off the walls begin: b = (d_L + d_R)/2, C and g as C/b and g/b."""
    left, right = 0.9, 1.3
    b = 0.5 * (left + right)
    cavity = Cavity(**SLOW, gravity=0.44 * b, distance_left=left, distance_right=right)
    again = cv.diagram(
        cavity.orbit("LR", amplitude=0.75 * b), over="amplitude", within=tuple(b * WITHIN), depth=1
    )
    same(slow[1], again, b)
    listed = [
        [(branch.description["word"], branch.real, branch.description["symmetric"]) for branch in graph]
        for graph in (slow[1], again)
    ]
    assert listed[0] == listed[1] and len({word for word, *_ in listed[0]}) > 2
    orbit = next(b for b in again if not b.description["symmetric"] and b.real).orbit(3)
    image = orbit.mirror()
    assert image.residual < 1e-10 and image.real
    assert np.abs(image.positions(200) - orbit.positions(200)).max() > 1e-3
    # seen from the middle the image is on the other side, half a period later
    assert image.positions(200) + np.roll(orbit.positions(200), 100) == pytest.approx(left - right, abs=1e-10)
