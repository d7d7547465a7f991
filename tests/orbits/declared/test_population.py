"""Many starts of declared machines: against the built-in machine's, and against a bouncing ball written out here."""

import numpy as np
import pytest

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


def ball_exponent(amplitude, gravity, restitution, periods):
    """Lyapunov exponent per period of y'' = -g over A cos t: hits by bisection, tangents by the variational equations."""
    t, y, v = 0.3, 3.0, 0.0
    tangent, total, end = np.array([1.0, 0.3]), 0.0, t + 2 * np.pi * periods
    table, rate, second = (
        lambda t: amplitude * np.cos(t),
        lambda t: -amplitude * np.sin(t),
        lambda t: -amplitude * np.cos(t),
    )
    while t < end:
        grid = np.linspace(1e-9, 150.0, 15_000)
        gaps = y + v * grid - 0.5 * gravity * grid**2 - table(t + grid)
        low = grid[np.argmax(gaps < 0.0) - 1]
        high = grid[np.argmax(gaps < 0.0)]
        for _ in range(80):
            middle = 0.5 * (low + high)
            if y + v * middle - 0.5 * gravity * middle**2 - table(t + middle) > 0.0:
                low = middle
            else:
                high = middle
        t, y, v = t + low, table(t + low), v - gravity * low
        flight = np.array([[1.0, low], [0.0, 1.0]])
        before = np.array([v, -gravity])
        jump = np.array([[1.0, 0.0], [0.0, -restitution]])
        v = (1 + restitution) * rate(t) - restitution * v
        after = np.array([v, -gravity])
        # saltation: the hit comes earlier or later by dt = -dgap / (gap's rate)
        normal = np.array([1.0, 0.0])
        closing = before[0] - rate(t)
        of_time = np.array([0.0, (1 + restitution) * second(t)])
        saltation = jump + np.outer(after - jump @ before - of_time, normal) / closing
        tangent = saltation @ flight @ tangent
        size = np.linalg.norm(tangent)
        total += np.log(size)
        tangent /= size
    return total / periods


def test_the_exponent_of_a_chaotic_bouncing_ball():
    machine = page("bouncing_ball")
    params = machine.vector({"amplitude": 0.2, "gravity": 0.1, "restitution": 0.8, "frequency": 1.0})
    stepper = Stepper(machine, params)
    stepper.start(np.array([3.0, 0.0]), 0.3)
    value, error = growth(stepper)
    expected = ball_exponent(0.2, 0.1, 0.8, 400)
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
