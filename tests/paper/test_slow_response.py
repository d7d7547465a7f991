"""The slow flow's response by continuation against its closed form: two ways to the same folds and Hopf
points."""

import numpy as np
import pytest

import contvines as cv
from orbits import multiple_scales as ms

pytestmark = pytest.mark.slow


def followed(flow, start, within, regular=False, manifold="impacting"):
    response = ms.SlowResponse(flow, "detuning", manifold, regular=regular)
    given = (*response.start(start), "detuning", response.jacobian, response.derivative)
    problem = cv.AlgebraicProblem(response, *given, spectrum="none" if regular else "flow")
    return cv.diagram(problem, within=within)


def drawn(seed):
    """A machine with a response that holds a seen steady state, and its detuning."""
    rng = np.random.default_rng(seed)
    while True:
        flow = ms.SlowFlow(
            forcing=rng.uniform(1.2, 3.5), friction=rng.uniform(0.1, 0.8), restitution=rng.uniform(0.5, 0.9)
        )
        sigma = rng.uniform(-4, -1)
        if any(s.seen and s.manifold == "impacting" for s in ms.equilibria(flow, sigma)):
            return flow, sigma


@pytest.mark.parametrize(("flow", "sigma"), [(ms.SlowFlow(), -2.58), drawn(1)])
def test_folds_and_hopf_points(flow, sigma):
    points = [p for curve in ms.frequency_response(flow, points=3000) for p in ms.special_points(curve)]
    for kind, regular in (("fold", True), ("hopf", False)):
        graph = followed(flow, sigma, (-30.0, 30.0), regular)
        wanted = sorted(p.state.detuning for p in points if p.kind == kind)
        found = sorted(p.value for p in graph.of_kind(kind) if p.u[0] > 0)  # B < 0 is no motion
        assert found == pytest.approx(wanted, abs=1e-9)
    for point in graph.of_kind("branch-point"):
        # one eigenvalue passes through infinity: the manifold's lowest point
        assert point.u[0] == pytest.approx(flow.activation.velocity, abs=1e-6)


def test_sliding_response_has_no_special_point():
    graph = followed(ms.SlowFlow(), -2.58, (-6.0, -1.3), manifold="sliding")
    assert not [s for s in graph.special.values() if s.kind != "end"]
    (branch,) = graph
    assert np.all(branch.stable)
