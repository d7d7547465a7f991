"""Atlas, look, basins and merging for the absorber: two worlds, one graph."""

import numpy as np
import pytest

import contvines as cv
from contvines.coexistence.census import look, missing_text
from orbits.attractors import find_attractor
from tests.machines import ABSORBER, absorber_graph

pytestmark = pytest.mark.slow


def atlas(within, machine=ABSORBER, **options):
    return cv.atlas(machine, over="amplitude", within=within, **options)


def settled(starts, value):
    """Motions, which of them each start reaches, and whether that is its mirror image."""
    return ABSORBER.population("amplitude").settle(starts, value)


def test_every_periodic_attractor_lies_on_a_stable_real_branch():
    graph = atlas((1.0, 1.3), values=5, starts=96, depth=1)
    for a in graph.attractors:
        if a.kind in ("periodic", "sliding", "stuck"):
            branch = graph[a.branch]
            assert branch.real
            assert any(low - 1e-9 <= a.value <= high + 1e-9 for low, high in branch.stable_intervals())
    for value in {a.value for a in graph.attractors if a.starts}:
        assert sum(a.share for a in graph.attractors if a.value == value and a.starts) == pytest.approx(1.0)


def test_shares_agree_with_a_count_one_by_one():
    """40 of the drawn starts are simulated alone by `find_attractor`: the same motions, the same counts."""
    starts = ABSORBER.population("amplitude").starts(40, 3, 1.1)
    motions, index, _ = settled(starts, 1.1)
    mine = [(motions[k].kind, motions[k].periods, motions[k].problem.word.impacts) for k in index]
    alone = (
        find_attractor(ABSORBER, dict(zip(("phase", "w", "w_rate"), start)), amplitude=1.1)
        for start in starts
    )
    assert mine == [(found.kind, found.periods, found.impacts) for found in alone]


def test_atlases_with_one_seed_are_equal_to_the_last_bit_on_one_core_and_on_two():
    graphs = []
    for workers in (1, 2, 2):
        population = ABSORBER.population("amplitude")
        population.workers = workers
        graphs.append(cv.atlas(population, within=(1.05, 1.15), values=[1.1], starts=1100, depth=0, scan=2))
    first, *others = graphs
    for other in others:
        assert repr(other.attractors) == repr(first.attractors)
        assert list(other.branches) == list(first.branches)
        for one, two in zip(first, other, strict=True):
            for name in ("points", "values", "multipliers"):
                assert np.array_equal(getattr(one, name), getattr(two, name), equal_nan=True)


def test_mirror_twins_are_one_motion_with_two_shares():
    starts = ABSORBER.population("amplitude").starts(400, 0, 0.8)
    image = (starts + [np.pi, 0.0, 0.0]) * [1.0, -1.0, -1.0]
    image[:, 0] %= 2 * np.pi
    seen = []
    for states in (starts, image):
        motions, index, mirrored = settled(states, 0.8)
        twins = next(k for k, m in enumerate(motions) if m.word == "LR" and not m.problem.symmetric)
        seen.append((index == twins, mirrored[index == twins]))
    (both, one), (again, other) = seen
    assert 0.4 < one.mean() < 0.6  # by symmetry of the box of starts
    # the mirror image of every start reaches the mirror image of the motion, whichever of the two is called so
    assert np.array_equal(both, again)
    assert np.array_equal(one, other) or np.array_equal(one, ~other)


def test_the_look_says_what_a_diagram_lacks():
    graph = absorber_graph(0.6, (0.5, 1.3), depth=3)
    found = look(graph, ABSORBER.population("amplitude"))
    assert any(a.value > 1.1 for a in found)
    assert "contvines atlas x.toml" in missing_text(graph, "x.toml")
    assert graph.to_dict()["missing"][0]["share"] > 0


def test_the_look_says_that_chaos_has_no_branch():
    """Of the Chebyshev map mu x (1 - x), mu = 4, every cycle is unstable; near it windows are narrower than what the look meets."""
    logistic = cv.MapProblem(lambda x, mu: mu * x * (1 - x), [0.7], 3.98)
    graph = cv.diagram(logistic, within=(3.97, 4.0), depth=0)
    look(graph, logistic.population())
    told = missing_text(graph, "x.toml")
    assert "chaotic" in told and "no branch can hold" in told


def test_graphs_are_merged_without_doubles():
    seed = ABSORBER.symmetric_orbit(1.1, stable=True)
    one = cv.diagram(seed, over="amplitude", within=(1.0, 1.3), depth=0)
    two = atlas((1.0, 1.3), values=[1.2], starts=16, depth=0)
    before = len(one.branches)
    called = one.merge(two)
    count = len(one.branches)
    assert count > before and set(called.values()) <= {*one.branches, *one.special}
    one.merge(two)
    assert len(one.branches) == count
    assert all(label in one.special for b in one for _, label in b.marks)
    with pytest.raises(ValueError, match="two machines"):
        one.merge(atlas((1.1, 1.2), ABSORBER.changed(friction=0.4), values=1, starts=4, depth=0))


def test_a_merged_branch_ends_at_its_own_points():
    """Both graphs have points of the same labels, at other values of the amplitude."""
    one, two = (
        cv.diagram(ABSORBER.orbit("LR", amplitude=begin), over="amplitude", within=within, depth=1)
        for begin, within in ((0.55, (0.3, 0.7)), (0.6, (0.5, 0.9)))
    )
    called = one.merge(two)
    for branch in two:
        there = one[called[branch.label]]
        if there.label != "B1":
            assert [(i, called[mark]) for i, mark in branch.marks] == list(there.marks)
            for i, ending in zip((0, -1), there.endings):
                assert ending.point is None or one[ending.point].value == pytest.approx(there.values[i])
