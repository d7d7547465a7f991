"""Branches put together from pieces: every point once, in order, whatever lies between and beside the points."""

import numpy as np

import contvines as cv


def test_branch_points_closer_than_roundoff_beside_a_point_of_the_branch():
    """Two pitchforks 6e-13 apart at p = 0, where the trivial branch has a point."""

    def f(u, p):
        return [u[0] * (p - u[0] ** 2 + 0.3 * u[1]), u[1] * (p - 5.683e-13 - u[1] ** 2)]

    steps = {"first_step": 0.5, "max_step": 0.5, "max_branches": 1}
    problem = cv.AlgebraicProblem(f, [0.0, 0.0], -0.5, spectrum="flow")
    branch = cv.diagram(problem, within=(-0.5, 0.5), settings=steps)["B1"]
    assert (np.diff(branch.values) >= -1e-12).all()
    assert (branch.values == 0.5).sum() == 1
