"""The same of places where equations are so nearly singular that doubles tell nothing: eighty digits say what is true."""

import numpy as np
import pytest

from tests.orbits.fuzz.test_found import diagram
from tools.fuzz.approached import comes_to, grow_without_bound
from tools.fuzz.between import Between
from tools.fuzz.many_digits import exact, rounds_apart

pytestmark = pytest.mark.slow


@pytest.mark.parametrize(
    ("seed", "value"),
    [
        (336, 1.577211931470169),
        (396, 2.361212379735297),
    ],
)
def test_a_branch_comes_home_though_steps_would_end_beside_the_doubling(seed, value):
    """Within 1e-5 of it tangents are rounding: a fold was told, and a branch went on as its own image. In eighty digits neither is there.

    At which depth the branch that comes home is met depends on the last bit of the start: four levels hold it either way.
    """
    graph = diagram("cavity", seed, 418, depth=4)
    near = [point for point in graph.special.values() if abs(point.value - value) < 1e-10]
    assert [point.kind for point in near] == ["period-doubling"]
    home = [
        (branch, i)
        for branch in graph
        for i, label in branch.marks
        if label == near[0].label
        and i in (0, len(branch) - 1)
        and branch.problem.periods > near[0].orbit.periods
    ]
    assert len(home) == 1
    branch, end = home[0]
    root = exact(branch.orbit(end).root())
    assert abs(root.shift) < 1e-10
    assert np.abs(root.multipliers + 1.0).min() < 1e-3
    inside = exact(branch.orbit(1 if end == 0 else end - 1))
    assert np.abs(inside.multipliers).max() < 1.0


@pytest.mark.parametrize(
    ("seed", "value", "word"),
    [(184, 0.6768722538612, "LsRLtLttRLtLt"), (25, 1.740995538624, "LRtRsLRtRs")],
)
def test_a_virtual_branch_comes_to_its_point_as_well_as_that_is_known(seed, value, word):
    """Times run backwards until where rounding, over a speed that vanishes, is all that doubles tell; in eighty digits it comes there.

    At the first place two durations vanish: 0.6768722538612062, in eighty digits from either side. Doubles know it to some 2e-9, and by the
    last bit the second one is a point of its own or is taken for the border of the real branch at the same place.
    """
    graph = diagram("cavity", seed, {184: 418, 25: 419}[seed])
    branch, i = next(
        (b, i)
        for b in graph
        if b.description["word"] == word and not b.real
        for i, label in b.marks
        if abs(graph[label].value - value) < 5e-9
    )
    between, backwards = Between(branch, graph.within), []
    for way in between.ways(i):
        (_, one), (_, nearer) = between.beside(i, way, (0.1, 0.01))
        backwards.append(nearer.durations.min() < 0.0)
        assert comes_to(one, nearer, branch.orbit(i), 2e-9)
    assert any(backwards)


def test_multipliers_grow_at_a_graze_whose_place_is_lost_in_rounding():
    """Branches 6e-12 and 1e-13 long in the parameter: one bit of it moves the speed that vanishes by 1e-10, and more."""
    graph = diagram("cavity", 297, 418)
    for value in (0.8372716190982984, 0.8371164114486932):
        point = next(
            p
            for p in graph.of_kind("wall-graze")
            if abs(p.value - value) < 1e-12 and np.ptp(graph[p.branch].values) < 1e-11
        )
        branch = graph[point.branch]
        i = next(i for i, label in branch.marks if label == point.label)
        between = Between(branch, graph.within)
        (way,) = between.ways(i)
        (_, one), (_, nearer) = between.beside(i, way, (1e-3, 1e-4))
        assert grow_without_bound(one, nearer, point.location_error)
        before = exact(next(orbit for _, orbit in between.beside(i, way, (0.3,)))).multipliers.real
        assert branch.multipliers[i][0].real * before[np.abs(before).argmax()] > 1e14


def test_a_branch_that_comes_home_to_a_repeated_motion_leads_to_the_shortest_one():
    """Four rounds, each with a stick that vanishes there: home are not two rounds, which rounding tells apart, but one."""
    graph = diagram("cavity", 165, 419)
    home = [b for b in graph if b.description["word"] in ("LsR", "LsRLsR") and not b.real]
    assert home
    for branch in home:
        middle = branch.orbit(len(branch) // 2)
        shorter = [k for k in range(1, middle.periods) if middle.periods % k == 0]
        assert all(not rounds_apart(middle, k) < 1e-30 for k in shorter)
