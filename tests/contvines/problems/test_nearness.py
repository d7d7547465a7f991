"""Branch points of problems with more unknowns than eigenvalues are computed for: an even number of them in one step is seen."""

import numpy as np
import pytest
import scipy.sparse as sp

import contvines as cv


@pytest.mark.parametrize("form", [sp.csr_array, sp.csr_array.toarray])
def test_two_branch_points_in_one_step(form):
    """Two transcritical exchanges at 0.5 and 0.503 beside a chain of 28 damped unknowns."""
    chain = sp.csr_array(np.eye(28, k=1) - 3.0 * np.eye(28) + np.eye(28, k=-1))

    def F(u, p):
        x, y = u[:2]
        return np.concatenate(
            [[x * (p - 0.5 - x), y * (p - 0.503 + 2.0 * y)], chain @ u[2:] + x * y * np.eye(28)[0]]
        )

    def jacobian(u, p):
        x, y = u[:2]
        own = sp.csr_array(np.diag([p - 0.5 - 2.0 * x, p - 0.503 + 4.0 * y]))
        low = sp.csr_array(([y, x], ([0, 0], [0, 1])), shape=(28, 2))
        return form(sp.block_array([[own, None], [low, chain]]).tocsr())

    problem = cv.AlgebraicProblem(F, np.zeros(30), 0.0, jacobian=jacobian, scale=1.0)
    graph = cv.diagram(problem, within=(0.0, 1.0), depth=1)
    values = sorted(point.value for point in graph.of_kind("branch-point") if point.branch == "B1")
    assert values == pytest.approx([0.5, 0.503], abs=1e-10)
    assert len(graph) == 3
