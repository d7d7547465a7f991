"""The points of codimension two of the reduced absorber's charts: solved anew in many digits, and looked at by simulation from all sides."""

import numpy as np
import pytest

import contvines as cv
from orbits.attractors import find_attractor
from tests.machines import ABSORBER
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
        else:  # a margin of the flight before the impact; B+ is the cavity's velocity C cos Psi
            assert point.problem.margin_kind(point.margins[0]) == "wall-graze"
            assert second == pytest.approx(point.value[0] * np.cos(phase), abs=1e-7)


def test_what_simulation_finds_on_all_sides_of_the_meetings(chart):
    """Where a doubling ends on a graze: below both lines the motion itself is settled on, beyond either of them it is not."""
    over, looked_at = chart.parameters[1], 0
    for point in chart.of_kind("border-flip"):
        problem = point.problem
        if problem.word.events[point.margins[0] // 4] in "LR":
            continue
        lines = [
            line for line in map(chart.__getitem__, point.on) if line.problem.base.periods == problem.periods
        ]
        (graze,) = [line for line in lines if line.kind == "wall-graze"]

        def settles(amplitude, value, graze=graze, problem=problem):
            machine = ABSORBER.changed(**{over: value})
            near = graze.orbit(int(np.argmin(np.abs(graze.branch.values - value))))
            phase, w = near.nodes[near.word.events.index("t")]
            for shift in (0.0, 1e-3, -1e-3):
                start = {"phase": phase, "w": w + shift}
                motion = find_attractor(machine, start, amplitude=amplitude, max_period=8)
                if motion.word is not None and motion.word.canonical() == problem.word.canonical():
                    return motion.periods == problem.periods
            return False

        sides = []
        for value in (point.value[1] - 0.01, point.value[1] + 0.01):
            places = sorted(p for line in lines for p in line.at(value) if abs(p - point.value[0]) < 0.03)
            gap = places[-1] - places[0] if len(places) == 2 else 0.003
            assert settles(places[0] - 0.5 * gap, value)
            assert not any(settles(p + 0.5 * gap, value) for p in places)
            sides.append(len(places))
        assert sorted(sides) == [1, 2]  # the doubling is there on one side only
        looked_at += 1
    assert looked_at >= 2
