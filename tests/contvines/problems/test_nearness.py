"""Branch points of problems with more unknowns than eigenvalues are computed for: an even number of them in one step is seen."""

import numpy as np
import pytest
import scipy.sparse as sp

import contvines as cv


@pytest.mark.parametrize("form", [np.array, sp.csr_array])
def test_two_branch_points_in_one_step(form):
    """Two transcritical exchanges at 0.5 and 0.503 beside 28 damped unknowns."""
    rates = -1.0 - np.arange(28.0)

    def F(u, p):
        x, y = u[:2]
        return np.array([x * (p - 0.5 - x), y * (p - 0.503 + 2.0 * y), *(rates * u[2:] + 0.3 * x * y)])

    def jacobian(u, p):
        x, y = u[:2]
        found = np.diag([p - 0.5 - 2.0 * x, p - 0.503 + 4.0 * y, *rates])
        found[2:, 0], found[2:, 1] = 0.3 * y, 0.3 * x
        return form(found)

    problem = cv.AlgebraicProblem(F, np.zeros(30), 0.0, jacobian=jacobian, scale=1.0)
    graph = cv.diagram(problem, within=(0.0, 1.0), depth=1)
    values = sorted(point.value for point in graph.of_kind("branch-point") if point.branch == "B1")
    assert values == pytest.approx([0.5, 0.503], abs=1e-10)
    assert len(graph) == 3
