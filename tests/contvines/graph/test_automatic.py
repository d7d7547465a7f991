"""The automatic diagram: order, identity, limits."""

import numpy as np
import pytest

import contvines as cv
from tests.machines import ABSORBER, absorber_graph

DOUBLINGS = [3.0, 1.0 + np.sqrt(6.0), 3.5440903595519228]


def logistic(within, **options):
    problem = cv.MapProblem(lambda x, r: r * x * (1 - x), [0.5], 2.5)
    return cv.diagram(problem, within=within, **options)


@pytest.mark.parametrize("start", [-1.2, 0.0, 1.2])
def test_labels_and_tangents_run_along_the_branch(start):
    """p = u^3 - u, begun before, between and behind its folds at u = -1/sqrt(3) and 1/sqrt(3)."""
    problem = cv.AlgebraicProblem(lambda u, p: u**3 - u - p, [start], start**3 - start)
    graph = cv.diagram(problem, within=(-2.0, 2.0))
    branch = graph["B1"]
    assert [label for _, label in branch.marks] == ["EP1", "LP1", "LP2", "EP2"]
    places = [i for i, _ in branch.marks]
    assert places == sorted(places) and places[::3] == [0, len(branch) - 1]
    whole = np.column_stack([branch.points, branch.values])
    assert ((np.diff(whole, axis=0) * branch.tangents[1:]).sum(axis=1) > 0.0).all()
    for i, label in branch.marks:
        point = graph[label]
        np.testing.assert_array_equal(whole[i], [*point.u, point.value])
        assert point.tangent @ branch.tangents[i] > 0.9 * np.linalg.norm(point.tangent) ** 2
        assert point.kind == "end" or abs(point.u[0]) == pytest.approx(1 / np.sqrt(3))


@pytest.mark.parametrize("end", [0.7, 1.0 / 3.0, 0.9123456789])
def test_the_end_of_the_interval_is_met_exactly_and_nothing_changes_its_sign_there(end):
    """Of u = sin 3p + p^3/5, a branch without special points."""
    problem = cv.AlgebraicProblem(
        lambda u, p: [u[0] - np.sin(3 * p) - p**3 / 5, u[1] - u[0] * p], [0.0, 0.0], 0.0
    )
    graph = cv.diagram(problem, within=(-end, end))
    assert graph["B1"].range == (-end, end)
    assert [point.kind for point in graph.special.values()] == ["end", "end"]


def test_seed_on_a_known_branch_is_not_traced_again():
    """The circle x^2 + p^2 = 1 and the line x = p: met twice, listed once."""
    problem = cv.AlgebraicProblem(lambda u, p: (u**2 + p * p - 1.0) * (u - p), [1.0], 0.0)
    graph = cv.diagram(problem, within=(-2.0, 2.0), depth=4)
    assert len(graph) == 2 and graph["B1"].closed
    half = np.sqrt(0.5)
    assert sorted(p.value for p in graph.of_kind("branch-point")) == pytest.approx([-half, half], abs=1e-12)
    assert len(graph.switches) == 2


def test_a_cascade_is_followed_where_doublings_lie_closer_than_the_first_step():
    """The logistic map's doublings crowd at r = 3.5699456718709449 (Briggs, Math. Comp. 57 (1991) 435)."""
    found = sorted(point.value for point in logistic((2.0, 4.0), depth=8).of_kind("period-doubling"))
    assert len(found) == 9
    a, b, c = found[-3:]
    assert c - (c - b) ** 2 / (c - 2.0 * b + a) == pytest.approx(3.5699456718709449, abs=1e-9)
    assert (b - a) / (c - b) == pytest.approx(4.669201609, abs=1e-2)


@pytest.mark.parametrize("tolerance", [1e-6, 1e-9, 1e-12])
@pytest.mark.parametrize("angle", [0.02, 0.1, 0.25])
def test_special_points_do_not_depend_on_tolerance_or_step(tolerance, angle):
    steps = {"tolerance": tolerance, "angle": angle, "max_step": 0.1}
    found = logistic((2.0, 3.56), depth=2, settings=steps).of_kind("period-doubling")
    assert [p.value for p in found] == pytest.approx(DOUBLINGS, abs=1e-12)


@pytest.mark.parametrize("limit, most, traced", [("max_branches", 2, 2), ("max_unknowns", 20, 1)])
def test_the_limit_that_ends_a_diagram_is_said(limit, most, traced):
    graph = logistic((2.4, 3.55), depth=3, settings={limit: most})
    assert len(graph) == traced and f"{limit} = {most}" in graph.message and not graph.complete
    left = [p for p in graph.special.values() if any(f"{limit} = {most}" in r for r in p.remarks)]
    assert left and not any(s.point == p.label for s in graph.switches for p in left)


def test_switch_extends_a_graph():
    graph = logistic((2.4, 3.5), depth=0)
    assert cv.switch(graph, "PD1") == ["B2"]
    assert graph["PD2"].value == pytest.approx(DOUBLINGS[1], abs=1e-12)
    with pytest.warns(UserWarning, match="B2"):
        assert cv.switch(graph, "PD1") == [] and len(graph.switches) == 1
    assert cv.switch(graph, "PD2") == ["B3"]
    with pytest.raises(KeyError, match="PD9"):
        cv.switch(graph, "PD9")


@pytest.mark.parametrize("word, periods, times", [("LRtt", 1, 2), ("LR", 1, 3), ("LRtt", 1, 4)])
def test_a_repeated_start_gives_the_graph_of_its_root(word, periods, times):
    """P_l^k written twice is P_l^k: the labels, the special points and the stable pieces are those of the word itself."""
    root = ABSORBER.orbit(word, periods, amplitude=1.0)
    one, other = (
        cv.diagram(orbit, over="amplitude", within=(0.9, 1.1), depth=1)
        for orbit in (root, root.repeat(times))
    )
    assert one["B1"].description["periods"] == periods
    assert list(one.special) == list(other.special)
    for label, point in one.special.items():
        assert point.value == pytest.approx(other[label].value, abs=1e-11)
    for branch, twin in zip(one, other, strict=True):
        for name in ("word", "periods"):
            assert branch.description[name] == twin.description[name]
        assert np.allclose(branch.stable_intervals(), twin.stable_intervals(), atol=1e-11)


@pytest.mark.parametrize("upper", [1e4, 1e6])
def test_the_graph_does_not_depend_on_how_wide_an_interval_is_asked_for(upper):
    edge = 1.3
    narrow, wide = (absorber_graph(0.55, (0.2, end), depth=1) for end in (edge, upper))

    def points(graph):
        below = (p for p in graph.special.values() if p.value < edge and p.kind != "end")
        return {(p.kind, round(p.value, 9)) for p in below}

    def words(graph):
        below = (b for b in graph if b.range[0] < edge)
        return {b.problem.canonical(b.points[1], float(b.values[1]))[0] for b in below}

    assert points(narrow) <= points(wide) and words(narrow) <= words(wide)
    assert len(words(narrow)) == 5
    for branch in wide:
        ends = {label for index, label in branch.marks if index in (0, len(branch) - 1)}
        assert branch.closed or len(ends) == 2, branch
        assert len(np.unique(branch.values)) > 2
