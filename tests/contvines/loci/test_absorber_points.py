"""The points of codimension two of the reduced absorber's charts: solved anew in many digits."""

import numpy as np
import pytest

import contvines as cv
from tools.fuzz.many_digits import exact

pytestmark = pytest.mark.slow

SPANS = {"friction": (0.3, 0.9), "restitution": (0.55, 0.95)}


@pytest.fixture(scope="module", params=SPANS)
def chart(request, absorber):
    return cv.chart(absorber, over=request.param, within=SPANS[request.param], regions=False)


def test_all_points_in_many_digits(chart):
    """All of them are borders at which a motion touches a wall: with a turn, where a multiplier is -1, or an impact without speed, where none is finite."""
    kinds = [point.kind for point in chart.points.values()]
    assert set(kinds) == {"border-flip", "border-fold"} and len(kinds) >= 6
    # a fold and a flip leave a grazing motion at one point, where the square root of the graze has no effect a period later
    flips = np.array([point.value for point in chart.of_kind("border-flip")])
    for point in chart.of_kind("border-fold"):
        assert np.abs(flips - point.value).max(axis=1).min() < 1e-11
    for point in chart.points.values():
        (touching,) = {j // 4 for j in point.margins}
        found, event = exact(point.orbit), point.problem.word.events[touching]
        assert abs(found.shift) < 1e-13 and found.moved < 1e-13
        phase, second = map(float, found.nodes[touching])
        if event == "t":
            assert abs(second) == pytest.approx(1.0, abs=1e-13)
            assert np.abs(found.multipliers + 1.0).min() < 1e-9
            lines = [chart[label] for label in point.on]
            own = [line for line in lines if line.problem.base.periods == point.problem.periods]
            sides = [
                sum(abs(p - point.value[0]) < 0.03 for line in own for p in line.at(point.value[1] + off))
                for off in (-0.01, 0.01)
            ]
            assert sorted(sides) == [1, 2]  # the doubling is there on one side of the graze only
        else:  # a margin of the flight before the impact; B+ is the cavity's velocity C cos Psi
            assert point.problem.margin_kind(point.margins[0]) == "wall-graze"
            assert second == pytest.approx(point.value[0] * np.cos(phase), abs=1e-7)
