"""What leaves special points: of which class it is, on which side it lies, and what is said where nothing leaves."""

import numpy as np
import pytest

import contvines as cv


def graph_of(function, start=(0.0,), p0=-0.5, within=(-1.0, 1.0), **more):
    problem = cv.AlgebraicProblem(function, list(start), p0, spectrum="flow", **more)
    return cv.diagram(problem, within=within)


TRANSCRITICAL = {
    "plain": (lambda u, p: p * u - u**2, (0.0,), -0.5),
    "tilted pitchfork": (lambda u, p: p * u - 0.5 * u**2 - u**3, (0.0,), -0.5),
    "more": (lambda u, p: p * u - 2.0 * u**2 - u**3, (0.0,), -0.5),
    # the known branch u = (100 p + 10, 0) does not turn at p = 0, however little the parameter changes along it
    "steep": (lambda u, p: [u[0] - 10.0 - 100.0 * p, u[1] * (u[0] - 10.0 - u[1])], (1.0, 0.0), -0.09),
}


@pytest.mark.parametrize(("function", "start", "p0"), TRANSCRITICAL.values(), ids=TRANSCRITICAL)
def test_a_transcritical_point_is_said_to_be_one(function, start, p0):
    """Branches cross at p = 0: there is no side and no coefficient."""
    (point, *_) = graph_of(function, start, p0, (-0.6, 0.3), scale=1.0).of_kind("branch-point")
    assert "transcritical" in point.remarks and point.criticality is None
    assert abs(point.value) <= point.location_error + 1e-14 and 0.0 <= point.location_error < 1e-8


@pytest.mark.parametrize("problem", [cv.AlgebraicProblem, cv.MapProblem])
@pytest.mark.parametrize(("linear", "cubic"), [(1.0, -1.0), (1.0, 1.0), (-1.0, 2.0), (-1.0, -2.0)])
@pytest.mark.parametrize("bent", [True, False])
def test_a_pitchfork_is_one_along_the_branch_that_bends_too(problem, linear, cubic, bent):
    """u' = a p u + c u^3, or x -> x + a p x + c x^3, begun on a p = -c u^2 or on u = 0: c is the coefficient on either branch."""
    u0, p0 = (0.5, -0.25 * cubic / linear) if bent else (0.0, -0.5)
    own = {"spectrum": "flow"} if problem is cv.AlgebraicProblem else {}
    shift = 0.0 if own else 1.0
    begun = problem(lambda u, p: shift * u + linear * p * u + cubic * u**3, [u0], p0, scale=1.0, **own)
    graph = cv.diagram(begun, within=(-0.9, 0.9))
    (point,) = graph.of_kind("branch-point")
    assert point.branch == "B1" and (np.abs(graph["B1"].points).max() > 0.1) == bent
    assert "transcritical" not in point.note
    assert point.coefficient == pytest.approx(cubic, rel=1e-6)
    assert point.criticality == ("supercritical" if cubic < 0.0 else "subcritical")


def test_symmetry_class_of_a_branch_point():
    """The same pitchfork with and without its mirror declared: one traced side, or one branch through the point."""
    for mirror, kind, points in ((None, "branch-point", 2), (lambda x: -x, "symmetry-breaking", 1)):
        graph = graph_of(lambda x, p: p * x - x**3, mirror=mirror)
        (point,) = graph.of_kind(kind)
        assert point.mirror == (mirror is not None)
        assert sum(graph["B2"].values == 1.0) == points


def test_where_one_eigenvalue_leaves_as_another_enters():
    """The symmetry of a triangle: x' = p z + conj(z)^2 has three branches through 0 along which eigenvalues change places."""
    # start on one of the branches, x = -p: no count of eigenvalues changes at p = 0
    graph = graph_of(
        lambda u, p: [p * u[0] + u[0] ** 2 - u[1] ** 2, p * u[1] - 2.0 * u[0] * u[1]], (0.5, 0.0)
    )
    assert [s.value for s in graph.of_kind("branch-point")] == pytest.approx([0.0], abs=1e-10)
    assert len(graph) == 4


@pytest.mark.slow
def test_a_branch_that_stands_upright_has_no_criticality():
    # p u = 0: at p = 0 every u solves
    graph = graph_of(lambda u, p: p * u, scale=1.0)
    (point,) = graph.of_kind("branch-point")
    assert point.value == pytest.approx(0.0, abs=1e-15)
    assert point.criticality is None
    assert any("stands upright" in said for said in point.remarks)
    assert len(graph) == 2 and np.ptp(graph["B2"].values) < 1e-14


def test_switching_where_nothing_leaves_says_why():
    """x' = p x - y - x r^2, y' = x + p y - y r^2: limit cycles leave the Hopf point at p = 0."""
    rotor = graph_of(lambda u, p: (p - u @ u) * u + np.array([-u[1], u[0]]), (0.0, 0.0))
    known = graph_of(lambda u, p: p * u - u**2)
    for graph, label, said in (
        (rotor, "HB1", "a branch of limit cycles leaves"),
        (rotor, "EP1", "the interval ends here"),
        (known, "BP1", "the graph has the branches that leave here already: B2"),
    ):
        with pytest.warns(UserWarning, match=f"{label}: {said}"):
            assert cv.switch(graph, label) == []
