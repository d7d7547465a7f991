"""What is said of a branch that leaves: sides and steepness from normal forms that can be read off."""

import numpy as np
import pytest

import contvines as cv


def graph_of(function, within=(-1.0, 1.0), start=-0.5, **more):
    return cv.diagram(
        cv.AlgebraicProblem(function, [0.0], start, spectrum="flow", scale=1.0, **more), within=within
    )


def test_a_transcritical_point_on_a_steep_branch_is_said_to_be_one():
    """The known branch u = (100 p, 0) does not turn at p = 0.1, however little the parameter changes along it."""
    problem = cv.AlgebraicProblem(
        lambda u, p: [u[0] - 100.0 * p, u[1] * (u[0] - 10.0 - u[1])], [1.0, 0.0], 0.01
    )
    (point,) = cv.diagram(problem, within=(0.0, 0.3)).of_kind("branch-point")
    assert "transcritical" in point.remarks and point.criticality is None


def test_a_transcritical_point_is_said_to_be_one():
    """u' = p u - u^2: the branches u = 0 and u = p cross, there is no side and no coefficient."""
    (point,) = graph_of(lambda u, p: p * u - u**2).of_kind("branch-point")
    assert "transcritical" in " ".join(point.remarks)
    assert point.criticality is None and point.value == pytest.approx(0.0, abs=1e-10)
    assert 0.0 <= point.location_error < 1e-8 and abs(point.value) <= point.location_error + 1e-14


@pytest.mark.parametrize(("cubic", "kind"), [(-1.0, "supercritical"), (1.0, "subcritical")])
def test_a_pitchfork_is_not(cubic, kind):
    """u' = p u + c u^3."""
    graph = graph_of(lambda u, p: p * u + cubic * u**3)
    (point,) = graph.of_kind("branch-point")
    assert "transcritical" not in " ".join(point.remarks)
    assert point.criticality == kind and point.coefficient == pytest.approx(cubic, rel=1e-4)


@pytest.mark.parametrize("problem", [cv.AlgebraicProblem, cv.MapProblem])
@pytest.mark.parametrize(("linear", "cubic"), [(1.0, -1.0), (1.0, 1.0), (-1.0, 2.0), (-1.0, -2.0)])
def test_a_pitchfork_that_is_met_along_the_branch_that_bends_is_one_too(problem, linear, cubic):
    """u' = a p u + c u^3, or x -> x + a p x + c x^3, begun on a p = -c u^2: c is the coefficient on either branch."""
    u0 = 0.5
    p0 = -cubic / linear * u0**2
    own = {"spectrum": "flow"} if problem is cv.AlgebraicProblem else {}
    shift = 0.0 if own else 1.0
    bent = problem(lambda u, p: shift * u + linear * p * u + cubic * u**3, [u0], p0, **own)
    graph = cv.diagram(bent, within=(-0.9, 0.9))
    (point,) = graph.of_kind("branch-point")
    assert point.branch == "B1" and np.abs(graph["B1"].points).max() > 0.1
    assert "transcritical" not in point.note
    assert point.coefficient == pytest.approx(cubic, rel=1e-6)
    assert point.criticality == ("supercritical" if cubic < 0.0 else "subcritical")


def test_switching_where_nothing_leaves_says_why():
    """x' = p x - y - x r^2, y' = x + p y - y r^2: limit cycles leave the Hopf point at p = 0."""

    def rotor(u, p):
        x, y = u
        r2 = x * x + y * y
        return [p * x - y - x * r2, x + p * y - y * r2]

    graph = cv.diagram(cv.AlgebraicProblem(rotor, [0.0, 0.0], -0.5, spectrum="flow"), within=(-1.0, 1.0))
    with pytest.warns(UserWarning, match="HB1: a branch of limit cycles leaves"):
        assert cv.switch(graph, "HB1") == []
    with pytest.warns(UserWarning, match="EP1: the interval ends here"):
        assert cv.switch(graph, "EP1") == []
    known = graph_of(lambda u, p: p * u - u**2)
    with pytest.warns(UserWarning, match="BP1: the graph has the branches that leave here already: B2"):
        assert cv.switch(known, "BP1") == []


@pytest.mark.parametrize("tilt", [0.5, 2.0])
def test_a_weakly_tilted_one_is_transcritical(tilt):
    """u' = p u - a u^2 - u^3."""
    (point, *_) = graph_of(lambda u, p: p * u - tilt * u**2 - u**3).of_kind("branch-point")
    assert "transcritical" in " ".join(point.remarks) and point.criticality is None
