"""Many starts of declared machines: against the built-in machine's, and against a bouncing ball written out here."""

import numpy as np
import pytest
from scipy.optimize import brentq

from orbits import Word
from orbits.flows.page.stepper import Stepper
from orbits.flows.page.variations import growth
from tests.machines import ABSORBER
from tools.pages.pages import page

pytestmark = pytest.mark.slow


def spelled(text):
    """One spelling for one motion; a page's own begins anywhere."""
    return Word.parse(text).spelled() if text else text


@pytest.mark.parametrize("amplitude", [0.55, 1.2])
def test_the_declared_absorber_sorts_the_starts_of_the_built_in_one(amplitude):
    own = ABSORBER.population("amplitude")
    declared = page("absorber").population("amplitude")
    starts = own.starts(24, 3, amplitude)
    ours, index, sides = own.settle(starts, amplitude)
    theirs, image, mirrored = declared.settle(starts, amplitude)
    assert [spelled(ours[k].word) for k in index] == [spelled(theirs[k].word) for k in image]
    assert [ours[k].periods for k in index] == [theirs[k].periods for k in image]
    for k in range(len(ours)):  # twins: the same split, whichever was found first
        members = index == k
        if ours[k].word and not np.array_equal(sides[members], mirrored[members]):
            assert np.array_equal(sides[members], ~mirrored[members])
    for motion in theirs:
        problem, u = motion.problem, motion.u
        assert problem.parameter == "amplitude"
        assert problem.data is not None and np.all(np.isfinite(u))


def bounce(t, speed, amplitude, gravity, restitution):
    """Instant and speed just after the next impact on the table A cos t."""

    def gap(d):
        return amplitude * (np.cos(t) - np.cos(t + d)) + speed * d - 0.5 * gravity * d * d

    grid = np.linspace(1e-6, 150.0, 15_000)
    k = np.argmax(gap(grid) < 0.0)
    d = brentq(gap, grid[k - 1], grid[k], xtol=1e-13)
    table = -amplitude * np.sin(t + d)
    return np.array([t + d, table - restitution * (speed - gravity * d - table)])


def test_the_exponent_of_a_chaotic_bouncing_ball():
    """Growth per period of a small difference of two motions, made small again at every impact."""
    numbers = {"amplitude": 0.2, "gravity": 0.1, "restitution": 0.8}
    machine = page("bouncing_ball")
    stepper = Stepper(machine, machine.vector(numbers | {"frequency": 1.0}))
    stepper.start(np.array([3.0, 0.0]), 0.3)
    value, error = growth(stepper)
    at, beside, total = np.array([0.3, 0.5]), np.array([1e-7, 1e-7]), 0.0
    while at[0] < 800 * np.pi:
        image = bounce(*at, *numbers.values())
        ahead = bounce(*(at + beside), *numbers.values()) - image
        size = np.linalg.norm(ahead) / 1e-7
        at, beside, total = image, ahead / size, total + np.log(size)
    expected = total / 400
    assert value > 5 * error > 0.0
    assert abs(value - expected) < 5 * error + 0.03  # the written-out one scatters, too


@pytest.mark.parametrize("way", ["in the chaos", "by Newton's method"])
def test_cycles_of_a_bouncing_ball_are_those_of_the_closed_form(way):
    """One impact in k periods: the table moves with k pi g (1 - r) / (1 + r) there (P. J. Holmes, J. Sound Vib. 84 (1982) 173)."""
    gravity, restitution, amplitude = 0.1, 0.8, 0.2
    population = page("bouncing_ball").population("amplitude", gravity=gravity, restitution=restitution)
    if way == "in the chaos":
        cycles = population.embedded(np.array([0.3, 3.0, 0.0]), amplitude)
    else:
        cycles = population.returning(population.starts(8, 0, amplitude), amplitude)
    assert len(cycles) > 1
    alone = []
    for problem, u in cycles:
        orbit = problem.orbit(u, amplitude)
        assert orbit.replay() < 1e-7
        if len(orbit.word) == 1:
            phase = orbit.nodes[0, 0]
            speed = -amplitude * np.sin(phase)
            assert speed == pytest.approx(
                orbit.periods * np.pi * gravity * (1 - restitution) / (1 + restitution), abs=1e-9
            )
            alone.append(orbit)
    assert alone
