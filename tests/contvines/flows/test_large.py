"""Large flows with sparse Jacobians against the same flows with full ones, and against simulation."""

import numpy as np
import pytest

import contvines as cv

pytestmark = pytest.mark.slow

CELLS = 16
START = np.repeat([1.0, 0.0], CELLS)


def coupled_cells(x, p):
    """A chain of FitzHugh-Nagumo cells that differ along the chain, coupled by diffusion."""
    u, v = x[:CELLS], x[CELLS:]
    beside = np.concatenate([u[1:2] - u[:1], u[2:] - 2 * u[1:-1] + u[:-2], u[-2:-1] - u[-1:]])
    place = (np.arange(CELLS) / CELLS - 0.5).reshape((-1,) + (1,) * (x.ndim - 1))
    return np.concatenate([u - u**3 / 3 - v + 0.5 * beside, 0.3 * (u + p.a + 0.2 * place - 0.5 * v)])


@pytest.fixture
def flow():
    return cv.FlowProblem(coupled_cells, START, {"a": 0.3})


@pytest.fixture(scope="module")
def orbit():
    return cv.FlowProblem(coupled_cells, START, {"a": 0.3}).attractor()


def test_leading_multipliers_are_those_of_a_simulation(orbit):
    assert orbit._problem.field.sparsity.count <= 5  # colours
    assert orbit.replay() < 1e-6
    simulated = orbit.simulated_multipliers()
    rest = np.delete(simulated, np.argmin(np.abs(simulated - 1.0)))
    expected = np.sort(np.abs(rest))[::-1][: len(orbit.multipliers)]
    assert len(orbit.multipliers) == 10
    assert np.allclose(np.abs(orbit.multipliers), expected, atol=1e-7)
    assert orbit.trivial_error < 1e-7


def test_cycles_with_sparse_and_full_matrices_are_the_same(orbit, flow):
    flow.field.sparsity = None
    full = flow.attractor()
    assert full.period == pytest.approx(orbit.period, rel=1e-8)
    assert np.allclose(full.multipliers[:4], orbit.multipliers[:4], atol=1e-7)
    last = [
        [point.value for point, _ in zip(cv.trace(one.problem("a"), within=(0.25, 0.32)), range(3))][-1]
        for one in (orbit, full)
    ]
    assert last[0] == pytest.approx(last[1], rel=1e-6)


def test_cycles_of_forty_states_leave_each_of_two_hopf_points():
    """Two oscillators z' = (p - a + i w) z - z |z|^2, a = 0 and 1/2, beside 36 states that decay: cycles |z|^2 = p - a."""

    def rates(x, p):
        first, second = (p.p - a - x[i] ** 2 - x[i + 1] ** 2 for i, a in ((0, 0.0), (2, 0.5)))
        one = [first * x[0] - x[1], x[0] + first * x[1]]
        other = [second * x[2] - 1.7 * x[3], 1.7 * x[2] + second * x[3]]
        return [*one, *other, *(-x[i] + 0.1 * x[0] for i in range(4, 40))]

    flow = cv.FlowProblem(rates, [0.0] * 40, {"p": -0.2})
    graph = cv.diagram(flow, over="p", within=(-0.2, 1.0), depth=1)
    assert [point.value for point in graph.of_kind("hopf")] == pytest.approx([0.0, 0.5], abs=1e-9)
    for label, name, begins in (("B2", "max x0", 0.0), ("B3", "max x2", 0.5)):
        branch = graph.branches[label]
        assert branch.values.max() == 1.0
        assert branch.measure(name) ** 2 == pytest.approx(branch.values - begins, abs=1e-5)
