"""What is said of a branch that leaves: sides and steepness from normal forms that can be read off."""

import numpy as np
import pytest

import contvines as cv


def graph_of(function, within=(-1.0, 1.0), start=-0.5, **more):
    return cv.diagram(
        cv.AlgebraicProblem(function, [0.0], start, spectrum="flow", scale=1.0, **more), within=within
    )


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


@pytest.mark.parametrize("tilt", [0.5, 2.0])
def test_a_weakly_tilted_one_is_transcritical(tilt):
    """u' = p u - a u^2 - u^3."""
    (point, *_) = graph_of(lambda u, p: p * u - tilt * u**2 - u**3).of_kind("branch-point")
    assert "transcritical" in " ".join(point.remarks) and point.criticality is None


def test_depth_counts_switches():
    """u' = p u - u^3 has three ways out of the origin; without depth none of them is followed."""

    def F(u, p):
        return p * u - u**3

    problem = cv.AlgebraicProblem(F, [0.0], -0.5, spectrum="flow", scale=1.0)
    assert len(cv.diagram(problem, within=(-1.0, 1.0), depth=0).branches) == 1
    graph = cv.diagram(problem, within=(-1.0, 1.0), depth=1)
    assert len(graph.branches) == 2
    side = graph["B2"]
    np.testing.assert_allclose(side.points[:, 0] ** 2, side.values, atol=1e-12)
