"""Stable intervals: from bifurcation to bifurcation, however narrow, and up to a marginal end."""

from __future__ import annotations

import numpy as np
import pytest

import contvines as cv
from tests.machines import ABSORBER


def test_marginal_end_takes_the_stability_of_its_neighbour():
    absorber = ABSORBER
    seed = absorber.symmetric_orbit(amplitude=0.6)
    graph = cv.diagram(seed, over="restitution", within=(0.3, 1.0), depth=0)
    assert graph["B1"].stable_intervals() == [(0.3, 1.0)]
    assert abs(np.abs(graph["B1"].multipliers[-1]).max() - 1.0) < 1e-9


def test_one_border_reached_from_two_branches():
    """At the depth limit neither branch crosses the border at which both end; it still is one point."""
    absorber = ABSORBER
    seed = absorber.symmetric_orbit(amplitude=0.55)
    graph = cv.diagram(seed, over="amplitude", within=(0.2, 1.3), depth=3)
    (point,) = [p for p in graph.special.values() if abs(p.value - 1.14411783723) < 1e-9]
    (tie,) = [switch for switch in graph.switches if switch.point == point.label]
    assert {tie.source, tie.target} == {
        branch.label for branch in graph if any(label == point.label for _, label in branch.marks)
    }
    assert (
        f"meets {tie.source} at {point.label} (wall-graze), amplitude = 1.144117837"
        in graph[tie.target].ended
    )
    assert not any("WG4" in end for branch in graph for end in branch.ended)


@pytest.mark.parametrize("width", [1e-2, 1e-4, 1e-6, 1e-7])
def test_a_sliver_between_a_fold_and_a_doubling_is_marked(width):
    """x' = x + p - x^2 turns at x = 0; y' = -(1 + x - d) y flips at x = d: stable for 0 < x < d only, exactly."""
    problem = cv.MapProblem(
        lambda z, p: np.array([z[0] + p - z[0] ** 2, -(1.0 + z[0] - width) * z[1]]),
        [0.3, 0.0],
        0.09,
        parameter="p",
    )
    graph = cv.diagram(problem, within=(-0.1, 0.2), depth=0)
    branch = graph["B1"]
    (fold,), (flip,) = graph.of_kind("fold"), graph.of_kind("period-doubling")
    assert (fold.value, flip.value) == pytest.approx((0.0, width**2), abs=1e-13)
    stable = branch.points[branch.stable][:, 0]
    assert len(stable) >= 3  # both ends, and something between
    assert np.all((stable > -1e-9) & (stable < width + 1e-9))
    assert len(branch.stable_intervals()) == 1


@pytest.mark.parametrize(("width", "resolved"), [(3e-9, False), (2e-8, False), (1e-4, True)])
def test_a_sliver_too_narrow_to_be_seen_is_told_of(width, resolved):
    """x' = x + p - x^2 with a second multiplier -(1 + x - width): stable between its fold at p = 1 and its flip at p = 1 + width^2."""
    problem = cv.MapProblem(
        lambda z, p: np.array([z[0] + (p - 1.0) - z[0] ** 2, -(1.0 + z[0] - width) * z[1]]),
        [0.3, 0.0],
        1.09,
        parameter="p",
    )
    graph = cv.diagram(problem, within=(0.9, 1.2), depth=0)
    points = (*graph.of_kind("fold"), *graph.of_kind("period-doubling"))
    assert len(points) == 2
    for point, other in zip(points, points[::-1]):
        assert (f"from {other.label}: " in point.note) is not resolved
    intervals = graph["B1"].stable_intervals()
    assert intervals == ([pytest.approx((1.0, 1.0 + width**2), abs=1e-13)] if resolved else [])


@pytest.mark.parametrize("rate, stable", [(-1e-4, True), (5e-4, False)])
def test_a_flow_is_stable_left_of_the_axis_only(rate, stable):
    """u' = rate u at rest, and a conservative pair, whose eigenvalues are imaginary all along: nothing is attracted."""
    problem = cv.AlgebraicProblem(lambda u, p: rate * (u - p), [0.0], 0.0, spectrum="flow")
    assert bool(cv.diagram(problem, within=(-1.0, 1.0))["B1"].stable.all()) is stable
    turning = cv.AlgebraicProblem(lambda u, p: np.array([u[1], p - u[0]]), [0.0, 0.0], 0.0, spectrum="flow")
    assert not cv.diagram(turning, within=(-1.0, 1.0))["B1"].stable.any()
