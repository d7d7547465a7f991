"""What counts as an orbit beyond a border: every margin kept, and followed by the simulation."""

import numpy as np
import pytest

import contvines as cv
from orbits import Absorber
from orbits.borders.crossing import _followed

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
    assert _followed(problem, *orbit.seed(problem), orbit) is real
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
