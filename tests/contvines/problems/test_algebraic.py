"""AlgebraicProblem on textbook cases."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import contvines as cv


def of_kind(graph, kind):
    return sorted(point.value for point in graph.special.values() if point.kind == kind)


def test_pitchfork():
    """x' = p x - x^3 (Strogatz, Nonlinear Dynamics and Chaos, section 3.4): supercritical at p = 0, x = +-sqrt(p)."""
    problem = cv.AlgebraicProblem(
        lambda x, p: p * x - x**3, [0.0], -0.5, spectrum="flow", mirror=lambda x: -x
    )
    graph = cv.diagram(problem, within=(-1.0, 1.0))
    assert list(graph.branches) == ["B1", "B2"]
    point = graph["SB1"]
    assert abs(point.value) < 1e-14 and point.kind == "symmetry-breaking" and point.mirror
    assert point.criticality == "supercritical"
    assert point.coefficient == pytest.approx(-1.0, abs=1e-8)  # the normal form is x' = p x - 1 x^3
    side = graph["B2"]
    np.testing.assert_allclose(side.points[:, 0] ** 2, side.values, atol=1e-12)
    assert side.stable[1:].all() and side.values[0] == point.value
    np.testing.assert_allclose(graph["B1"].stable_intervals(), [(-1.0, 0.0)], atol=1e-14)
    assert [(s.point, s.source, s.target) for s in graph.switches] == [("SB1", "B1", "B2")]


@settings(max_examples=15, deadline=None)
@given(st.floats(1e-4, 0.05), st.sampled_from([-1.0, 1.0]))
def test_perturbed_twin_of_the_pitchfork(size, sign):
    """x' = h + p x - x^3 has one fold, at p = 3 (h/2)^(2/3) (Strogatz, section 3.6), and no branch point."""
    h = sign * size

    def begun(u):
        problem = cv.AlgebraicProblem(lambda x, p: h + p * x - x**3, [u], 0.8, spectrum="flow")
        return cv.diagram(problem, within=(-1.0, 1.0))

    graph, smooth = begun(-sign * 0.9), begun(sign * 0.9)
    assert of_kind(graph, "fold") == pytest.approx([3.0 * (size / 2.0) ** (2.0 / 3.0)], abs=1e-12)
    assert not of_kind(graph, "branch-point") and len(graph) == 1
    assert not of_kind(smooth, "fold") and smooth["B1"].stable.all()


@settings(max_examples=15, deadline=None)
@given(st.floats(0.1, 0.9), st.floats(-0.5, 0.5), st.floats(0.2, 5.0))
def test_isola(radius, centre, stretch):
    """A closed branch (p - c)^2 + (x/s)^2 = r^2 is closed exactly, with folds at c +- r."""
    problem = cv.AlgebraicProblem(
        lambda x, p: (p - centre) ** 2 + (x / stretch) ** 2 - radius**2, [stretch * radius], centre
    )
    graph = cv.diagram(problem, within=(-2.0, 2.0))
    branch = graph["B1"]
    assert branch.closed and len(graph) == 1 and "closed" in branch.ended[0]
    assert branch.values[0] == branch.values[-1]
    assert of_kind(graph, "fold") == pytest.approx([centre - radius, centre + radius], abs=1e-12)
    assert not of_kind(graph, "end")


def test_user_functions_are_events():
    problem = cv.AlgebraicProblem(lambda x, p: x - p**2, [0.0], 0.0)
    graph = cv.diagram(
        problem, within=(-1.0, 2.0), user_functions={"half": ("u0", 0.5), "sum": lambda u, p: u[0] + p - 1.0}
    )
    assert of_kind(graph, "user") == pytest.approx(
        sorted([-np.sqrt(0.5), np.sqrt(0.5), 0.5 * (np.sqrt(5.0) - 1.0)]), abs=1e-13
    )
    assert {p.note for p in graph.of_kind("user")} == {"half", "sum"}


def test_derivatives_given_or_not():
    """Exact, complex-step and difference derivatives give the same fold."""
    exact = 2.0 / (3.0 * np.sqrt(3.0))

    def real_only(x, p):
        return np.array([float(p) + float(x[0]) - abs(float(x[0])) ** 3 * np.sign(float(x[0]))])

    def smooth(x, p):
        return p + x - x**3

    given = {"jacobian": lambda x, p: 1.0 - 3.0 * x**2, "derivative": lambda x, p: [1.0]}
    for F, options in ((smooth, given), (smooth, {}), (real_only, {})):
        problem = cv.AlgebraicProblem(F, [-1.5], -1.0, **options)
        assert problem.functions.complex_step == (F is smooth and not options)
        graph = cv.diagram(problem, within=(-1.5, 1.5))
        accuracy = 1e-13 if F is smooth else 1e-12
        assert of_kind(graph, "fold") == pytest.approx([-exact, exact], abs=accuracy)
