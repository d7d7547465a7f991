"""Atlas, look, basins and merging for the absorber: two worlds, one graph."""

import numpy as np
import pytest

import contvines as cv
from contvines.coexistence.census import look, missing_text
from orbits.attractors import find_attractor
from tests.machines import ABSORBER

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def graph():
    return cv.atlas(ABSORBER, over="amplitude", within=(1.0, 1.3), values=5, starts=96, depth=1)


def test_the_orbit_that_no_diagram_has_is_on_the_atlas(graph):
    """`LRtR` attracts from 1.146 to 1.27 and hangs together with no other branch: a simulation of its own finds it."""
    words = {a.word for a in graph.attractors if a.kind == "periodic"}
    found = find_attractor(ABSORBER, {"phase": 0.0, "w": 0.3, "w_rate": 1.9}, amplitude=1.2)
    orbit = found.orbit
    problem = orbit.problem("amplitude")
    u, p = orbit.seed(problem)
    form = problem.canonical(u, p)
    on = [
        b
        for b in graph
        if b.range[0] <= 1.2 <= b.range[1] and b.problem.canonical(b.points[0], b.values[0])[0] == form[0]
    ]
    assert on and any(b.description["word"] in words for b in on)


def test_every_periodic_attractor_lies_on_a_stable_real_branch(graph):
    for a in graph.attractors:
        if a.kind in ("periodic", "sliding", "stuck"):
            branch = graph[a.branch]
            assert branch.real
            assert any(low - 1e-9 <= a.value <= high + 1e-9 for low, high in branch.stable_intervals())
    for value in {a.value for a in graph.attractors if a.starts}:
        assert sum(a.share for a in graph.attractors if a.value == value and a.starts) == pytest.approx(1.0)


def test_shares_agree_with_a_count_one_by_one():
    """40 of the drawn starts are simulated alone by `find_attractor`: the same motions, the same counts."""
    population = ABSORBER.population("amplitude")
    starts = population.starts(40, 3, 1.1)
    motions, index, _ = population.settle(starts, 1.1)
    alone = []
    for phase, w, rate in starts:
        found = find_attractor(ABSORBER, {"phase": phase, "w": w, "w_rate": rate}, amplitude=1.1)
        alone.append((found.kind, found.periods, found.impacts))
    mine = [(motions[k].kind, motions[k].periods, motions[k].problem.word.impacts) for k in index]
    assert mine == alone


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
            assert np.array_equal(one.points, two.points) and np.array_equal(one.values, two.values)
            assert np.array_equal(one.multipliers, two.multipliers, equal_nan=True)


def test_mirror_twins_are_one_motion_with_two_shares():
    population = ABSORBER.population("amplitude")
    starts = population.starts(400, 0, 0.8)
    motions, index, mirrored = population.settle(starts, 0.8)
    twins = next(k for k, m in enumerate(motions) if m.word == "LR" and not m.problem.symmetric)
    share = mirrored[index == twins].mean()
    assert 0.4 < share < 0.6  # by symmetry of the box of starts
    image = starts.copy()  # the mirror image of every start reaches the mirror image of the motion
    image[:, 0] = (starts[:, 0] + np.pi) % (2 * np.pi)
    image[:, 1:] *= -1.0
    again, other, flipped = population.settle(image, 0.8)
    place = next(k for k, m in enumerate(again) if m.word == "LR" and not m.problem.symmetric)
    assert np.array_equal(other == place, index == twins)
    both = index == twins
    assert len(set(zip(mirrored[both], flipped[both], strict=True))) == 2


def test_the_look_says_what_a_diagram_lacks():
    seed = ABSORBER.symmetric_orbit(0.6)
    graph = cv.diagram(seed, over="amplitude", within=(0.5, 1.3), depth=3)
    found = look(graph, ABSORBER.population("amplitude"))
    assert any(a.value > 1.1 for a in found)
    assert "contvines atlas x.toml" in missing_text(graph, "x.toml")
    assert graph.to_dict()["missing"][0]["share"] > 0


def test_graphs_are_merged_without_doubles(graph):
    seed = ABSORBER.symmetric_orbit(1.1, stable=True)
    one = cv.diagram(seed, over="amplitude", within=(1.0, 1.3), depth=0, virtual=False)
    two = cv.atlas(ABSORBER, over="amplitude", within=(1.0, 1.3), values=[1.2], starts=16, depth=0)
    before = len(one.branches)
    called = one.merge(two)
    assert len(one.branches) > before and set(called.values()) <= {*one.branches, *one.special}
    count = len(one.branches)
    one.merge(two)
    assert len(one.branches) == count
    assert all(label in one.special for b in one for _, label in b.marks)
    with pytest.raises(ValueError, match="two machines"):
        one.merge(
            cv.atlas(
                ABSORBER.changed(friction=0.4),
                over="amplitude",
                within=(1.1, 1.2),
                values=1,
                starts=4,
                depth=0,
            )
        )


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
            ends = [(0, there.endings[0]), (len(there) - 1, there.endings[1])]
            for i, ending in ends:
                assert ending.point is None or one[ending.point].value == pytest.approx(there.values[i])


def test_the_look_says_that_chaos_has_no_branch():
    """Of the Chebyshev map mu x (1 - x), mu = 4, every cycle is unstable; near it windows are narrower than what the look meets."""
    logistic = cv.MapProblem(lambda x, mu: mu * x * (1 - x), [0.7], 3.98, parameter="mu")
    graph = cv.diagram(logistic, within=(3.97, 4.0), depth=0)
    look(graph, logistic.population())
    assert "chaotic" in missing_text(graph, "x.toml") and "no branch can hold" in missing_text(
        graph, "x.toml"
    )
