"""Branch points of problems with more unknowns than eigenvalues are computed for: an even number of them in one step is seen."""

import numpy as np
import pytest
import scipy.sparse as sp

import contvines as cv


def hidden(local, slopes, n, seed=0):
    """Equations in two unknowns beside n - 2 damped ones, all mixed by orthogonal matrices; F and its Jacobian."""
    draw = np.random.default_rng(seed)
    left, right = (np.linalg.qr(draw.standard_normal((n, n)))[0] for _ in range(2))
    rates = 1.0 + np.arange(n - 2.0)

    def F(u, p):
        x = right @ u
        return left @ np.append(local(x[:2], p), -rates * x[2:] + 0.3 * x[0] * x[1])

    def jacobian(u, p):
        x = right @ u
        inner = np.zeros((n, n))
        inner[:2, :2] = slopes(x[:2], p)
        inner[2:, 0], inner[2:, 1] = 0.3 * x[1], 0.3 * x[0]
        inner[2:, 2:] -= np.diag(rates)
        return left @ inner @ right

    return F, jacobian


def bands(local, slopes, n):
    """The same without mixing, the damped ones in a chain, as a sparse matrix."""
    chain = sp.csr_array(np.eye(n - 2, k=1) - 3.0 * np.eye(n - 2) + np.eye(n - 2, k=-1))

    def F(u, p):
        rest = chain @ u[2:]
        rest[0] += u[0] * u[1]
        return np.append(local(u[:2], p), rest)

    def jacobian(u, p):
        low = sp.csr_array(([u[1], u[0]], ([0, 0], [0, 1])), shape=(n - 2, 2))
        return sp.block_array([[sp.csr_array(slopes(u[:2], p)), None], [low, chain]]).tocsr()

    return F, jacobian


def transcritical(x, p):
    return np.array([x[0] * (p - 0.5 - x[0]), x[1] * (p - 0.503 + 2.0 * x[1])])


def transcritical_slopes(x, p):
    return np.diag([p - 0.5 - 2.0 * x[0], p - 0.503 + 4.0 * x[1]])


@pytest.mark.parametrize("make", [hidden, bands])
def test_two_branch_points_in_one_step(make):
    F, jacobian = make(transcritical, transcritical_slopes, 30)
    problem = cv.AlgebraicProblem(F, np.zeros(30), 0.0, jacobian=jacobian, scale=1.0)
    graph = cv.diagram(problem, within=(0.0, 1.0), depth=1)
    values = sorted(point.value for point in graph.of_kind("branch-point") if point.branch == "B1")
    assert values == pytest.approx([0.5, 0.503], abs=1e-10)
    assert len(graph) == 3
