"""Stable intervals: from bifurcation to bifurcation, however narrow, and up to a marginal end."""

import numpy as np
import pytest

import contvines as cv
from tests.machines import ABSORBER, absorber_graph


def test_marginal_end_takes_the_stability_of_its_neighbour():
    seed = ABSORBER.symmetric_orbit(amplitude=0.6)
    branch = cv.diagram(seed, over="restitution", within=(0.3, 1.0), depth=0)["B1"]
    assert branch.stable_intervals() == [(0.3, 1.0)]
    assert abs(np.abs(branch.multipliers[-1]).max() - 1.0) < 1e-9


def test_one_border_reached_from_two_branches():
    """At the depth limit neither branch crosses the border at which both end; it still is one point."""
    graph = absorber_graph(0.55, (0.2, 1.3), depth=3)
    (point,) = [p for p in graph.special.values() if abs(p.value - 1.14411783723) < 1e-9]
    (tie,) = [switch for switch in graph.switches if switch.point == point.label]
    on = {branch.label for branch in graph if any(label == point.label for _, label in branch.marks)}
    assert {tie.source, tie.target} == on
    said = f"meets {tie.source} at {point.label} (wall-graze), amplitude = 1.144117837"
    assert said in graph[tie.target].ended
    assert not any("WG4" in end for branch in graph for end in branch.ended)


@pytest.mark.parametrize("width", [1e-2, 1e-4, 1e-6, 1e-7, 2e-8, 3e-9])
@pytest.mark.parametrize("at", [0.0, 1.0])
def test_a_sliver_between_a_fold_and_a_doubling_is_marked_or_told_of(width, at):
    """x' = x + p - x^2 turns at x = 0; y' = -(1 + x - width) y flips at x = width: stable between the two only, exactly."""
    problem = cv.MapProblem(
        lambda z, p: [z[0] + (p - at) - z[0] ** 2, -(1.0 + z[0] - width) * z[1]],
        [0.3, 0.0],
        at + 0.09,
    )
    graph = cv.diagram(problem, within=(at - 0.1, at + 0.2), depth=0)
    branch, resolved = graph["B1"], width > (3e-7 if at else 5e-8)
    (fold,), (flip,) = graph.of_kind("fold"), graph.of_kind("period-doubling")
    assert (fold.value, flip.value) == pytest.approx((at, at + width**2), abs=1e-13)
    for point, other in ((fold, flip), (flip, fold)):
        assert (f"from {other.label}: " in point.note) is not resolved
    intervals = [pytest.approx((at, at + width**2), abs=1e-13)] if resolved else []
    assert branch.stable_intervals() == intervals
    stable = branch.points[branch.stable][:, 0]
    assert len(stable) >= 3 or not resolved  # both ends, and something between
    assert np.all((stable > -1e-9) & (stable < width + 1e-9))


@pytest.mark.parametrize("rate, stable", [(-1e-4, True), (5e-4, False)])
def test_a_flow_is_stable_left_of_the_axis_only(rate, stable):
    """u' = rate u at rest, and a conservative pair, whose eigenvalues are imaginary all along: nothing is attracted."""
    problem = cv.AlgebraicProblem(lambda u, p: rate * (u - p), [0.0], 0.0, spectrum="flow")
    assert bool(cv.diagram(problem, within=(-1.0, 1.0))["B1"].stable.all()) is stable
    turning = cv.AlgebraicProblem(lambda u, p: [u[1], p - u[0]], [0.0, 0.0], 0.0, spectrum="flow")
    assert not cv.diagram(turning, within=(-1.0, 1.0))["B1"].stable.any()


@pytest.mark.parametrize("turns", [0.0, 1.0, 2.0, 3.0, 4.5])
def test_stable_intervals_of_a_closed_branch_are_in_order_and_not_cut_where_it_begins(turns):
    """u' = -(u^2 + p^2 - 1) (u - w(p)), w = 5 p (2 p^2 - 1) / 6: on the circle its sign of u (u - w) says where it is stable."""
    problem = cv.AlgebraicProblem(
        lambda u, p: -(u[0] ** 2 + p * p - 1.0) * (u[0] - 5.0 * p * (2.0 * p * p - 1.0) / 6.0),
        [np.cos(turns)],
        np.sin(turns),
        spectrum="flow",
    )
    branch = cv.diagram(problem, within=(-2.0, 2.0), depth=0)["B1"]
    assert branch.closed
    # from (0, 1) by way of (-1, 0) to u = w, p = -2/sqrt(5), and the same turned round
    ends = 2.0 / np.sqrt(5.0)
    assert np.array(branch.stable_intervals()) == pytest.approx(
        np.array([(-1.0, ends), (-ends, 1.0)]), abs=1e-9
    )
