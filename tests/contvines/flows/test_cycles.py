"""Cycles of flows against closed forms, simulation with scipy, and the literature."""

import numpy as np
import pytest

import contvines as cv
from tests.contvines.flows.shooting import neuron, prey_and_predator, run


def stuart_landau(x, p):
    """r' = r (m (1 - m) - r^2), angle' = 1: a circle of radius sqrt(m (1 - m)), period 2 pi, multiplier exp(-4 pi m (1 - m))."""
    growth, square = p.m * (1 - p.m), x[0] ** 2 + x[1] ** 2
    return [growth * x[0] - x[1] - x[0] * square, x[0] + growth * x[1] - x[1] * square]


def test_circles_from_one_hopf_point_to_the_next(tmp_path):
    graph = cv.diagram(cv.FlowProblem(stuart_landau, [0.0, 0.0], {"m": -0.5}), over="m", within=(-1.0, 2.0))
    assert [point.value for point in graph.of_kind("hopf")] == pytest.approx([0.0, 1.0], abs=1e-12)
    assert [p.criticality for p in graph.of_kind("hopf")] == ["supercritical"] * 2
    assert len(graph.branches) == 2  # the cycles that leave one point come back at the other
    graph.save(tmp_path / "circles.vines")
    again = cv.load(tmp_path / "circles.vines")
    assert again["HB1"].cycles().period == pytest.approx(2.0 * np.pi, abs=1e-8)
    for cycles in (graph["B2"], again["B2"]):
        growth = cycles.values * (1.0 - cycles.values)
        assert np.allclose(cycles.measure("max x0"), np.sqrt(np.maximum(growth, 0.0)), atol=2e-8)
        assert np.allclose(cycles.measure("period"), 2.0 * np.pi, atol=1e-8)
        inner = slice(1, -1)
        assert np.allclose(cycles.multipliers[inner, 0], np.exp(-4.0 * np.pi * growth[inner]), atol=1e-7)
        assert cycles.stable[inner].all()


def ring(x, p):
    """Three excitable cells: at rest v - v^3 / 3 = (v + 0.7) / 0.8. Only rounding of its simulation moves there."""
    v, w = x[::2], x[1::2]
    pulled = [p.k * (v[j - 1] + v[j - 2] - 2 * v[j]) for j in range(3)]
    pairs = zip(v, w, pulled, strict=True)
    return [rate for a, b, c in pairs for rate in (a - a**3 / 3 - b + c, 0.3 * (a + 0.7 - 0.8 * b))]


REST = min(np.roots([-1 / 3, 0.0, 1.0 - 1.25, -0.875]).tolist(), key=lambda root: abs(root.imag)).real


@pytest.mark.parametrize(
    ("f", "start", "k", "place"),
    [
        (prey_and_predator, [0.0, 0.0], 2.0, r"\[0.666667 0.888889\]"),
        (ring, [1.0, 0.0] * 3, 0.1, f".{REST:.6f}"),
    ],
)
def test_a_motion_comes_to_rest(f, start, k, place):
    with pytest.raises(ValueError, match="comes to rest at " + place):
        cv.FlowProblem(f, start, {"k": k}).attractor()


@pytest.mark.slow
def test_a_burst_of_sharp_spikes_is_a_cycle():
    start = [-1.5, -10.0, 0.0]
    orbit = cv.FlowProblem(neuron, start, {"current": 2.0}).attractor()
    settled = run(neuron, start, 4000.0, 1e-10, current=2.0)
    later = run(neuron, settled, orbit.period, 1e-10, current=2.0)
    assert orbit.stable and np.abs(later - settled).max() < 1e-4
