"""Null vectors, departures and normal forms against hand calculations."""

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import contvines as cv


@settings(max_examples=15, deadline=None)
@given(st.floats(-2.0, 2.0), st.floats(-2.0, 2.0))
def test_flip_coefficient_of_a_general_map(q, c):
    """x -> -(1 + p) x + q x^2 + c x^3 has Kuznetsov's coefficient q^2 + c (theorem 4.3: f_xx^2/4 + f_xxx/6)."""
    if abs(q * q + c) < 0.05:
        return
    problem = cv.MapProblem(lambda x, p: -(1.0 + p) * x + q * x**2 + c * x**3, [0.0], -0.2)
    graph = cv.diagram(problem, within=(-0.3, 0.1), depth=0)
    point = graph["PD1"]
    assert point.value == pytest.approx(0.0, abs=1e-13)
    assert point.coefficient == pytest.approx(q * q + c, rel=1e-4, abs=1e-4)
    assert point.criticality == ("supercritical" if q * q + c > 0 else "subcritical")


@pytest.mark.parametrize("a", [0.25, 2.0, -3.0])
def test_fold_coefficient(a):
    """p = a u^2 turns with the coefficient a at u = 0."""
    problem = cv.AlgebraicProblem(lambda u, p: p - a * u**2, [abs(a) ** -0.5], np.sign(a))
    fold = cv.diagram(problem, within=(-1.0, 1.0))["LP1"]
    assert (fold.value, fold.coefficient) == pytest.approx((0.0, a), rel=1e-6, abs=1e-12)


def test_flip_coefficient_beside_other_doublings():
    """The third doubling of x -> x + K (q - x^2), 1e-9 of q from the second: g^2/4 + h/6 of the fourth iterate with derivatives -1, g, h."""
    K = 1e4
    problem = cv.MapProblem(lambda x, p: [x[0] + K * (p.q - x[0] ** 2)], [0.3], {"q": 0.09})
    point = cv.diagram(problem, over="q", within=(-1.0, 0.1), depth=2)["PD3"]

    def fourth(x, q):
        for _ in range(4):
            x = x + K * (q - x**2)
        return x

    with mpmath.workdps(60):

        def doubling(x, q):
            return fourth(x, q) - x, mpmath.diff(lambda x: fourth(x, q), x) + 1

        x, q = mpmath.findroot(doubling, (float(point.u[0]), point.value))
        second, third = (float(mpmath.diff(lambda x: fourth(x, q), x, n)) for n in (2, 3))
    assert point.value == pytest.approx(float(q), abs=1e-17)
    assert point.coefficient == pytest.approx(second**2 / 4 + third / 6, rel=1e-3)
    assert point.criticality == "supercritical"


def test_symmetry_class_of_a_branch_point():
    """The same pitchfork with and without its mirror declared: one traced side, or one branch through the point."""
    for mirror, kind, points in ((None, "branch-point", 2), (lambda x: -x, "symmetry-breaking", 1)):
        problem = cv.AlgebraicProblem(lambda x, p: p * x - x**3, [0.0], -0.5, spectrum="flow", mirror=mirror)
        graph = cv.diagram(problem, within=(-1.0, 1.0))
        (point,) = graph.of_kind(kind)
        assert point.mirror == (mirror is not None)
        assert sum(graph["B2"].values == 1.0) == points


@pytest.mark.slow
def test_a_branch_that_stands_upright_has_no_criticality():
    # p u = 0: at p = 0 every u solves
    graph = cv.diagram(
        cv.AlgebraicProblem(lambda u, p: p * u, [0.0], -0.5, spectrum="flow", scale=1.0), within=(-1.0, 1.0)
    )
    (point,) = graph.of_kind("branch-point")
    assert point.value == pytest.approx(0.0, abs=1e-15)
    assert point.criticality is None
    assert any("stands upright" in said for said in point.remarks)
    assert len(graph) == 2 and np.ptp(graph["B2"].values) < 1e-14
