"""Columns of tables: unknowns in the order of their numbers, multipliers with their imaginary parts."""

import numpy as np

import contvines as cv
from contvines.export.columns import graph_columns


def test_twelve_unknowns_keep_their_order():
    places = np.arange(12.0)
    problem = cv.AlgebraicProblem(lambda u, p: u - places - p, places, 0.0, scale=1.0)
    columns = graph_columns(cv.diagram(problem, within=(-1.0, 1.0)))
    names = [name for name in columns if name.startswith("u") and name[1:].isdigit()]
    assert names == [f"u{j}" for j in range(12)]
    for j, name in enumerate(names):
        np.testing.assert_allclose(columns[name], j + np.array(columns["p"]), atol=1e-12)


def test_a_rotation_has_two_conjugate_multipliers():
    problem = cv.AlgebraicProblem(
        lambda u, p: np.array([-u[0] - 2.0 * u[1], 2.0 * u[0] - u[1]]),
        [0.0, 0.0],
        0.0,
        spectrum="flow",
        scale=1.0,
    )
    columns = graph_columns(cv.diagram(problem, within=(-1.0, 1.0)))
    assert np.allclose(columns["multiplier0_re"], -1.0) and np.allclose(columns["multiplier1_re"], -1.0)
    assert {round(abs(v), 9) for v in columns["multiplier0_im"]} == {2.0}
    assert np.allclose(np.add(columns["multiplier0_im"], columns["multiplier1_im"]), 0.0)
