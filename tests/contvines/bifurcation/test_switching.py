"""Null vectors, departures and normal forms against hand calculations."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import contvines as cv
from orbits import Absorber


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


def test_fold_coefficient():
    """p = u^2: with metric u^2 + p^2/9 the arclength at the fold is s = u, so p = s^2."""
    graph = cv.diagram(cv.AlgebraicProblem(lambda u, p: p - u**2, [1.0], 1.0), within=(-1.0, 2.0))
    assert graph["LP1"].coefficient == pytest.approx(1.0, rel=1e-6)


def test_symmetry_class_of_a_branch_point():
    """The same pitchfork with and without its mirror declared: one traced side, or one branch through the point."""
    for mirror, kind, points in ((None, "branch-point", 2), (lambda x: -x, "symmetry-breaking", 1)):
        problem = cv.AlgebraicProblem(lambda x, p: p * x - x**3, [0.0], -0.5, spectrum="flow", mirror=mirror)
        graph = cv.diagram(problem, within=(-1.0, 1.0))
        (point,) = graph.of_kind(kind)
        assert point.mirror == (mirror is not None)
        assert sum(graph["B2"].values == 1.0) == points


def test_a_matrix_that_is_singular_to_the_last_bit():
    """By chance that of the elimination is, at this symmetry breaking with these steps; the branch that leaves was lost.

    Symmetric LR breaks at beta = (2 pi - 4 R H)/(pi^2 - 4), C^2 = (1 - pi beta/2)^2 + (R beta + H)^2, with R = (1 - r)/(1 + r) and
    H = pi a/2.
    """
    r, friction, gravity = 0.6198998017488868, 0.30984321600220044, 0.054285101460721324
    machine = Absorber(restitution=r, friction=friction, gravity=gravity)
    within = (0.1061932614806999, 0.9061932614806999)
    R, H = (1.0 - r) / (1.0 + r), 0.5 * np.pi * friction * gravity
    beta = (2.0 * np.pi - 4.0 * R * H) / (np.pi**2 - 4.0)
    breaking = np.hypot(1.0 - 0.5 * np.pi * beta, R * beta + H)
    for steps in ({}, {"max_step": 0.02}, {"first_step": 5e-4}):
        orbit = machine.symmetric_orbit(0.5061932614806999)
        graph = cv.diagram(orbit, over="amplitude", within=within, depth=1, settings=steps)
        point = graph["SB1"]
        assert point.value == pytest.approx(breaking, rel=1e-12)
        assert point.criticality == "supercritical"
        side = next(branch for branch in graph if branch.seed == "SB1")
        assert not side.problem.symmetric and side.stable[1:-1].all()


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
