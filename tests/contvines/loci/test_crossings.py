"""Crossings of loci: of polygons, and of two folds of unconnected cells in closed form."""

import numpy as np
import pytest

import contvines as cv

pytestmark = pytest.mark.slow


def test_two_folds_of_two_cells_cross_in_closed_form():
    # x' = a + b x - x^3 folds at a = 2 (b/3)^(3/2); y' = a - 0.3 + y - y^3 folds at a = 0.3 + 2/27^(1/2), whatever b is:
    # both at once where the two values are one
    def f(u, p):
        return np.array([p.a + p.b * u[0] - u[0] ** 3, p.a - 0.3 + u[1] - u[1] ** 3])

    start = [min(np.roots([-1.0, 0.0, 1.0, a]), key=lambda r: abs(np.imag(r))).real for a in (-1.0, -1.3)]
    problem = cv.AlgebraicProblem(f, start, {"a": -1.0, "b": 1.0}, parameter="a", spectrum="flow")
    graph = cv.diagram(problem, over="a", within=(-1.2, 1.2), depth=0)
    chart = cv.chart(graph, over="b", within=(0.6, 2.2), regions=False)
    second = 0.3 + 2 / 27**0.5
    b = 3 * (second / 2) ** (2 / 3)
    values = [(c["value"]["a"], c["value"]["b"]) for c in chart.crossings]
    assert any(np.allclose(value, (second, b), atol=1e-9) for value in values), values
    assert chart.to_dict()["crossings"] == chart.crossings
