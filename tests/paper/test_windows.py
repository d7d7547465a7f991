"""P_3^1 and P_4^1 of the paper's set, found by simulation and continued to both ends of their windows.

The folds, doublings and grazes that bound them are roots of a brute-force return map of 40 digits, stated to ten of them.
"""

import numpy as np
import pytest

import contvines as cv
from orbits.attractors import find_attractor
from tests.machines import ABSORBER
from tools.fuzz.many_digits import exact

pytestmark = pytest.mark.slow

# amplitudes C
THREE = {"fold": 1.0037342178, "period-doubling": 1.4125623672, "velocity-graze": 1.9824794254}
FOUR = {"fold": 2.4791282575, "symmetry-breaking": 3.0980096865, "velocity-graze": 5.0515380711}


@pytest.fixture(scope="module")
def windows():
    """The first orbit of each window with its graph."""
    starts = ((0.2, 1.2, 3.5), (1.0, 2.6, 8.0))
    found = [(find_attractor(ABSORBER, {"w_rate": rate}, amplitude=at), end) for rate, at, end in starts]
    return [(one, cv.diagram(one.orbit, over="amplitude", within=(0.2, end), depth=1)) for one, end in found]


def points_of(graph):
    return {p.kind: p for p in graph.special.values() if p.branch == "B1" and p.real}


def test_the_motions_that_are_found(windows):
    (three, _), (four, _) = windows
    assert (three.impacts, three.periods, three.word.canonical().text) == (3, 1, "LRLt")
    assert (four.impacts, four.periods, four.symmetric) == (4, 1, True)


@pytest.mark.parametrize(("which", "values"), [(0, THREE), (1, FOUR)])
def test_a_window_from_a_fold_to_a_velocity_graze(windows, which, values):
    """Stable up to the doubling or symmetry breaking. All but the graze bound what a simulation finds."""
    graph = windows[which][1]
    points = points_of(graph)
    for kind, value in values.items():
        assert points[kind].value == pytest.approx(value, abs=1e-9)
        assert points[kind].replay < 1e-8
    fold, stable, graze = (points[kind].value for kind in values)
    assert graph["B1"].range == pytest.approx((fold, graze), abs=1e-14)
    assert graph["B1"].stable_intervals() == [pytest.approx((fold, stable), abs=1e-12)]


def test_where_the_unstable_halves_end(windows):
    """At the graze of a wall: one of three impacts vanishes; one of four becomes a turn, where P_2^1 with turns and P_3^1 begin."""
    three, four = (graph for _, graph in windows)
    graze = points_of(three)["wall-graze"]
    assert graze.value == pytest.approx(1.314658555, abs=1e-9)
    impacts = [letter in "LR" for letter in graze.orbit.word.events]
    assert np.abs(graze.orbit.events.rate_post[impacts]).min() < 1e-10
    graze = points_of(four)["wall-graze"]
    words = [four[s.target].description for s in four.switches if s.point == graze.label]
    assert sorted(word["impacts"] for word in words) == [2, 3]


def test_ends_of_the_windows_in_eighty_digits(windows):
    for _, graph in windows:
        for kind, point in points_of(graph).items():
            if kind in ("fold", "period-doubling", "symmetry-breaking"):
                there = exact(point.orbit)
                assert abs(there.shift) < 1e-12
                assert np.abs(there.multipliers - (-1.0 if kind == "period-doubling" else 1.0)).min() < 1e-7
