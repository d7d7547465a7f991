"""Large flows with sparse Jacobians against the same flows with full ones, and against simulation."""

import numpy as np
import pytest
from scipy.sparse import csc_matrix

import contvines as cv
from contvines.flows.orbit import CycleOrbit

pytestmark = pytest.mark.slow

CELLS = 16


def coupled_cells(x, p):
    """A chain of FitzHugh-Nagumo cells that differ along the chain, coupled by diffusion."""
    u, v = x[:CELLS], x[CELLS:]
    beside = np.concatenate([u[1:2] - u[:1], u[2:] - 2 * u[1:-1] + u[:-2], u[-2:-1] - u[-1:]])
    place = (np.arange(CELLS) / CELLS - 0.5).reshape((-1,) + (1,) * (x.ndim - 1))
    return np.concatenate([u - u**3 / 3 - v + 0.5 * beside, 0.3 * (u + p.a + 0.2 * place - 0.5 * v)])


def jacobian(x, p):
    identity = np.eye(CELLS)
    beside = -(np.diff(identity, axis=0).T @ np.diff(identity, axis=0))
    top = np.hstack([np.diag(1 - x[:CELLS] ** 2) + 0.5 * beside, -identity])
    return csc_matrix(np.vstack([top, np.hstack([0.3 * identity, -0.15 * identity])]))


@pytest.fixture(scope="module")
def orbit():
    start = np.concatenate([np.ones(CELLS), np.zeros(CELLS)])
    return cv.FlowProblem(coupled_cells, start, {"a": 0.3}).attractor()


def test_the_sparsity_is_found_out(orbit):
    pattern = orbit._problem.field.sparsity
    assert pattern is not None
    expected = (jacobian(np.full(2 * CELLS, 0.3), None).toarray() != 0) | np.eye(2 * CELLS, dtype=bool)
    found = np.zeros((2 * CELLS, 2 * CELLS), dtype=bool)
    found[pattern.indices, pattern.columns] = True
    assert np.array_equal(found, expected)
    assert pattern.count <= 5


def test_leading_multipliers_are_those_of_a_simulation(orbit):
    assert orbit.replay() < 1e-6
    simulated = orbit.simulated_multipliers()
    rest = np.delete(simulated, np.argmin(np.abs(simulated - 1.0)))
    expected = np.sort(np.abs(rest))[::-1][: len(orbit.multipliers)]
    assert len(orbit.multipliers) == 10
    assert np.allclose(np.abs(orbit.multipliers), expected, atol=1e-7)
    assert orbit.trivial_error < 1e-7


def test_cycles_with_sparse_and_full_matrices_are_the_same(orbit):
    start = np.concatenate([np.ones(CELLS), np.zeros(CELLS)])
    flow = cv.FlowProblem(coupled_cells, start, {"a": 0.3})
    flow.field.sparsity = None
    full = flow.attractor()
    assert full.period == pytest.approx(orbit.period, rel=1e-8)
    assert np.allclose(full.multipliers[:4], orbit.multipliers[:4], atol=1e-7)
    problem = orbit.problem("a")
    points = [point for point, _ in zip(cv.trace(problem, within=(0.25, 0.32)), range(3))]
    other = [point for point, _ in zip(cv.trace(full.problem("a"), within=(0.25, 0.32)), range(3))]
    assert points[-1].value == pytest.approx(other[-1].value, rel=1e-6)


def test_cycles_leave_a_hopf_point_of_a_large_flow():
    """In the uniform chain the cells oscillate together: the Hopf point is that of one cell, 1 - u^2 = 0.15 at u."""

    def uniform(x, p):
        u, v = x[:CELLS], x[CELLS:]
        beside = np.concatenate([u[1:2] - u[:1], u[2:] - 2 * u[1:-1] + u[:-2], u[-2:-1] - u[-1:]])
        return np.concatenate([u - u**3 / 3 - v + 0.5 * beside, 0.3 * (u + p.a - 0.5 * v)])

    u = -np.sqrt(1.0 - 0.15)
    a = 0.5 * (u - u**3 / 3) - u
    start = np.concatenate([np.full(CELLS, u), np.full(CELLS, u - u**3 / 3)])
    flow = cv.FlowProblem(uniform, start, {"a": a + 0.02})
    graph = cv.diagram(flow, over="a", within=(a - 0.02, a + 0.03), depth=0)
    point = min(graph.of_kind("hopf"), key=lambda point: abs(point.value - a))
    assert point.value == pytest.approx(a, abs=1e-10)
    cycle = point.cycles()
    assert isinstance(cycle, CycleOrbit)
    assert cycle.period == pytest.approx(2.0 * np.pi / np.sqrt(0.3 - 0.15**2), rel=1e-3)
    assert np.ptp(cycle.states[:, :CELLS], axis=1).max() < 1e-6  # all cells alike


def test_cycles_of_forty_states_leave_each_of_two_hopf_points():
    """Two oscillators z' = (p - a + i w) z - z |z|^2, a = 0 and 1/2, beside 36 states that decay: cycles |z|^2 = p - a."""

    def rates(x, p):
        first, second = p.p - x[0] ** 2 - x[1] ** 2, p.p - 0.5 - x[2] ** 2 - x[3] ** 2
        turning = [
            first * x[0] - x[1],
            x[0] + first * x[1],
            second * x[2] - 1.7 * x[3],
            1.7 * x[2] + second * x[3],
        ]
        return [*turning, *(-x[i] + 0.1 * x[0] for i in range(4, 40))]

    flow = cv.FlowProblem(rates, [0.0] * 40, {"p": -0.2})
    graph = cv.diagram(flow, over="p", within=(-0.2, 1.0), depth=1, progress=False)
    assert [point.value for point in graph.of_kind("hopf")] == pytest.approx([0.0, 0.5], abs=1e-9)
    for label, name, begins in (("B2", "max x0", 0.0), ("B3", "max x2", 0.5)):
        branch = graph.branches[label]
        assert branch.values.max() == 1.0
        assert branch.measure(name) ** 2 == pytest.approx(branch.values - begins, abs=1e-5)
