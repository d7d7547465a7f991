"""The slow flow's response by continuation against its closed form: two ways to the same folds and Hopf
points."""

from __future__ import annotations

import numpy as np
import pytest

import contvines as cv
from orbits import multiple_scales as ms

pytestmark = pytest.mark.slow


def problem(flow, start, regular, manifold="impacting"):
    response = ms.SlowResponse(flow, "detuning", manifold, regular=regular)
    u, p = response.start(start)
    spectrum = "none" if regular else "flow"
    return cv.AlgebraicProblem(
        response,
        u,
        p,
        "detuning",
        response.jacobian,
        response.derivative,
        spectrum=spectrum,
    )


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


@pytest.mark.parametrize("seed", range(2))
def test_folds_and_hopf_points(seed):
    flow, sigma = (ms.SlowFlow(), -2.58) if seed == 0 else drawn(seed)
    curves = ms.frequency_response(flow, points=3000)
    points = [p for c in curves for p in ms.special_points(c)]
    folds = sorted(p.state.detuning for p in points if p.kind == "fold")
    hopf = sorted(p.state.detuning for p in points if p.kind == "hopf")
    graph = cv.diagram(problem(flow, sigma, True), within=(-30.0, 30.0))
    inside = [
        s.value for s in graph.special.values() if s.kind == "fold" and s.u[0] > 0
    ]  # B < 0 is no motion
    assert sorted(inside) == pytest.approx(folds, abs=1e-9)
    flowing = cv.diagram(problem(flow, sigma, False), within=(-30.0, 30.0))
    turned = [s.value for s in flowing.special.values() if s.kind == "hopf" and s.u[0] > 0]
    assert sorted(turned) == pytest.approx(hopf, abs=1e-9)
    for s in flowing.special.values():
        if s.kind == "branch-point":  # one eigenvalue passes through infinity: the manifold's lowest point
            assert s.u[0] == pytest.approx(flow.activation.velocity, abs=1e-6)


def test_sliding_response_has_no_special_point():
    graph = cv.diagram(problem(ms.SlowFlow(), -2.58, False, "sliding"), within=(-6.0, -1.3))
    assert not [s for s in graph.special.values() if s.kind not in ("end",)]
    (branch,) = graph.branches.values()
    assert np.all(branch.stable)
