"""A machine whose mirror image is lost where one of its parameters, a slope, leaves zero: the built-in cavity, declared on a page."""

import numpy as np
import pytest

import contvines as cv
from orbits import Cavity, DryFriction, Machine, Wall
from orbits.symbols import cos, sin

VALUES = {"restitution": 0.76, "friction": 0.3, "gravity": 0.211, "mass_ratio": 0.006}


def motion(state, phase, p, contact):
    w, s = state
    fall = (1 + p.mass_ratio) * p.gravity * sin(p.slope)
    return s, -p.amplitude * p.frequency**2 * sin(phase) - fall + contact.floor


def limit(state, phase, p):
    return (1 + p.mass_ratio) * p.friction * p.gravity * cos(p.slope)


def wall(letter, side):
    return Wall(letter, lambda state, phase, p: 1 - side * state.w, {"s": -side}, "restitution")


MACHINE = Machine(
    name="slope_page",
    states=("w", "s"),
    parameters={"amplitude": 0.72, **VALUES, "frequency": 1.0, "slope": 0.0},
    phase_rate="frequency",
    motion=motion,
    contacts=[wall("L", 1), wall("R", -1), DryFriction("floor", lambda state, phase, p: state.s, limit)],
    mirror={"L": "R"},
)


@pytest.fixture(scope="module")
def symmetric():
    return MACHINE.orbit("LR", amplitude=0.7)


def test_along_the_slope_there_are_no_symmetric_orbits(symmetric):
    """The branch through the level machine's symmetric orbit is that of the built-in cavity, and simulation follows it."""
    assert symmetric.symmetric and symmetric.problem("amplitude").symmetric
    (branch,) = cv.diagram(symmetric, over="slope", within=(-0.05, 0.05), depth=0)
    for i in (0, len(branch) - 1):
        orbit = branch.orbit(i)
        own = Cavity(**VALUES, slope=float(branch.values[i])).orbit("LR", amplitude=0.7)
        assert sorted(np.abs(orbit.multipliers)) == pytest.approx(sorted(np.abs(own.multipliers)), abs=1e-9)
        assert orbit.replay() < 1e-9


def test_a_symmetric_problem_along_the_slope_is_refused(symmetric):
    with pytest.raises(ValueError, match="no mirror image along slope"):
        symmetric.problem("slope", symmetric=True)
    graph = cv.diagram(symmetric, over="amplitude", within=(0.6, 0.8), depth=0)
    with pytest.raises(ValueError, match="no mirror image along slope"):
        cv.locus(graph["SB1"], over="slope", within=(-0.1, 0.1))


def test_on_a_slope_no_orbit_has_a_mirror_image():
    orbit = MACHINE.attractor({"w": 0.1, "s": 0.3}, amplitude=0.7, slope=0.03).orbit
    assert not orbit.symmetric
    with pytest.raises(ValueError, match="no mirror symmetry with these parameters"):
        orbit.mirror()
