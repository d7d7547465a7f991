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
THREE = {"fold": "1.0037342178", "period-doubling": "1.4125623672", "velocity-graze": "1.9824794254"}
FOUR = {"fold": "2.4791282575", "symmetry-breaking": "3.0980096865", "velocity-graze": "5.0515380711"}


@pytest.fixture(scope="module")
def three():
    found = find_attractor(ABSORBER, {"w_rate": 0.2}, amplitude=1.2)
    assert (found.impacts, found.periods, found.word.canonical().text) == (3, 1, "LRLt")
    return cv.diagram(found.orbit, over="amplitude", within=(0.2, 3.5), depth=1)


@pytest.fixture(scope="module")
def four():
    found = find_attractor(ABSORBER, {"w_rate": 1.0}, amplitude=2.6)
    assert (found.impacts, found.periods, found.symmetric) == (4, 1, True)
    return cv.diagram(found.orbit, over="amplitude", within=(0.2, 8.0), depth=1)


def points_of(graph, label="B1"):
    return {p.kind: p for p in graph.special.values() if p.branch == label and p.real}


def test_window_of_three_impacts(three):
    """From a fold to a velocity graze; stable up to the doubling. All but the graze bound what a simulation finds."""
    points = points_of(three)
    for kind, value in THREE.items():
        assert points[kind].value == pytest.approx(float(value), abs=1e-9)
        assert points[kind].replay < 1e-8
    branch = three["B1"]
    assert branch.range == pytest.approx((points["fold"].value, points["velocity-graze"].value), abs=1e-14)
    assert branch.stable_intervals() == [
        pytest.approx((points["fold"].value, points["period-doubling"].value), abs=1e-12)
    ]
    # the unstable half goes from the fold to the graze of a wall, where one of the three impacts vanishes
    assert points["wall-graze"].value == pytest.approx(1.314658555, abs=1e-9)
    impacts = points["wall-graze"].orbit.events.rate_post[
        [letter in "LR" for letter in points["wall-graze"].orbit.word.events]
    ]
    assert np.abs(impacts).min() < 1e-10


def test_window_of_four_impacts(four):
    """Symmetric, two impacts at each wall: from a fold to a velocity graze in both long flights at once."""
    points = points_of(four)
    for kind, value in FOUR.items():
        assert points[kind].value == pytest.approx(float(value), abs=1e-9)
        assert points[kind].replay < 1e-8
    branch = four["B1"]
    assert branch.range == pytest.approx((points["fold"].value, points["velocity-graze"].value), abs=1e-14)
    assert branch.stable_intervals() == [
        pytest.approx((points["fold"].value, points["symmetry-breaking"].value), abs=1e-12)
    ]
    # the unstable half ends where an impact becomes a turn; there both P_2^1 with turns and P_3^1 begin
    graze = points["wall-graze"]
    words = [four[s.target].description for s in four.switches if s.point == graze.label]
    assert sorted(word["impacts"] for word in words) == [2, 3]


def test_ends_of_the_windows_in_eighty_digits(three, four):
    for graph in (three, four):
        for kind, point in points_of(graph).items():
            if kind in ("fold", "period-doubling", "symmetry-breaking"):
                there = exact(point.orbit)
                assert abs(there.shift) < 1e-12
                assert np.abs(there.multipliers - (-1.0 if kind == "period-doubling" else 1.0)).min() < 1e-7
