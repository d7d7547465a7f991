"""Diagrams that begin at a special point of another diagram: equations for the unknowns alone are singular there, and margins are zero."""

import numpy as np
import pytest

import contvines as cv
from tests.contvines.loci.systems import cusp
from tests.machines import ABSORBER, absorber_graph


@pytest.fixture(scope="module")
def graph():
    return absorber_graph(0.55, (0.17, 1.2), depth=2)


@pytest.mark.slow
@pytest.mark.parametrize("over", ["amplitude", "friction"])
def test_begun_at_each_special_point_of_an_absorber(graph, over):
    borders = {"wall-graze", "velocity-graze", "stick", "vanishing-event"}
    points = [point for point in graph.special.values() if point.kind != "end"]
    assert {point.kind for point in points} >= {"fold", "symmetry-breaking", "period-doubling", "wall-graze"}
    for point in points:
        start, reach = (point.value, 0.03) if over == "amplitude" else (ABSORBER.friction, 0.02)
        begun = cv.diagram(point.orbit, over=over, within=(start - reach, start + reach), depth=0)
        kinds = borders if point.kind in borders else {point.kind}
        found = [p.value for p in begun.special.values() if p.kind in kinds]
        assert min(abs(np.array(found) - start), default=1.0) < 1e-7, point.label


def values(graph, kind):
    return [point.value for point in graph.of_kind(kind)]


# 1e-13 off, where a Newton step at fixed p is as long as rounding has it
@pytest.mark.parametrize("off", np.linspace(-1e-13, 1e-13, 9))
def test_begun_at_a_fold_from_which_newtons_method_leads_to_a_solution_far_away(off):
    """p = 2 x^3 - 3 x^2 has a fold at (1, -1), and at p = -1 the solution x = -1/2, too."""
    problem = cv.AlgebraicProblem(lambda x, p: 2.0 * x**3 - 3.0 * x**2 - p, [1.0 + off], -1.0)
    graph = cv.diagram(problem, within=(-1.5, -0.5))
    assert values(graph, "fold") == pytest.approx([-1.0], abs=1e-12)
    assert graph["B1"].points[:, 0].min() > 0.4


def test_begun_at_special_points_against_another_parameter():
    """x' = r + q x - s x^2 folds at r = -q^2 / (4 s)."""
    flow = cv.FlowProblem(
        lambda x, p: [p.r + p.q * x[0] - p.s * x[0] ** 2], [1.0], {"r": 1.0, "s": 1.0, "q": 1.0}
    )
    (fold,) = cv.diagram(flow, over="r", within=(-1.0, 2.0)).of_kind("fold")
    assert fold.value == pytest.approx(-0.25, abs=1e-12)
    assert values(cv.diagram(fold, within=(-1.0, 2.0)), "fold") == pytest.approx([-0.25], abs=1e-12)
    other = cv.diagram(fold, over="q", within=(0.5, 1.5))
    assert values(other, "fold") == pytest.approx([1.0], abs=1e-12)
    x, q = other["B1"].points[:, 0], other["B1"].values
    assert -0.25 + q * x - x**2 == pytest.approx(0.0, abs=1e-9)


def rotated(x, p):
    """Multipliers (1 + p) exp(+-i)."""
    c, s = np.cos(1.0), np.sin(1.0)
    return (1.0 + p.p - x @ x) * np.array([c * x[0] - s * x[1], s * x[0] + c * x[1]])


@pytest.mark.parametrize("start", [0.0, 1e-16, -1e-13])
@pytest.mark.parametrize(
    ("kind", "problem", "f", "n"),
    [
        ("neimark-sacker", cv.MapProblem, rotated, 2),
        ("period-doubling", cv.MapProblem, lambda x, q: [-(1 + q.p) * x[0] + x[0] ** 3], 1),
        ("branch-point", cv.MapProblem, lambda x, q: [(1 + q.p) * x[0] - x[0] ** 3], 1),
        ("branch-point", cv.AlgebraicProblem, lambda x, q: q.p * x - x**3, 1),
        ("hopf", cv.FlowProblem, lambda x, q: [q.p * x[0] - x[1], x[0] + q.p * x[1] - x[1] ** 3], 2),
        ("fold", cv.FlowProblem, lambda x, q: [q.p - x[0] ** 2], 1),
    ],
)
def test_begun_where_it_is_known_to_lie(kind, problem, f, n, start):
    graph = cv.diagram(problem(f, [0.0] * n, {"p": start}), within=(-0.2, 0.3), depth=1)
    assert values(graph, kind) == pytest.approx([0.0], abs=1e-12)
    assert not graph.unresolved
    assert len(graph) == (1 if kind in ("fold", "neimark-sacker") else 2)


def test_begun_at_a_cusp_on_a_locus():
    """At a = 1/3, b = 0: against a it is a pitchfork, against b nothing."""
    flow = cv.FlowProblem(cusp, [-1.0], {"b": -0.5, "a": 1.0})
    locus = cv.locus(cv.diagram(flow, over="b", within=(-1, 1))["LP1"], over="a", within=(0, 2))
    point = locus.points["CP1"]
    across, along = cv.diagram(point, over="a", within=(0.0, 1.0)), cv.diagram(point, within=(-0.5, 0.5))
    assert values(across, "branch-point") == pytest.approx([1 / 3], abs=1e-9)
    assert {p.kind for p in along.special.values()} == {"end"} and len(along) == 1
