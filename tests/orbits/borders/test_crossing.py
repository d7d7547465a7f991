"""What counts as an orbit beyond a border: every margin kept, and followed by the simulation."""

import numpy as np
import pytest

import contvines as cv
from orbits import Absorber, Cavity
from orbits.borders.neighbours import Grown, followed

MACHINE = Absorber(restitution=0.76, friction=0.2, gravity=0.211, mass_ratio=0.006)
H = 0.5 * np.pi * 1.006 * 0.2 * 0.211


@pytest.mark.parametrize(
    ("room", "real"),
    [(1e-6, True), (1e-12, True), (-1e-14, True), (-1e-11, False), (-1e-8, False), (-1e-4, False)],
)
def test_pure_sliding_a_little_beyond_the_walls_is_none(room, real):
    """It turns at w = -+ sqrt(C^2 - H^2); the simulation that hits a wall so slowly still stays within a millionth."""
    orbit = MACHINE.orbit("tt", 1, amplitude=float(np.hypot(1.0 - room, H)))
    problem = orbit.problem()
    assert followed(Grown(problem, *orbit.seed(problem), None).orbit()) is real
    assert orbit.real is real


@pytest.mark.parametrize(("room", "real"), [(1e-9, True), (-1e-14, True), (-1e-11, False), (-1e-9, False)])
def test_orbit_branch_and_border_agree_on_what_is_real(room, real):
    """At a border a margin is zero to rounding, and the orbit counts as real; beyond it nothing does."""
    orbit = MACHINE.orbit("tt", 1, amplitude=float(np.hypot(1.0 - room, H)))
    assert orbit.margin == pytest.approx(room, abs=1e-13) and orbit.real is real
    assert orbit.real is (orbit.margin >= 0.0) is all(margin.value >= 0.0 for margin in orbit.margins)
    options = {"over": "amplitude", "within": (0.9, 1.1), "depth": 0}
    if not real:
        with pytest.raises(ValueError, match="beyond a border"):
            cv.diagram(orbit, **options)
    graph = cv.diagram(orbit, **options, virtual=True)
    branch = graph["B1"]
    assert branch.real is real
    assert (
        graph["WG1"].real
        and graph["WG1"].orbit.real
        and graph["WG1"].orbit.margin == pytest.approx(0.0, abs=1e-14)
    )
    assert all(branch.orbit(i).real is real for i in range(1, len(branch) - 1))


def test_what_does_not_come_near_a_border_says_nothing_about_it():
    """Solutions with the new word lay far from the border; the doubled motion that leaves there was taken for impossible (simulation follows it)."""
    machine = Cavity(
        restitution_left=0.08292846201663458,
        restitution_right=0.5784702071020484,
        friction_left=0.0,
        friction_right=0.0,
        gravity=0.46012986147542956,
        slope=-0.13053441728369253,
        distance_left=0.9764767238173357,
        distance_right=0.7522464460157717,
        mass_ratio=0.006,
    )
    nodes = [[0.45939839848482694, 0.20170061511834067], [6.969023212546848, 0.17645388394360836]]
    start = machine.orbit("LL", 2, nodes, amplitude=0.19169698203192065)
    graph = cv.diagram(start, over="amplitude", within=(0.17, 0.3), depth=2)
    # from the motion with five events one with two rounds leaves, six events in the other one
    doubled = next(
        b
        for link in graph.switches
        if len((b := graph[link.target].orbit(5)).word) == 11 and len(graph[link.source].orbit(5).word) == 5
    )
    assert doubled.real and doubled.replay() < 1e-7
