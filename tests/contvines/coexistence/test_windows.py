"""Unstable cycles in chaos lead to the windows beside it, however narrow these are."""

import numpy as np
import pytest

import contvines as cv
from orbits.attractors import find_attractor
from tests.contvines.loci.systems import henon_of
from tests.machines import ABSORBER
from tools.attractors.isolas import window

pytestmark = pytest.mark.slow


def test_the_cycles_in_henon_s_attractor_are_as_many_as_are_published():
    """For a = 1.4, b = 0.3: 1, 1, 0, 1, 0, 2 cycles of 1 to 6 points (O. Biham, W. Wenzel, Phys. Rev. Lett. 63 (1989) 819)."""
    population = cv.MapProblem(henon_of, [0.6, 0.2], 1.0).population(box=[(-2.0, 2.0), (-2.0, 2.0)])
    cycles = [u.reshape(-1, 2) for _, u in population.embedded(np.array([0.1, 0.1]), 1.4)]
    assert [sum(len(points) == n for points in cycles) for n in range(1, 7)] == [1, 1, 0, 1, 0, 2]
    for points in cycles:
        images = np.array([henon_of(x, 1.4) for x in points])
        assert np.abs(images - np.roll(points, -1, axis=0)).max() < 1e-7


def test_one_chaotic_value_leads_to_windows_that_no_start_meets():
    """All starts are at 3.97; the windows are 0.013, 0.0007, 0.003, 0.0005 and 0.00008 wide; where each begins is solved apart."""
    population = cv.MapProblem(lambda x, p: p * x * (1 - x), [0.6], 3.5).population(box=[(0.01, 0.99)])
    graph = cv.atlas(population, within=(3.7, 4.0), values=[3.97], starts=16, depth=0, scan=1)
    folds = np.array([point.value for point in graph.of_kind("fold")])
    begun = np.array([low for branch in graph if branch.real for low, _ in branch.stable_intervals()])
    for period, near, x in (
        (3, 3.8284, 0.514),
        (4, 3.9601, 0.505),
        (5, 3.7382, 0.504),
        (5, 3.9056, 0.502),
        (6, 3.9375, 0.502),
    ):
        for edge in window(period, near, x).folds:
            assert np.abs(folds - edge).min() < 1e-9 and np.abs(begun - edge).min() < 1e-9


@pytest.mark.parametrize(("friction", "amplitude"), [(0.5, 1.1441666666666668), (0.05, 1.0341666666666667)])
def test_unstable_cycles_in_an_absorber_s_chaos_return(friction, amplitude):
    """Each is followed by the event-driven simulation for one cycle, which knows no equation of theirs, and comes back."""
    population = ABSORBER.changed(friction=friction).population("amplitude")
    motions, _, _ = population.settle(population.starts(64, 0, amplitude), amplitude)
    (chaotic,) = [motion for motion in motions if motion.kind == "chaotic"]
    cycles = population.embedded(chaotic.state, amplitude)
    assert len(cycles) > 1
    forms = [problem.canonical(u, amplitude) for problem, u in cycles]
    assert len({(key, tuple(np.round(vector, 6))) for key, vector in forms}) == len(forms)
    for problem, u in cycles:
        orbit = problem.orbit(u, amplitude)
        assert np.abs(orbit.multipliers).max() > 1.0
        assert orbit.replay() < 1e-7


def test_a_motion_that_hardly_any_start_meets_is_reached_from_afar():
    """Ten impacts in five periods, reached at 0.979167 by 3 of 2000 starts of `witness.c`; the starts are at 1.02 only."""
    machine, value = ABSORBER.changed(friction=0.05), 0.9791666666666667
    graph = cv.atlas(machine, over="amplitude", within=(0.95, 1.08), values=[1.02], starts=8, depth=0, scan=1)
    (rare,) = [
        branch
        for branch in graph
        if branch.real
        and branch.description["periods"] == 5
        and any(low <= value <= high for low, high in branch.stable_intervals())
    ]
    assert sum(letter in "LR" for letter in rare.description["word"]) == 10
    # an impact of it as the witness tells it: phase, and the wall's velocity less the absorber's
    phase, b = 1.66616698745339, -0.993345694857384
    start = {"phase": phase, "w": -1.0, "w_rate": value * np.cos(phase) - b}
    found = find_attractor(machine, start, amplitude=value)
    assert (found.kind, found.periods, found.impacts) == ("periodic", 5, 10)
    assert found.orbit.root().word.canonical() == rare.problem.word.canonical()
