"""Cycles of flows against closed forms, simulation with scipy, and the literature."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import contvines as cv


def stuart_landau(x, p):
    """r' = r (m (1 - m) - r^2), angle' = 1: a circle of radius sqrt(m (1 - m)), period 2 pi, multiplier exp(-4 pi m (1 - m))."""
    growth, square = p.m * (1 - p.m), x[0] ** 2 + x[1] ** 2
    return [growth * x[0] - x[1] - x[0] * square, x[0] + growth * x[1] - x[1] * square]


def lure(x, p):
    return [x[1], x[2], -p.alpha * x[2] - p.beta * x[1] - x[0] + x[0] ** 2]


def duffing(x, p, t):
    return [x[1], -0.1 * x[1] - x[0] - x[0] ** 3 + p.g * np.cos(p.omega * t)]


def monodromy(f, x, period, jacobian):
    """By scipy's DOP853, of the variational equations."""
    d = len(x)

    def rate(t, y):
        return np.concatenate([f(y[:d]), (jacobian(y[:d]) @ y[d:].reshape(d, d)).ravel()])

    start = np.concatenate([x, np.eye(d).ravel()])
    end = solve_ivp(rate, (0.0, period), start, method="DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
    return end[:d], end[d:].reshape(d, d)


def test_circles_from_one_hopf_point_to_the_next():
    graph = cv.diagram(cv.FlowProblem(stuart_landau, [0.0, 0.0], {"m": -0.5}), over="m", within=(-1.0, 2.0))
    assert [point.value for point in graph.of_kind("hopf")] == pytest.approx([0.0, 1.0], abs=1e-12)
    assert [p.criticality for p in graph.of_kind("hopf")] == ["supercritical"] * 2
    assert len(graph.branches) == 2  # the cycles that leave one point come back at the other
    cycles = graph["B2"]
    growth = cycles.values * (1.0 - cycles.values)
    assert np.allclose(cycles.measure("max x0"), np.sqrt(np.maximum(growth, 0.0)), atol=2e-8)
    assert np.allclose(cycles.measure("period"), 2.0 * np.pi, atol=1e-8)
    inner = slice(1, -1)
    assert np.allclose(cycles.multipliers[inner, 0], np.exp(-4.0 * np.pi * growth[inner]), atol=1e-7)
    assert cycles.stable[inner].all()


def test_a_cascade_begins_where_simulation_has_a_multiplier_of_minus_one():
    flow = cv.FlowProblem(lure, [0.0, 0.0, 0.0], {"alpha": 1.5, "beta": 1.0})
    graph = cv.diagram(flow, over="alpha", within=(0.55, 1.6), depth=2)
    assert graph["HB1"].value == pytest.approx(1.0, abs=1e-12)  # Routh and Hurwitz: alpha beta = 1
    point = graph["PD1"]
    assert point.value == pytest.approx(0.63030200616, abs=1e-9)  # BifurcationKit's tutorial prints 0.630302
    orbit = point.orbit

    def jacobian(x):
        return np.array([[0, 1, 0], [0, 0, 1], [-1 + 2 * x[0], -1, -point.value]])

    def f(x):
        return np.array([x[1], x[2], -point.value * x[2] - x[1] - x[0] + x[0] ** 2])

    end, matrix = monodromy(f, orbit.states[0], orbit.period, jacobian)
    assert np.abs(end - orbit.states[0]).max() < 1e-8
    found = np.linalg.eigvals(matrix)
    assert np.abs(found + 1.0).min() < 1e-7
    assert np.abs(found - 1.0).min() < 1e-7
    assert graph["PD1"].criticality == "supercritical"
    assert graph["PD2"].branch == "B3"
    assert graph["B3"].measure("period")[0] == pytest.approx(2.0 * orbit.period, rel=1e-6)


def test_a_motion_that_begins_at_an_unstable_equilibrium_leaves_it_upwards():
    """Prey and predator of Rosenzweig and MacArthur: below zero they escape; above they coexist, at rest where prey is d / (e - d h) = 2 / 3."""

    def f(x, p):
        eaten = x[0] * x[1] / (1 + 0.5 * x[0])
        return [x[0] * (1 - x[0] / p.K) - eaten, 0.6 * eaten - 0.3 * x[1]]

    flow = cv.FlowProblem(f, [0.0, 0.0], {"K": 2.0})
    with pytest.raises(ValueError, match=r"comes to rest at \[0.666667 0.888889\]"):
        flow.attractor()


def test_what_attracts_is_solved_for():
    flow = cv.FlowProblem(
        lambda x, p: [p.a - (p.b + 1) * x[0] + x[0] ** 2 * x[1], p.b * x[0] - x[0] ** 2 * x[1]],
        [1.0, 1.0],
        {"a": 1.0, "b": 2.2},
    )
    orbit = flow.attractor()
    assert orbit.replay() < 1e-5
    assert np.abs(orbit.simulated_multipliers() - 1.0).min() < 1e-6
    assert orbit.stable
    graph = cv.diagram(orbit, over="b", within=(1.5, 2.5))
    assert [p.value for p in graph.of_kind("hopf")] == pytest.approx([2.0], abs=1e-8)  # b = 1 + a^2
    assert len(graph.branches) == 2


def test_a_forced_oscillator_folds_where_scipy_has_a_multiplier_of_one():
    flow = cv.FlowProblem(duffing, [0.0, 0.0], {"omega": 1.0, "g": 0.5}, period=lambda p: 2 * np.pi / p.omega)
    graph = cv.diagram(flow, over="omega", within=(0.9, 3.0))
    folds = graph.of_kind("fold")
    assert len(folds) == 2
    for point in folds:
        orbit, omega = point.orbit, point.value

        def rate(t, y, omega=omega):
            x, v = y[:2], y[2:].reshape(2, 2)
            jacobian = np.array([[0.0, 1.0], [-1.0 - 3.0 * x[0] ** 2, -0.1]])
            own = [x[1], -0.1 * x[1] - x[0] - x[0] ** 3 + 0.5 * np.cos(omega * t)]
            return np.concatenate([own, (jacobian @ v).ravel()])

        start = np.concatenate([orbit.states[0], np.eye(2).ravel()])
        end = solve_ivp(rate, (0.0, 2 * np.pi / omega), start, method="DOP853", rtol=1e-12, atol=1e-13).y[
            :, -1
        ]
        assert np.abs(end[:2] - orbit.states[0]).max() < 1e-6
        assert np.abs(np.linalg.eigvals(end[2:].reshape(2, 2)) - 1.0).min() < 1e-3  # square root of the error
        assert np.linalg.det(end[2:].reshape(2, 2)) == pytest.approx(
            np.exp(-0.1 * 2 * np.pi / omega), rel=1e-8
        )
        assert np.prod(point.multipliers).real == pytest.approx(np.exp(-0.1 * 2 * np.pi / omega), rel=1e-6)


def test_a_graph_with_cycles_is_read_back(tmp_path):
    graph = cv.diagram(cv.FlowProblem(stuart_landau, [0.0, 0.0], {"m": -0.1}), over="m", within=(-0.2, 0.3))
    graph.save(tmp_path / "circles.vines")
    again = cv.load(tmp_path / "circles.vines")
    assert again["B2"].problem is not None
    assert np.allclose(again["B2"].measure("period"), 2.0 * np.pi, atol=1e-8)
    assert again["HB1"].cycles().period == pytest.approx(2.0 * np.pi, abs=1e-8)


@pytest.mark.slow
def test_relaxation_oscillations_in_one_branch():
    flow = cv.FlowProblem(
        lambda x, p: [x[1], p.mu * (1 - x[0] ** 2) * x[1] - x[0]],
        [1.0, 0.0],
        {"mu": 1.0},
        mirror=lambda x: -x,
    )
    branch = cv.diagram(flow.attractor(), over="mu", within=(0.01, 60.0))["B1"]
    periods, mu = branch.measure("period"), branch.values
    # Lindstedt and Poincare: T = 2 pi (1 + mu^2 / 16 + ...); Dorodnitsyn: (3 - 2 log 2) mu + 7.0143 mu^(-1/3) - ...
    assert periods[0] == pytest.approx(2.0 * np.pi * (1.0 + 0.01**2 / 16), rel=1e-8)
    assert mu[-1] == 60.0
    start = branch.orbit(len(branch) - 1)
    assert start.replay() < 1e-4
    large = (3.0 - 2.0 * np.log(2.0)) * 60.0 + 7.0143 * 60.0 ** (-1 / 3)
    assert periods[-1] == pytest.approx(large, rel=5e-3)


def test_a_motion_rests_where_only_rounding_of_its_simulation_moves():
    """Three excitable cells in a ring: at rest x - x^3 / 3 = (x + 0.7) / 0.8."""

    def ring(x, p):
        v, w = x[::2], x[1::2]
        pulled = [p.k * (v[j - 1] + v[j - 2] - 2 * v[j]) for j in range(3)]
        pairs = zip(v, w, pulled, strict=True)
        return [rate for a, b, c in pairs for rate in (a - a**3 / 3 - b + c, 0.3 * (a + 0.7 - 0.8 * b))]

    rest = min(np.roots([-1 / 3, 0.0, 1.0 - 1.25, -0.875]).tolist(), key=lambda root: abs(root.imag)).real
    with pytest.raises(ValueError, match=f"comes to rest at .{rest:.6f}"):
        cv.FlowProblem(ring, [1.0, 0.0] * 3, {"k": 0.1}).attractor()


def test_multipliers_of_a_flow_that_returns_an_array():
    """The unit circle attracts with the exponents -2, -0.1 and -0.2, its period is 2 pi."""

    def rates(x, p):
        growth = p.m - x[0] ** 2 - x[1] ** 2
        return np.array([growth * x[0] - x[1], x[0] + growth * x[1], -0.1 * x[2], -0.2 * x[3]])

    orbit = cv.FlowProblem(rates, [1.0, 0.1, 0.2, 0.2], {"m": 1.0}).attractor()
    assert np.sort(orbit.multipliers.real) == pytest.approx(
        np.exp([-4.0 * np.pi, -0.4 * np.pi, -0.2 * np.pi]), abs=1e-9
    )
