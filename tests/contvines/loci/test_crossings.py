"""Crossings of loci: of polygons, and of two folds of unconnected cells in closed form."""

import numpy as np
import pytest

import contvines as cv

pytestmark = pytest.mark.slow


def test_two_folds_of_two_cells_cross_in_closed_form():
    # x' = a + b x - x^3 folds at a = 2 (b/3)^(3/2); y' = a - c + y - y^3 folds at a = c + 2/27^(1/2), whatever b is:
    # both at once where the two values are one
    c = 0.369

    def f(u, p):
        return [p.a + p.b * u[0] - u[0] ** 3, p.a - c + u[1] - u[1] ** 3]

    problem = cv.AlgebraicProblem(f, [-1.2, -1.3], {"a": -0.528, "b": 1.0}, spectrum="flow")
    graph = cv.diagram(problem, over="a", within=(-1.2, 1.2), depth=0)
    chart = cv.chart(graph, over="b", within=(0.6, 2.2), regions=False)
    second = c + 2 / 27**0.5
    b = 3 * (second / 2) ** (2 / 3)
    values = [(c["value"]["a"], c["value"]["b"]) for c in chart.crossings]
    assert any(np.allclose(value, (second, b), atol=1e-9) for value in values), values
    assert chart.to_dict()["crossings"] == chart.crossings
