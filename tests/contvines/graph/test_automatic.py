"""The automatic diagram: order, identity, resume."""

import numpy as np
import pytest

import contvines as cv
from tests.machines import ABSORBER


def logistic(x, r):
    return r * x * (1 - x)


def test_labels_run_along_the_branch():
    problem = cv.AlgebraicProblem(lambda x, p: p + x - x**3, [0.0], 0.0)
    graph = cv.diagram(problem, within=(-1.0, 1.0))
    marks = graph["B1"].marks
    assert [label for _, label in marks] == ["EP1", "LP1", "LP2", "EP2"]
    assert [i for i, _ in marks] == sorted(i for i, _ in marks)
    assert marks[0][0] == 0 and marks[-1][0] == len(graph["B1"]) - 1
    for i, label in marks:
        assert graph["B1"].values[i] == graph[label].value
        np.testing.assert_array_equal(graph["B1"].points[i], graph[label].u)
    # tangents all point forward along the stored order
    steps = np.column_stack([np.diff(graph["B1"].points[:, 0]), np.diff(graph["B1"].values)])
    assert ((steps * graph["B1"].tangents[1:]).sum(axis=1) > 0.0).all()


@pytest.mark.parametrize("turns", [0.0, 1.0, 2.0, 3.0, 4.5])
def test_stable_intervals_of_a_closed_branch_are_in_order_and_not_cut_where_it_begins(turns):
    """u' = -(u^2 + p^2 - 1) (u - w(p)), w = 5 p (2 p^2 - 1) / 6: on the circle its sign of u (u - w) says where it is stable."""

    def f(u, p):
        return -(u[0] ** 2 + p * p - 1.0) * (u[0] - 5.0 * p * (2.0 * p * p - 1.0) / 6.0)

    start = [np.cos(turns)], np.sin(turns)
    graph = cv.diagram(cv.AlgebraicProblem(f, *start, spectrum="flow"), within=(-2.0, 2.0), depth=0)
    branch = graph["B1"]
    assert branch.closed
    angle = np.linspace(0.0, 2.0 * np.pi, 200001)
    u, p = np.cos(angle), np.sin(angle)
    on = u * (u - 5.0 * p * (2.0 * p * p - 1.0) / 6.0) > 0.0
    flips = np.flatnonzero(on[1:] != on[:-1])
    first = flips[int(on[flips[0]])]  # an angle at which a stable arc begins
    places = np.sort((flips - first) % 200000) + first
    arcs = [p[np.arange(a, b + 1) % 200000] for a, b in zip(places[::2], places[1::2], strict=True)]
    exact = sorted((float(arc.min()), float(arc.max())) for arc in arcs)
    assert np.array(branch.stable_intervals()) == pytest.approx(np.array(exact), abs=1e-4)


def test_seed_on_a_known_branch_is_not_traced_again():
    """The circle x^2 + p^2 = 1 and the line x = p: met twice, listed once."""

    def f(u, p):
        return np.array([(u[0] ** 2 + p * p - 1.0) * (u[0] - p)])

    graph = cv.diagram(cv.AlgebraicProblem(f, [1.0], 0.0), within=(-2.0, 2.0), depth=4)
    assert len(graph) == 2 and graph["B1"].closed
    half = np.sqrt(0.5)
    assert sorted(p.value for p in graph.of_kind("branch-point")) == pytest.approx([-half, half], abs=1e-12)
    assert len(graph.switches) == 2


def test_a_cascade_is_followed_where_doublings_lie_closer_than_the_first_step():
    """The logistic map's doublings crowd at r = 3.5699456718709449 (Briggs, Math. Comp. 57 (1991) 435)."""
    problem = cv.MapProblem(logistic, [0.5], 2.5, parameter="r")
    graph = cv.diagram(problem, within=(2.0, 4.0), depth=8)
    found = sorted(point.value for point in graph.of_kind("period-doubling"))
    known = [3.0, 1.0 + np.sqrt(6.0), 3.5440903595519228, 3.5644072660954326, 3.5687594195438266]
    assert found[:5] == pytest.approx(known, abs=1e-12)
    assert len(found) == 9
    a, b, c = found[-3:]
    assert c - (c - b) ** 2 / (c - 2.0 * b + a) == pytest.approx(3.5699456718709449, abs=1e-9)
    assert (b - a) / (c - b) == pytest.approx(4.669201609, abs=1e-2)


@pytest.mark.parametrize("limit, most, traced", [("max_branches", 2, 2), ("max_unknowns", 20, 1)])
def test_the_limit_that_ends_a_diagram_is_said(limit, most, traced):
    problem = cv.MapProblem(logistic, [0.5], 2.5, parameter="r")
    graph = cv.diagram(problem, within=(2.4, 3.55), depth=3, settings={limit: most})
    assert len(graph) == traced and f"{limit} = {most}" in graph.message and not graph.complete
    left = [p for p in graph.special.values() if any(f"{limit} = {most}" in r for r in p.remarks)]
    assert left and not any(s.point == p.label for s in graph.switches for p in left)


def test_switch_extends_a_graph():
    problem = cv.MapProblem(logistic, [0.5], 2.5, parameter="r")
    graph = cv.diagram(problem, within=(2.4, 3.5), depth=0)
    assert cv.switch(graph, "PD1") == ["B2"]
    assert graph["PD2"].value == pytest.approx(1 + np.sqrt(6), abs=1e-12)
    with pytest.warns(UserWarning, match="B2"):
        assert cv.switch(graph, "PD1") == [] and len(graph.switches) == 1
    assert cv.switch(graph, "PD2") == ["B3"]
    with pytest.raises(KeyError, match="PD9"):
        cv.switch(graph, "PD9")


@pytest.mark.parametrize("tolerance", [1e-6, 1e-9, 1e-12])
@pytest.mark.parametrize("angle", [0.02, 0.1, 0.25])
def test_special_points_do_not_depend_on_tolerance_or_step(tolerance, angle):
    problem = cv.MapProblem(logistic, [0.5], 2.5, parameter="r")
    graph = cv.diagram(
        problem,
        within=(2.0, 3.56),
        depth=2,
        settings={"tolerance": tolerance, "angle": angle, "max_step": 0.1},
    )
    found = [p.value for p in graph.of_kind("period-doubling")]
    assert found == pytest.approx([3.0, 1.0 + np.sqrt(6.0), 3.5440903595519228], abs=1e-12)


@pytest.mark.parametrize("word, periods, times", [("LRtt", 1, 2), ("LR", 1, 3), ("LRtt", 1, 4)])
def test_a_repeated_start_gives_the_graph_of_its_root(word, periods, times):
    """P_l^k written twice is P_l^k: the labels, the special points and the stable pieces are those of the word itself."""
    machine = ABSORBER
    root = machine.orbit(word, periods, amplitude=1.0)
    options = {"over": "amplitude", "within": (0.9, 1.1), "depth": 1}
    one, other = cv.diagram(root, **options), cv.diagram(root.repeat(times), **options)
    assert [(b.description["word"], b.description["periods"]) for b in one.branches.values()] == [
        (b.description["word"], b.description["periods"]) for b in other.branches.values()
    ]
    assert one["B1"].description["periods"] == periods
    assert list(one.special) == list(other.special)
    assert [p.value for p in one.special.values()] == pytest.approx(
        [p.value for p in other.special.values()], abs=1e-11
    )
    for label, branch in one.branches.items():
        assert np.allclose(branch.stable_intervals(), other[label].stable_intervals(), atol=1e-11)
