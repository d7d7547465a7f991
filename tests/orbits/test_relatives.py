"""Symmetries of words that repeat a shorter one: their motions may be symmetric as a whole."""

import numpy as np
import pytest

import contvines as cv
from contvines.circles.section import section_of, slopes
from orbits import Absorber

MACHINE = Absorber(
    restitution=0.9371779390827915, friction=0.5074985132691717, gravity=0.5533916882587391, mass_ratio=0.0
)


@pytest.fixture(scope="module")
def graph():
    start = MACHINE.attractor({"w_rate": 1.0, "phase": 1.0}, amplitude=0.86)
    assert start.text == "LRLtsRLRts"
    return cv.diagram(start, over="amplitude", within=(0.6, 0.87), depth=1)


def test_a_thrice_repeated_word_breaks_its_symmetry_as_a_whole(graph):
    point = next(
        p
        for p in graph.of_kind("symmetry-breaking")
        if graph.branches[p.branch].description["word"] == "LRLRLR"
    )
    orbit = point.orbit
    half = len(orbit.nodes) // 2
    assert np.abs(orbit.nodes[half:, 1] + orbit.nodes[:half, 1]).max() < 1e-5
    assert np.abs(orbit.nodes[half:, 0] - orbit.nodes[:half, 0] - 3.0 * np.pi).max() < 1e-5
    section = section_of(point.problem, point.value)
    simulated = np.linalg.eigvals(slopes(section, section.through(point.u), 1e-6))
    assert np.abs(simulated - 1.0).min() < 1e-3
    assert not graph.of_kind("branch-point")
    symmetric = [b for b in graph if b.description["word"] == "LRLRLR" and b.problem.symmetric]
    assert symmetric  # the branch on the other side is known to be symmetric


def test_rotations_that_mirror_a_word(graph):
    branch = next(b for b in graph if b.description["word"] == "LRLRLR" and not b.problem.symmetric)
    u = branch.points[len(branch) // 2]
    images = [s.apply(u) for s in branch.problem.symmetries if s.kind == "symmetry-breaking"]
    assert len(images) == 2  # one and three events on
    value = float(branch.values[len(branch) // 2])
    for image in images:
        orbit = branch.problem.orbit(image, value)
        assert orbit.residual < 1e-9
        assert orbit.replay() < 1e-6
